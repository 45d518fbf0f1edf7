#include "firmware_host/control/usb.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>

#include <libusb.h>

namespace armature {
namespace {

constexpr std::uint16_t kMicrosoft = 0x045e;
constexpr unsigned kTimeout_ms = 500;

struct Model {
  std::uint16_t vendor, product;
  const char* name;
  const char* scheme;  // of its URI; empty: served by a kernel driver
};
constexpr std::array<Model, 14> kModels = {{{kMicrosoft, 0x02ae, "Kinect v1", "freenect"},
                                            {kMicrosoft, 0x02bf, "Kinect for Windows v1", "freenect"},
                                            {0x1d27, 0x0600, "Asus Xtion Pro Live", "openni2"},
                                            {0x1d27, 0x0601, "Asus Xtion Pro", "openni2"},
                                            {0x1d27, 0x0609, "PrimeSense Carmine 1.09", "openni2"},
                                            {0x1d27, 0x0500, "PrimeSense reference design", "openni2"},
                                            {0x2bc5, 0x0401, "Orbbec Astra", "openni2"},
                                            {0x2bc5, 0x0402, "Orbbec Astra S", "openni2"},
                                            {0x8086, 0x0ad2, "Intel RealSense D410", ""},
                                            {0x8086, 0x0ad3, "Intel RealSense D415", ""},
                                            {0x8086, 0x0b07, "Intel RealSense D435", ""},
                                            {0x8086, 0x0b3a, "Intel RealSense D435i", ""},
                                            {0x8086, 0x0aa5, "Intel RealSense SR300", ""},
                                            {0x8086, 0x0b5c, "Intel RealSense D455", ""}}};
constexpr std::array<std::uint16_t, 2> kMotors = {0x02b0, 0x02c2};
constexpr std::array<std::uint16_t, 2> kKinectCameras = {0x02ae, 0x02bf};

const Model* model_of(std::uint16_t vendor, std::uint16_t product) noexcept {
  for (const Model& model : kModels) {
    if (model.vendor == vendor && model.product == product) return &model;
  }
  return nullptr;
}

tl::unexpected<Error> complain(const std::string& what, int error) {
  std::string why = libusb_strerror(error);
  if (error == LIBUSB_ERROR_ACCESS)
    why += "; install the udev rules (`armature doctor` says where) and plug it in again";
  return fail(what + ": " + why);
}

struct CloseContext {
  void operator()(libusb_context* context) const noexcept { libusb_exit(context); }
};
struct CloseHandle {
  void operator()(libusb_device_handle* handle) const noexcept { libusb_close(handle); }
};
using Context = std::unique_ptr<libusb_context, CloseContext>;
using Handle = std::unique_ptr<libusb_device_handle, CloseHandle>;

Expected<Context> make_context() {
  libusb_context* context = nullptr;
  if (const int error = libusb_init(&context); error != 0) return complain("libusb", error);
  return Context(context);
}

/// From the root hub on; empty where it is one, or they are not known.
std::vector<std::uint8_t> ports_of(libusb_device* device) {
  std::vector<std::uint8_t> ports(8);
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  ports.resize(static_cast<std::size_t>(std::max(depth, 0)));
  return ports;
}

/// Every device on the bus, held for as long as this lives.
class DeviceList {
 public:
  explicit DeviceList(libusb_context* context) : count_(libusb_get_device_list(context, &list_)) {}
  ~DeviceList() {
    if (list_ != nullptr) libusb_free_device_list(list_, 1);
  }
  DeviceList(const DeviceList&) = delete;
  DeviceList& operator=(const DeviceList&) = delete;
  /// In libusb's own order: of a context, not of the bus.
  [[nodiscard]] std::span<libusb_device* const> all() const noexcept {
    return {list_, static_cast<std::size_t>(std::max<ssize_t>(count_, 0))};
  }
  /// In the order of bus and port.
  [[nodiscard]] std::vector<libusb_device*> sorted() const {
    std::vector<libusb_device*> devices(all().begin(), all().end());
    std::ranges::stable_sort(devices, {},
                             [](libusb_device* d) { return std::pair(libusb_get_bus_number(d), ports_of(d)); });
    return devices;
  }

 private:
  libusb_device** list_ = nullptr;
  ssize_t count_ = 0;
};

bool is_one_of(libusb_device* device, std::span<const std::uint16_t> products) {
  libusb_device_descriptor about{};
  return libusb_get_device_descriptor(device, &about) == 0 && about.idVendor == kMicrosoft &&
         std::ranges::find(products, about.idProduct) != products.end();
}

std::string port_of(libusb_device* device) {
  std::string text = std::to_string(libusb_get_bus_number(device));
  char before = '-';
  for (const std::uint8_t port : ports_of(device)) {
    text += std::exchange(before, '.');
    text += std::to_string(port);
  }
  return text;
}
std::string_view hub_of(std::string_view port) {
  return port.substr(0, port.find_last_of("-."));
}

std::vector<KinectCamera> cameras_of(const DeviceList& list) {
  std::vector<KinectCamera> cameras;
  for (libusb_device* device : list.sorted()) {
    if (!is_one_of(device, kKinectCameras)) continue;
    const auto before =
        list.all().first(static_cast<std::size_t>(std::ranges::find(list.all(), device) - list.all().begin()));
    const auto listed = std::ranges::count_if(before, [](libusb_device* d) { return is_one_of(d, kKinectCameras); });
    cameras.push_back({port_of(device), static_cast<int>(listed)});
  }
  return cameras;
}

Expected<Handle> open_device(libusb_device* device, const char* what) {
  libusb_device_handle* handle = nullptr;
  if (const int error = libusb_open(device, &handle); error != 0) return complain(what, error);
  return Handle(handle);
}

double speed_of(libusb_device* device) {
  switch (libusb_get_device_speed(device)) {
    case LIBUSB_SPEED_LOW: return 1.5;
    case LIBUSB_SPEED_FULL: return 12;
    case LIBUSB_SPEED_HIGH: return 480;
    case LIBUSB_SPEED_SUPER: return 5000;
    case LIBUSB_SPEED_SUPER_PLUS: return 10'000;
    default: return 0;
  }
}

void ask_serial(libusb_device* device, std::uint8_t index, UsbSensor& sensor) {
  const auto handle = open_device(device, "cannot be opened");
  if (!handle) {
    sensor.problem = handle.error().message;
    return;
  }
  std::array<unsigned char, 64> text{};
  if (index != 0 &&
      libusb_get_string_descriptor_ascii(handle->get(), index, text.data(), static_cast<int>(text.size()) - 1) > 0)
    sensor.serial = reinterpret_cast<const char*>(text.data());
}

}  // namespace

const char* sensor_name(std::uint16_t vendor, std::uint16_t product) noexcept {
  const Model* model = model_of(vendor, product);
  return model == nullptr ? nullptr : model->name;
}

Expected<std::vector<UsbSensor>> list_usb_sensors() {
  auto context = make_context();
  if (!context) return tl::unexpected(context.error());
  const DeviceList list(context->get());
  std::vector<UsbSensor> sensors;
  int kinects = 0;
  for (libusb_device* device : list.sorted()) {
    libusb_device_descriptor about{};
    if (libusb_get_device_descriptor(device, &about) != 0) continue;
    const Model* model = model_of(about.idVendor, about.idProduct);
    if (model == nullptr) continue;
    UsbSensor sensor;
    sensor.name = model->name;
    sensor.vendor = about.idVendor;
    sensor.product = about.idProduct;
    sensor.bus = libusb_get_bus_number(device);
    sensor.address = libusb_get_device_address(device);
    sensor.port = port_of(device);
    sensor.speed_mbit = speed_of(device);
    const std::string_view scheme = model->scheme;
    if (scheme == "freenect") sensor.uri = "freenect:" + std::to_string(kinects++);
    if (scheme == "openni2") sensor.uri = "openni2:";
    ask_serial(device, about.iSerialNumber, sensor);
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

std::vector<KinectCamera> kinect_cameras(libusb_context* context) {
  return cameras_of(DeviceList(context));
}

Expected<KinectCamera> find_kinect(const std::vector<KinectCamera>& cameras, std::string_view which) {
  if (cameras.empty()) return fail("no Kinect is plugged in");
  if (which.find('-') != std::string_view::npos) {
    const auto found = std::ranges::find(cameras, which, &KinectCamera::port);
    if (found == cameras.end()) return fail("no Kinect is plugged in on port " + std::string(which));
    return *found;
  }
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(which.data(), which.data() + which.size(), number);
  if (error != std::errc() || end != which.data() + which.size())
    return fail("Kinect '" + std::string(which) + "': expected its number or its port");
  if (number >= cameras.size()) return fail("only " + std::to_string(cameras.size()) + " are plugged in");
  return cameras[number];
}

Expected<void> reset_usb_device(std::string_view port) {
  auto context = make_context();
  if (!context) return tl::unexpected(context.error());
  const DeviceList list(context->get());
  const auto device = std::ranges::find(list.all(), port, port_of);
  if (device == list.all().end()) return fail("nothing is plugged in on port " + std::string(port));
  const auto handle = open_device(*device, "reset");
  if (!handle) return tl::unexpected(handle.error());
  const int error = libusb_reset_device(handle->get());
  if (error != 0 && error != LIBUSB_ERROR_NOT_FOUND) return complain("reset", error);
  return {};
}

Expected<void> reset_kinect_camera(std::string_view which) {
  auto context = make_context();
  if (!context) return tl::unexpected(context.error());
  const auto camera = find_kinect(kinect_cameras(context->get()), which);
  if (!camera) return fail("Kinect camera: " + camera.error().message);
  return reset_usb_device(camera->port);
}

std::string usb_port_of_openni2(std::string_view uri) {
  uri.remove_prefix(std::min(uri.size(), uri.find('@')));
  unsigned bus = 0, address = 0;
  if (std::sscanf(std::string(uri).c_str(), "@%3u/%3u", &bus, &address) != 2) return {};
  auto context = make_context();
  if (!context) return {};
  const DeviceList list(context->get());
  const auto device = std::ranges::find_if(list.all(), [&](libusb_device* d) {
    return libusb_get_bus_number(d) == bus && libusb_get_device_address(d) == address;
  });
  return device == list.all().end() ? std::string() : port_of(*device);
}

struct UsbWatch::State {
  Context context;
  Heard heard;
  libusb_hotplug_callback_handle callback{};
};

UsbWatch::UsbWatch(std::unique_ptr<State> state) : state_(std::move(state)) {}
UsbWatch::~UsbWatch() {
  libusb_hotplug_deregister_callback(state_->context.get(), state_->callback);
}

Expected<std::unique_ptr<UsbWatch>> UsbWatch::start(Heard heard) {
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return fail("libusb: no hot-plug on this system");
  auto context = make_context();
  if (!context) return tl::unexpected(context.error());
  auto state = std::make_unique<State>();
  state->context = std::move(*context);
  state->heard = std::move(heard);
  const auto call = [](libusb_context*, libusb_device* device, libusb_hotplug_event event, void* self) {
    libusb_device_descriptor about{};
    if (libusb_get_device_descriptor(device, &about) == 0 && sensor_name(about.idVendor, about.idProduct) != nullptr) {
      static_cast<State*>(self)->heard(event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, about.idVendor, about.idProduct);
    }
    return 0;
  };
  const int error = libusb_hotplug_register_callback(
      state->context.get(),
      static_cast<libusb_hotplug_event>(LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT),
      LIBUSB_HOTPLUG_ENUMERATE, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY, call,
      state.get(), &state->callback);
  if (error != LIBUSB_SUCCESS) return complain("libusb: hot-plug", error);
  return std::unique_ptr<UsbWatch>(new UsbWatch(std::move(state)));
}

void UsbWatch::wait(std::chrono::milliseconds timeout) {
  timeval time{.tv_sec = timeout.count() / 1000, .tv_usec = timeout.count() % 1000 * 1000};
  libusb_handle_events_timeout_completed(state_->context.get(), &time, nullptr);
}

// The motor's requests are those of OpenKinect's protocol documentation (libfreenect's tilt.c).
KinectPosture parse_kinect_posture(const std::array<std::uint8_t, 10>& answer) noexcept {
  constexpr double kCountsPerG = 819, kGravity = 9.80665;
  const auto axis = [&](std::size_t at) {
    return static_cast<std::int16_t>(answer[at] << 8U | answer[at + 1]) / kCountsPerG * kGravity;
  };
  KinectPosture posture;
  // The chip: x left, y up, z forward.
  posture.up_m_s2 = {-axis(2), -axis(4), axis(6)};
  posture.tilt_deg = static_cast<std::int8_t>(answer[8]) / 2.0;
  posture.moving = answer[9] == 4;
  return posture;
}

struct KinectMotor::State {
  Context context;
  Handle handle;

  Expected<void> send(std::uint8_t request, std::uint16_t value) {
    const int sent = libusb_control_transfer(handle.get(), 0x40, request, value, 0, nullptr, 0, kTimeout_ms);
    if (sent < 0) return complain("Kinect motor", sent);
    return {};
  }
};

KinectMotor::KinectMotor(std::unique_ptr<State> state) : state_(std::move(state)) {}
KinectMotor::~KinectMotor() = default;

Expected<std::unique_ptr<KinectMotor>> KinectMotor::open(std::string_view which) {
  auto context = make_context();
  if (!context) return tl::unexpected(context.error());
  const DeviceList list(context->get());
  const auto cameras = cameras_of(list);
  const auto camera = find_kinect(cameras, which);
  libusb_device* found = nullptr;
  for (libusb_device* device : list.sorted()) {
    if (!is_one_of(device, kMotors)) continue;
    const bool beside = camera && hub_of(port_of(device)) == hub_of(camera->port);
    if (beside || (found == nullptr && cameras.size() < 2 && (camera || cameras.empty()))) found = device;
    if (beside) break;
  }
  if (found == nullptr) {
    return fail("Kinect motor: " +
                (camera ? "none beside the camera on port " + camera->port : camera.error().message));
  }
  auto handle = open_device(found, "Kinect motor");
  if (!handle) return tl::unexpected(handle.error());
  auto state = std::make_unique<State>();
  state->context = std::move(*context);
  state->handle = std::move(*handle);
  return std::unique_ptr<KinectMotor>(new KinectMotor(std::move(state)));
}

Expected<void> KinectMotor::light(KinectLight light) {
  return state_->send(0x06, static_cast<std::uint16_t>(light));
}

Expected<void> KinectMotor::tilt(double degrees) {
  if (!(degrees >= -30 && degrees <= 30)) return fail("Kinect motor: expected a tilt from -30 to 30 degrees");
  return state_->send(0x31, static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(degrees * 2))));
}

Expected<KinectPosture> KinectMotor::posture() {
  std::array<std::uint8_t, 10> answer{};
  const int got = libusb_control_transfer(state_->handle.get(), 0xC0, 0x32, 0, 0, answer.data(),
                                          static_cast<std::uint16_t>(answer.size()), kTimeout_ms);
  if (got < 0) return complain("Kinect motor", got);
  if (got != static_cast<int>(answer.size())) return fail("Kinect motor: a short answer");
  return parse_kinect_posture(answer);
}

}  // namespace armature
