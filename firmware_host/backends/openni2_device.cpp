#include "firmware_host/backends/openni2_device.h"

#include <cmath>
#include <cstring>
#include <thread>

#include <OpenNI.h>

#include "firmware_host/backends/openni2_runtime.h"
#include "firmware_host/control/usb.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

constexpr auto kStreamPause = 20ms;  // a stream's thread walks its list without a lock

class OpenNI2Device final : public DepthSource {
 public:
  OpenNI2Device(std::string_view uri, const OpenOptions& options) : uri_(uri), clock_(options.clock) {
    info_.uri = "openni2:" + uri_;
    info_.live = true;
  }
  ~OpenNI2Device() override {
    if (stream_.isValid()) {
      stream_.stop();
      std::this_thread::sleep_for(kStreamPause);
      stream_.destroy();
    }
    device_.close();
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<void> start() {
    if (device_.open(uri_.empty() ? openni::ANY_DEVICE : uri_.c_str()) != openni::STATUS_OK)
      return complain("does not open: " + openni2_complaint("is it plugged in?") + "; `armature doctor` tells more");
    if (stream_.create(device_, openni::SENSOR_DEPTH) != openni::STATUS_OK)
      return complain("has no depth: " + openni2_complaint("no reason given"));
    choose_mode();
    if (stream_.start() != openni::STATUS_OK)
      return complain("does not start: " + openni2_complaint("no reason given"));
    const openni::VideoMode mode = stream_.getVideoMode();
    switch (mode.getPixelFormat()) {
      case openni::PIXEL_FORMAT_DEPTH_1_MM: tenths_ = 10; break;
      case openni::PIXEL_FORMAT_DEPTH_100_UM: tenths_ = 1; break;
      default: return complain("sends depth in a unit that is not known here");
    }
    const int width = mode.getResolutionX(), height = mode.getResolutionY();
    const auto focal_px = [](int pixels, float fov_rad) {
      return pixels / (2 * std::tan(static_cast<double>(fov_rad) / 2));
    };
    info_.intrinsics = {width,
                        height,
                        focal_px(width, stream_.getHorizontalFieldOfView()),
                        focal_px(height, stream_.getVerticalFieldOfView()),
                        width / 2.0,
                        height / 2.0};
    const auto plausible = [](double px) { return std::isfinite(px) && px > 1; };
    if (width < 1 || height < 1 || width > kMaxImageSide || height > kMaxImageSide ||
        !plausible(info_.intrinsics.focal_x_px) || !plausible(info_.intrinsics.focal_y_px))
      return complain("says nothing sensible about its image");
    info_.frames_per_second = mode.getFps();
    return {};
  }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    openni::VideoStream* streams[] = {&stream_};
    int ready = -1;
    const auto status = openni::OpenNI::waitForAnyStream(streams, 1, &ready, static_cast<int>(timeout.count()));
    if (status == openni::STATUS_TIME_OUT) return ReadStatus::Timeout;
    if (status != openni::STATUS_OK) return complain("broke: " + openni2_complaint("unplugged?"));
    openni::VideoFrameRef image;
    if (stream_.readFrame(&image) != openni::STATUS_OK) return complain(openni2_complaint("a frame cannot be read"));
    const Intrinsics& k = info_.intrinsics;
    const auto row_bytes = static_cast<std::size_t>(k.width) * sizeof(std::uint16_t);
    if (image.getWidth() != k.width || image.getHeight() != k.height ||
        static_cast<std::size_t>(image.getStrideInBytes()) < row_bytes ||
        static_cast<std::size_t>(image.getDataSize()) < row_bytes * static_cast<std::size_t>(k.height))
      return ReadStatus::Timeout;  // a torn one: the next may be whole
    frame.depth_mm.resize(static_cast<std::size_t>(k.width) * static_cast<std::size_t>(k.height));
    for (int y = 0; y < k.height; ++y) {
      std::memcpy(frame.depth_mm.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(k.width),
                  static_cast<const char*>(image.getData()) + static_cast<std::ptrdiff_t>(y) * image.getStrideInBytes(),
                  row_bytes);
    }
    if (tenths_ != 10) {
      for (std::uint16_t& depth : frame.depth_mm) depth = static_cast<std::uint16_t>((depth + 5) / 10);
    }
    frame.intrinsics = k;
    frame.sequence = static_cast<std::uint64_t>(image.getFrameIndex());
    frame.sensor = {std::chrono::microseconds(image.getTimestamp()), ClockId::Device};
    frame.host = {clock_->now(), ClockId::HostMonotonic};
    return ReadStatus::Frame;
  }

  Expected<void> recover(RecoverBy by) override {
    if (by == RecoverBy::ResettingDevice) {
      const std::string port = usb_port_of_openni2(device_.getDeviceInfo().getUri());
      return port.empty() ? complain("is on no USB that could be reset") : reset_usb_device(port);
    }
    stream_.stop();
    std::this_thread::sleep_for(kStreamPause);
    if (stream_.start() != openni::STATUS_OK) return complain("does not start again");
    return {};
  }

 private:
  void choose_mode() {
    const auto& modes = device_.getSensorInfo(openni::SENSOR_DEPTH)->getSupportedVideoModes();
    for (int i = 0; i < modes.getSize(); ++i) {
      const openni::VideoMode& mode = modes[i];
      if (mode.getResolutionX() == 640 && mode.getResolutionY() == 480 && mode.getFps() == 30 &&
          mode.getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_1_MM) {
        stream_.setVideoMode(mode);
        return;
      }
    }
  }
  [[nodiscard]] tl::unexpected<Error> complain(const std::string& what) const { return fail(info_.uri + ": " + what); }

  std::string uri_;
  std::shared_ptr<Clock> clock_;
  SourceInfo info_;
  openni::Device device_;
  openni::VideoStream stream_;
  int tenths_ = 10;  // of a millimetre, in a unit of the stream
};

}  // namespace

Expected<std::unique_ptr<DepthSource>> open_openni2_device(std::string_view uri, const OpenOptions& options) {
  if (auto loaded = load_openni2(); !loaded) return tl::unexpected(loaded.error());
  auto source = std::make_unique<OpenNI2Device>(uri, options);
  if (auto started = source->start(); !started) return tl::unexpected(started.error());
  return std::unique_ptr<DepthSource>(std::move(source));
}

}  // namespace armature
