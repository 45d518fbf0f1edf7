#include "firmware_host/backends/freenect_device.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <libfreenect.h>
#include <libfreenect_registration.h>
#include <libusb.h>
#include <sys/time.h>

#include "firmware_host/backends/light_thread.h"
#include "firmware_host/control/usb.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

constexpr double kTicksPerSecond = 60e6;
constexpr int kWidth = 640, kHeight = 480;
/// By StatusLight.
constexpr std::array<KinectLight, 5> kLights = {KinectLight::Off, KinectLight::BlinkingGreen, KinectLight::Yellow,
                                                KinectLight::Green, KinectLight::Red};

class FreenectDevice final : public DepthSource {
 public:
  FreenectDevice(std::string_view which, const OpenOptions& options) : which_(which), clock_(options.clock) {
    info_.uri = "freenect:" + which_;
    info_.live = true;
    pixels_.resize(std::size_t{kWidth} * kHeight);
  }
  ~FreenectDevice() override {
    if (device_ != nullptr) {
      freenect_stop_depth(device_);
      freenect_close_device(device_);
    }
    if (context_ != nullptr) freenect_shutdown(context_);
    if (usb_ != nullptr) libusb_exit(usb_);
  }

  Expected<void> start() {
    // Of our own, so that its list of devices is the one in which libfreenect counts.
    if (libusb_init(&usb_) != 0 || freenect_init(&context_, usb_) < 0) return complain("libusb cannot be initialised");
    freenect_set_log_level(context_, FREENECT_LOG_FATAL);
    freenect_select_subdevices(context_, FREENECT_DEVICE_CAMERA);
    const auto cameras = kinect_cameras(usb_);
    const auto camera = find_kinect(cameras, which_);
    if (!camera) return complain(camera.error().message + "; `armature devices` lists what is");
    port_ = camera->port;
    if (freenect_open_device(context_, &device_, camera->listed) < 0) {
      return complain(
          "it is there and does not open: is another program using it, or are the udev rules missing? "
          "`armature doctor` tells");
    }
    if (kinect_cameras(usb_) != cameras) return complain("another Kinect came or went while it was opened");
    const freenect_registration registration = freenect_copy_registration(device_);
    const auto& plane = registration.zero_plane_info;
    const double focal_px = plane.reference_pixel_size > 0 ? static_cast<double>(plane.reference_distance) /
                                                                 (2 * static_cast<double>(plane.reference_pixel_size))
                                                           : 0;
    freenect_registration owned = registration;
    freenect_destroy_registration(&owned);
    if (!(focal_px > 100 && focal_px < 5000)) return complain("its calibration makes no sense");
    info_.intrinsics = {kWidth, kHeight, focal_px, focal_px, kWidth / 2.0, kHeight / 2.0};
    freenect_set_user(device_, this);
    freenect_set_depth_callback(device_, [](freenect_device* device, void*, std::uint32_t ticks) {
      static_cast<FreenectDevice*>(freenect_get_user(device))->received(ticks);
    });
    light_.emplace(
        [port = port_](StatusLight light) {
          // Opened for the moment: another program may want to turn the motor.
          const auto motor = KinectMotor::open(port);
          return motor && (*motor)->light(kLights[static_cast<std::size_t>(light)]);
        },
        clock_);
    return start_stream();
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    const auto until = clock_->now() + timeout;
    fresh_ = false;
    while (!fresh_) {
      const auto left = until - clock_->now();
      if (left <= 0ns) return ReadStatus::Timeout;
      timeval wait{.tv_sec = 0,
                   .tv_usec = std::min<long>(50'000, std::chrono::ceil<std::chrono::microseconds>(left).count())};
      if (freenect_process_events_timeout(context_, &wait) < 0) return complain("unplugged");
    }
    frame.depth_mm.assign(pixels_.begin(), pixels_.end());
    frame.intrinsics = info_.intrinsics;
    frame.sequence = sequence_;
    frame.sensor = {time_, ClockId::Device};
    frame.host = {clock_->now(), ClockId::HostMonotonic};
    return ReadStatus::Frame;
  }

  Expected<void> recover(RecoverBy by) override {
    if (by == RecoverBy::ResettingDevice) return reset_kinect_camera(port_);
    freenect_stop_depth(device_);
    return start_stream();
  }

  /// Returns at once: a motor board may not answer, and the frames do not wait for it.
  void show(StatusLight light) override { light_->show(light); }

 private:
  Expected<void> start_stream() {
    const auto mode = freenect_find_depth_mode(FREENECT_RESOLUTION_MEDIUM, FREENECT_DEPTH_MM);
    if (freenect_set_depth_mode(device_, mode) < 0 || freenect_set_depth_buffer(device_, pixels_.data()) < 0 ||
        freenect_start_depth(device_) < 0) {
      return complain("its depth stream does not start");
    }
    return {};
  }
  void received(std::uint32_t ticks) {
    time_ = clock_of_sensor_(ticks);
    ++sequence_;
    fresh_ = true;
  }
  [[nodiscard]] tl::unexpected<Error> complain(const std::string& what) const { return fail(info_.uri + ": " + what); }

  std::string which_, port_;
  std::shared_ptr<Clock> clock_;
  SourceInfo info_;
  libusb_context* usb_ = nullptr;
  freenect_context* context_ = nullptr;
  freenect_device* device_ = nullptr;
  std::vector<std::uint16_t> pixels_;
  UnwrappedTicks clock_of_sensor_{kTicksPerSecond};
  std::chrono::nanoseconds time_{0};
  std::uint64_t sequence_ = 0;
  bool fresh_ = false;
  std::optional<LightThread> light_;
};

}  // namespace

Expected<std::unique_ptr<DepthSource>> open_freenect_device(std::string_view which, const OpenOptions& options) {
  const bool number = which.find_first_not_of("0123456789") == which.npos && which.size() < 3;
  const bool port = which.find('-') != which.npos && which.find_first_not_of("0123456789-.") == which.npos;
  if (which.empty() || !(number || port)) {
    return fail("source 'freenect:" + std::string(which) +
                "': expected freenect:N, from 0, or its port as `armature devices` says it, such as freenect:1-2.1");
  }
  auto source = std::make_unique<FreenectDevice>(which, options);
  if (auto started = source->start(); !started) return tl::unexpected(started.error());
  return std::unique_ptr<DepthSource>(std::move(source));
}

}  // namespace armature
