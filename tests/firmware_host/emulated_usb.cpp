#include "tests/firmware_host/emulated_usb.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <deque>
#include <mutex>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

namespace armature::test {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr std::size_t kFrameBytes = 640 * 480 * 11 / 8;
constexpr std::size_t kPacketData = 1748, kPacketHeader = 12;
constexpr std::size_t kPacketsAFrame = (kFrameBytes + kPacketData - 1) / kPacketData;
constexpr std::chrono::microseconds kFramePeriod{33'333};
constexpr std::uint32_t kTicksAFrame = 2'000'000;  // of 60 MHz

struct Unref {
  void operator()(UMockdevIoctlData* data) const noexcept { umockdev_ioctl_data_unref(data); }
};
using Data = std::unique_ptr<UMockdevIoctlData, Unref>;

/// Nothing where the process whose memory it is has gone meanwhile.
Data resolve(UMockdevIoctlData* data, std::size_t offset, std::size_t length) {
  return Data(umockdev_ioctl_data_resolve(data, offset, length, nullptr));
}
template <class T>
T* view(const Data& data) {
  return reinterpret_cast<T*>(data->data);
}
void put16(std::uint8_t* at, unsigned value) {
  at[0] = static_cast<std::uint8_t>(value);
  at[1] = static_cast<std::uint8_t>(value >> 8U);
}
unsigned get16(const std::uint8_t* at) {
  return at[0] | static_cast<unsigned>(at[1]) << 8U;
}

/// One raw value all over the image, 11 bits a pixel, most significant first.
std::vector<std::uint8_t> packed_frame(std::uint16_t raw) {
  std::array<std::uint8_t, 11> eight{};
  for (unsigned bit = 0; bit < 88; ++bit) {
    if ((raw >> (10 - bit % 11) & 1U) != 0) eight[bit / 8] |= static_cast<std::uint8_t>(0x80U >> bit % 8);
  }
  std::vector<std::uint8_t> bytes(kFrameBytes);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = eight[i % 11];
  return bytes;
}

/// A transfer that was submitted and not reaped yet.
struct Urb {
  Data data, buffer;
  const UMockdevIoctlClient* owner = nullptr;  // who submitted it, and nobody else reaps it
  void* client = nullptr;                      // its address there
  bool done = false;
};

class Device {
 public:
  Device(EmulatedBus& bus, std::string node) : bus_(bus), node_(std::move(node)), handler_(umockdev_ioctl_base_new()) {
    g_signal_connect(handler_, "handle-ioctl",
                     G_CALLBACK(+[](UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) -> gboolean {
                       return static_cast<Device*>(self)->handle(client) ? TRUE : FALSE;
                     }),
                     this);
    g_signal_connect(handler_, "client-vanished",
                     G_CALLBACK(+[](UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer self) {
                       static_cast<Device*>(self)->forget(client);
                     }),
                     this);
    umockdev_testbed_attach_ioctl(bus_.testbed(), node_.c_str(), handler_, nullptr);
  }
  virtual ~Device() {
    umockdev_testbed_detach_ioctl(bus_.testbed(), node_.c_str(), nullptr);
    g_object_unref(handler_);
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  void set_gone(bool gone) {
    const std::lock_guard lock(mutex_);
    gone_ = gone;
    if (!gone) urbs_.clear();
  }
  std::atomic<int> resets = 0;  // the test looks on

 protected:
  static constexpr int kStalled = -1, kNoAnswer = -2;
  /// A control request; its answer goes into `data`, whose length is returned; negative: one of the above.
  virtual int control(const std::uint8_t* setup, std::uint8_t* data, std::size_t size) = 0;
  /// Fills isochronous packets; false: nothing to send yet.
  virtual bool isochronous(usbdevfs_urb&, std::uint8_t*) { return false; }

  mutable std::mutex mutex_;

 private:
  bool handle(UMockdevIoctlClient* client) {
    const std::lock_guard lock(mutex_);
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    const auto complete = [&](int result, int error) {
      umockdev_ioctl_client_complete(client, result, error);
      return true;
    };
    const auto request = umockdev_ioctl_client_get_request(client);
    if (gone_ && request != USBDEVFS_REAPURB && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_DISCARDURB)
      return complete(-1, ENODEV);
    switch (request) {
      case USBDEVFS_GET_CAPABILITIES: {
        const Data value = resolve(argument, 0, sizeof(std::uint32_t));
        if (!value) return complete(-1, EFAULT);
        *view<std::uint32_t>(value) = USBDEVFS_CAP_BULK_CONTINUATION | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                      USBDEVFS_CAP_REAP_AFTER_DISCONNECT | USBDEVFS_CAP_ZERO_PACKET;
        return complete(0, 0);
      }
      case USBDEVFS_GETDRIVER: return complete(-1, ENODATA);
      case USBDEVFS_CLAIMINTERFACE:
      case USBDEVFS_RELEASEINTERFACE:
      case USBDEVFS_SETINTERFACE:
      case USBDEVFS_CLEAR_HALT:
      case USBDEVFS_IOCTL: return complete(request == USBDEVFS_IOCTL ? -1 : 0, request == USBDEVFS_IOCTL ? ENODATA : 0);
      case USBDEVFS_RESET: ++resets; return complete(0, 0);
      case USBDEVFS_SUBMITURB: return submit(client, argument) ? complete(0, 0) : complete(-1, EFAULT);
      case USBDEVFS_DISCARDURB: return discard(client, argument) ? complete(0, 0) : complete(-1, EINVAL);
      case USBDEVFS_REAPURB:
      case USBDEVFS_REAPURBNDELAY: {
        Urb* urb = ready(client);
        if (urb == nullptr) {
          const bool any = std::ranges::any_of(urbs_, [&](const Urb& other) { return other.owner == client; });
          return complete(-1, gone_ && !any ? ENODEV : EAGAIN);
        }
        const Data pointer = resolve(argument, 0, sizeof(void*));
        if (!pointer) return complete(-1, EFAULT);
        umockdev_ioctl_data_set_ptr(pointer.get(), 0, urb->data.get());
        complete(0, 0);
        std::erase_if(urbs_, [&](const Urb& other) { return &other == urb; });
        return true;
      }
      default: return complete(-1, ENOTTY);
    }
  }

  void forget(const UMockdevIoctlClient* owner) {
    const std::lock_guard lock(mutex_);
    std::erase_if(urbs_, [&](const Urb& urb) { return urb.owner == owner; });
  }
  bool submit(const UMockdevIoctlClient* owner, UMockdevIoctlData* argument) {
    // Resolving puts our own address in the place of the client's: the size is known only then, so do it again.
    void* const client = *reinterpret_cast<void**>(argument->data);
    Urb urb;
    urb.owner = owner;
    urb.client = client;
    urb.data = resolve(argument, 0, sizeof(usbdevfs_urb));
    if (!urb.data) return false;
    const auto* head = view<usbdevfs_urb>(urb.data);
    if (head->type == USBDEVFS_URB_TYPE_ISO) {
      const std::size_t size =
          sizeof(usbdevfs_urb) + static_cast<std::size_t>(head->number_of_packets) * sizeof(usbdevfs_iso_packet_desc);
      umockdev_ioctl_data_reload(argument, nullptr);
      *reinterpret_cast<void**>(argument->data) = client;
      urb.data = resolve(argument, 0, size);
      if (!urb.data) return false;
    }
    auto* about = view<usbdevfs_urb>(urb.data);
    urb.buffer =
        resolve(urb.data.get(), offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(about->buffer_length));
    if (!urb.buffer) return false;
    if (about->type == USBDEVFS_URB_TYPE_CONTROL) {
      auto* bytes = view<std::uint8_t>(urb.buffer);
      const int length = control(bytes, bytes + 8, static_cast<std::size_t>(about->buffer_length) - 8);
      about->status = length < 0 ? -EPIPE : 0;
      about->actual_length = std::max(length, 0);
      urb.done = length != kNoAnswer;
    }
    urbs_.push_back(std::move(urb));
    return true;
  }
  bool discard(const UMockdevIoctlClient* owner, UMockdevIoctlData* argument) {
    void* const client = *reinterpret_cast<void**>(argument->data);
    for (Urb& urb : urbs_) {
      if (urb.owner != owner || urb.client != client || urb.done) continue;
      view<usbdevfs_urb>(urb.data)->status = -ENOENT;
      urb.done = true;
      return true;
    }
    return false;
  }
  Urb* ready(const UMockdevIoctlClient* owner) {
    bool waiting = false;  // isochronous transfers complete in order
    for (Urb& urb : urbs_) {
      if (urb.owner != owner) continue;
      auto* about = view<usbdevfs_urb>(urb.data);
      if (!urb.done && gone_) {
        about->status = -ENODEV;
        urb.done = true;
      }
      if (!urb.done && about->type == USBDEVFS_URB_TYPE_ISO && !waiting) {
        urb.done = isochronous(*about, view<std::uint8_t>(urb.buffer));
        waiting = !urb.done;
      }
      if (urb.done) return &urb;
    }
    return nullptr;
  }

  EmulatedBus& bus_;
  std::string node_;
  UMockdevIoctlBase* handler_;
  std::deque<Urb> urbs_;
  bool gone_ = true;
};

class Camera final : public Device {
 public:
  using Device::Device;
  bool stalled = false;
  int sent = 0;
  void stall(bool on) {
    const std::lock_guard lock(mutex_);
    stalled = on;
  }
  int frames() const {
    const std::lock_guard lock(mutex_);
    return sent;
  }

 private:
  int control(const std::uint8_t* setup, std::uint8_t* data, std::size_t size) override {
    if (setup[0] == 0x40) {  // a command
      command_.assign(data, data + size);
      return static_cast<int>(size);
    }
    if (setup[0] == 0xC0) return reply(data, size);
    if (setup[0] == 0x80 && setup[1] == 6 && setup[3] == 3) return text(setup[2], data);
    return setup[0] < 0x80 ? 0 : kStalled;
  }
  static int text(std::uint8_t index, std::uint8_t* data) {
    const std::string words = index == 0 ? "" : "A00362912345678A";
    if (index == 0) {
      const std::array<std::uint8_t, 4> english = {4, 3, 9, 4};
      std::memcpy(data, english.data(), 4);
      return 4;
    }
    data[0] = static_cast<std::uint8_t>(2 + 2 * words.size());
    data[1] = 3;
    for (std::size_t i = 0; i < words.size(); ++i) put16(data + 2 + 2 * i, static_cast<unsigned char>(words[i]));
    return data[0];
  }
  int reply(std::uint8_t* data, std::size_t size) {
    if (command_.size() < 8) return 0;
    const unsigned opcode = get16(command_.data() + 4);
    std::size_t length = 2;
    if (opcode == 0x02) length = 4;
    if (opcode == 0x04) length = 322;
    if (opcode == 0x95) length = 6;
    if (opcode == 0x16) {
      const unsigned parameter = command_.size() >= 10 ? get16(command_.data() + 8) : 0;
      length = parameter == 0x40 ? 118 : parameter == 0x41 ? 8 : 4;
    }
    if (opcode == 0x03 && command_.size() >= 12 && get16(command_.data() + 8) == 0x06) {
      streaming_ = get16(command_.data() + 10) == 2;
      packet_ = 0;
      next_ = Clock::now();
    }
    if (8 + length > size) return kStalled;
    std::memset(data, 0, 8 + length);
    data[0] = 0x52;
    data[1] = 0x42;
    put16(data + 2, static_cast<unsigned>(length / 2));
    std::memcpy(data + 4, command_.data() + 4, 4);
    std::uint8_t* body = data + 8;
    if (opcode == 0x04) {
      // The zero plane: 7.5 cm between infrared camera and emitter, 2.3 to the colour camera, 120 mm, 0.1042 mm.
      const std::array<float, 4> plane = {7.5F, 2.3F, 120.0F, 0.1042F};
      std::memcpy(body + 94, plane.data(), sizeof plane);
    }
    if (opcode == 0x16 && length == 4) put16(body + 2, 200);  // the constant shift
    command_.clear();
    return static_cast<int>(8 + length);
  }
  bool isochronous(usbdevfs_urb& urb, std::uint8_t* buffer) override {
    if (!streaming_ || stalled) return false;
    if (packet_ == 0 && Clock::now() < next_) return false;
    std::size_t offset = 0;
    for (int i = 0; i < urb.number_of_packets; ++i) {
      auto& slot = urb.iso_frame_desc[i];
      slot.status = 0;
      slot.actual_length = 0;
      if (packet_ != 0 || Clock::now() >= next_) slot.actual_length = static_cast<unsigned>(packet(buffer + offset));
      offset += slot.length;
    }
    urb.status = 0;
    urb.actual_length = urb.buffer_length;
    urb.error_count = 0;
    return true;
  }
  std::size_t packet(std::uint8_t* out) {
    if (packet_ == 0) frame_ = packed_frame(EmulatedKinect::raw_of(sent));
    const std::size_t from = packet_ * kPacketData;
    const std::size_t length = std::min(kPacketData, kFrameBytes - from);
    const bool last = packet_ + 1 == kPacketsAFrame;
    out[0] = 'R';
    out[1] = 'B';
    out[2] = 0;
    out[3] = packet_ == 0 ? 0x71 : last ? 0x75 : 0x72;
    out[4] = 0;
    out[5] = sequence_++;
    out[6] = out[7] = 0;
    const auto ticks = static_cast<std::uint32_t>(sent) * kTicksAFrame;
    put16(out + 8, ticks & 0xFFFFU);
    put16(out + 10, ticks >> 16U);
    std::memcpy(out + kPacketHeader, frame_.data() + from, length);
    packet_ = last ? 0 : packet_ + 1;
    if (last) {
      ++sent;
      next_ = std::max(next_ + kFramePeriod, Clock::now() - kFramePeriod);
    }
    return kPacketHeader + length;
  }

  std::vector<std::uint8_t> command_, frame_;
  bool streaming_ = false;
  std::size_t packet_ = 0;
  std::uint8_t sequence_ = 0;
  Clock::time_point next_;
};

class Motor final : public Device {
 public:
  using Device::Device;
  std::atomic<int> light = -1, tilt = 0, asked = 0;  // the test looks on
  std::atomic<bool> hangs = false;

 private:
  int control(const std::uint8_t* setup, std::uint8_t* data, std::size_t size) override {
    ++asked;
    if (hangs) return kNoAnswer;
    if (setup[0] == 0x40 && setup[1] == 0x06) light = static_cast<int>(get16(setup + 2));
    if (setup[0] == 0x40 && setup[1] == 0x31) tilt = static_cast<std::int16_t>(get16(setup + 2));
    if (setup[0] != 0xC0 || setup[1] != 0x32 || size < 10) return setup[0] == 0x40 ? 0 : kStalled;
    // Level, but turned by 14 degrees: 0, 795, 198 counts of 819; the motor at -7 degrees.
    const std::array<std::uint8_t, 10> answer = {0, 0, 0, 0, 0x03, 0x1B, 0x00, 0xC6, 0xF2, 0};
    std::memcpy(data, answer.data(), answer.size());
    return 10;
  }
};

/// A device on bus 1: the ports that lead to it, as the kernel writes them, and its number.
struct Place {
  std::string ports;
  int number = 0;
  [[nodiscard]] std::string node() const {
    const std::string digits = std::to_string(number);
    return "bus/usb/001/" + std::string(3 - digits.size(), '0') + digits;
  }
  [[nodiscard]] std::string path() const {
    const auto hub = ports.find('.');
    return "/devices/usb1/" + (hub == ports.npos ? "" : "1-" + ports.substr(0, hub) + "/") + "1-" + ports;
  }
  [[nodiscard]] std::string description(const char* descriptors) const {
    return "P: " + path() + "\nN: " + node() +
           "\nE: SUBSYSTEM=usb\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM=" + node().substr(node().size() - 3) +
           "\nE: DEVNAME=/dev/" + node() +
           "\nE: DEVTYPE=usb_device\nA: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=" + std::to_string(number) +
           "\\n\nA: speed=480\\n\nH: descriptors=" + descriptors + "\n";
  }
};

// Device, configuration, interface and endpoint descriptors. Camera: 045e:02ae, release 1.0b (model 1414), isochronous
// endpoints 81 and 82. Motor: 045e:02b0, no endpoints. Hub: 0409:005a.
constexpr const char* kCameraDescriptors =
    "12010002000000405e04ae020b0102010301"
    "09022000010100c032"
    "0904000002ffffff00"
    "07058105c00b01"
    "07058205c00b01";
constexpr const char* kMotorDescriptors =
    "12010002000000405e04b0020501000000"
    "01"
    "09021200010100c032"
    "0904000000ffffff00";

constexpr const char* kHubDescriptors =
    "120100020900014009045a00000100000001"
    "09021900010100e032"
    "090400000109000000"
    "0705810301000c";

}  // namespace

struct EmulatedKinect::State {
  State(EmulatedBus& the_bus, int hub_port)
      : bus(the_bus),
        hub{std::to_string(hub_port), 10 * hub_port},
        camera_at{hub_port == 0 ? "1" : hub.ports + ".1", hub.number + 2},
        motor_at{hub_port == 0 ? "2" : hub.ports + ".2", hub.number + 3},
        camera(bus, "/dev/" + camera_at.node()),
        motor(bus, "/dev/" + motor_at.node()) {}
  EmulatedBus& bus;
  Place hub, camera_at, motor_at;
  Camera camera;
  Motor motor;
  std::vector<std::string> plugged;  // paths, hubs first

  void add(const Place& place, const char* descriptors) {
    GError* error = nullptr;
    umockdev_testbed_add_from_string(bus.testbed(), place.description(descriptors).c_str(), &error);
    if (error != nullptr) g_error("%s", error->message);
    plugged.push_back("/sys" + place.path());
  }
  void remove(const std::string& path) {
    umockdev_testbed_uevent(bus.testbed(), path.c_str(), "remove");
    umockdev_testbed_remove_device(bus.testbed(), path.c_str());
    std::erase(plugged, std::string(path));
  }
};

EmulatedKinect::EmulatedKinect(EmulatedBus& bus, int hub) : state_(std::make_unique<State>(bus, hub)) {}
EmulatedKinect::~EmulatedKinect() {
  unplug();
}

void EmulatedKinect::plug_in() {
  state_->camera.set_gone(false);
  state_->motor.set_gone(false);
  if (state_->hub.number != 0) state_->add(state_->hub, kHubDescriptors);
  state_->add(state_->camera_at, kCameraDescriptors);
  state_->add(state_->motor_at, kMotorDescriptors);
}

void EmulatedKinect::unplug_power() {
  state_->camera.set_gone(true);
  state_->remove("/sys" + state_->camera_at.path());
}

void EmulatedKinect::unplug() {
  state_->camera.set_gone(true);
  state_->motor.set_gone(true);
  while (!state_->plugged.empty()) state_->remove(std::string(state_->plugged.back()));
}

void EmulatedKinect::stall(bool on) {
  state_->camera.stall(on);
}
void EmulatedKinect::hang_motor(bool on) {
  state_->motor.hangs = on;
}
int EmulatedKinect::motor_requests() const {
  return state_->motor.asked;
}
int EmulatedKinect::resets() const {
  return state_->camera.resets;
}
int EmulatedKinect::light() const {
  return state_->motor.light;
}
int EmulatedKinect::tilt_half_degrees() const {
  return state_->motor.tilt;
}
int EmulatedKinect::frames() const {
  return state_->camera.frames();
}

}  // namespace armature::test
