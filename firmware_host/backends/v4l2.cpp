#include "firmware_host/backends/v4l2.h"

#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <numbers>
#include <thread>

#include <fcntl.h>
#include <linux/videodev2.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include "firmware_host/backends/freenect.h"
#include "firmware_host/control/usb.h"
#include "firmware_host/control/video_nodes.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// The nominal horizontal field of view of depth cameras and the unit of their Z16, as they leave the factory, by a
/// part of the name that their driver gives.
struct Model {
  std::string_view name;
  double horizontal_fov_deg;
  double unit_mm;
};
constexpr std::array<Model, 6> kModels = {{{"D415", 65, 1},
                                           {"D435", 87, 1},
                                           {"D455", 87, 1},
                                           {"D405", 87, 0.1},
                                           {"SR300", 71.5, 0.125},
                                           {"SR305", 71.5, 0.125}}};
constexpr double kKinectFocal_px = 575.8;  // of 640 pixels
constexpr std::size_t kBuffers = 4;
constexpr std::uint16_t kNoDisparity = 1023;
/// Z16 goes on to 65 m, where nothing is known to a few metres: what is farther is not seen.
constexpr double kFarthest_mm = 10'000;
/// A regular file in a test, or a driver that wakes too early, is readable and has nothing to read.
constexpr auto kNothingYet = 2ms;

std::string_view text_of(const __u8* name, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(name), size);
  return text.substr(0, text.find('\0'));
}

class V4l2Source final : public DepthSource {
 public:
  V4l2Source(std::string_view path, double focal_px, const OpenOptions& options)
      : path_(path), wanted_focal_px_(focal_px), clock_(options.clock) {
    info_.uri = "v4l2:" + path_;
    info_.live = true;
  }
  ~V4l2Source() override {
    stream(false);
    unmap();
    if (descriptor_ >= 0) ::close(descriptor_);
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<void> start() {
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0) {
      const int error = errno;
      if (error == ENOENT) return complain("no such device; `armature devices` lists what is plugged in");
      if (error == EBUSY) return complain("in use by another program; `armature doctor` tells which");
      return complain(std::string(std::strerror(error)) + "; `armature doctor` tells what to do");
    }
    v4l2_capability capability{};
    if (!control(VIDIOC_QUERYCAP, capability)) return complain("is no video device");
    const auto capabilities =
        (capability.capabilities & V4L2_CAP_DEVICE_CAPS) != 0 ? capability.device_caps : capability.capabilities;
    if ((capabilities & V4L2_CAP_VIDEO_CAPTURE) == 0 || (capabilities & V4L2_CAP_STREAMING) == 0)
      return complain("does not stream images");
    if (auto chosen = choose_format(); !chosen) return chosen;
    if (auto known = find_intrinsics(text_of(capability.card, sizeof capability.card)); !known) return known;
    if (auto mapped = map_buffers(); !mapped) return mapped;
    if (!stream(true)) return complain("its stream does not start: is there bandwidth left on its USB bus?");
    return {};
  }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    const auto until = clock_->now() + timeout;
    for (bool said_readable = false;;) {
      v4l2_buffer buffer = blank_buffer();
      if (control(VIDIOC_DQBUF, buffer)) {
        const bool taken = take(buffer, frame);
        v4l2_buffer again = blank_buffer();
        again.index = buffer.index;
        if (!control(VIDIOC_QBUF, again)) return complain("stopped: " + std::string(std::strerror(errno)));
        if (taken) return ReadStatus::Frame;
        continue;  // a torn frame
      }
      if (errno != EAGAIN && errno != EINTR) return complain("broke: " + std::string(std::strerror(errno)));
      if (said_readable) std::this_thread::sleep_for(kNothingYet);
      const auto left = until - clock_->now();
      if (left <= 0ns) return ReadStatus::Timeout;
      pollfd event{descriptor_, POLLIN, 0};
      const auto ms = std::chrono::ceil<std::chrono::milliseconds>(left).count();
      said_readable = ::poll(&event, 1, static_cast<int>(ms)) > 0;
    }
  }

  Expected<void> recover(RecoverBy by) override {
    if (by == RecoverBy::ResettingDevice) {
      const std::string port = usb_port_of_video(path_);
      return port.empty() ? complain("is on no USB that could be reset") : reset_usb_device(port);
    }
    if (!stream(false) || !queue_all() || !stream(true)) return complain("its stream does not start again");
    return {};
  }

 private:
  struct Mapping {
    void* memory = MAP_FAILED;
    std::size_t size = 0;
  };

  template <class Argument>
  bool control(unsigned long request, Argument& argument) const {
    int result = 0;
    do {
      result = ::ioctl(descriptor_, request, &argument);
    } while (result < 0 && errno == EINTR);
    return result >= 0;
  }
  [[nodiscard]] static v4l2_buffer blank_buffer() {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    return buffer;
  }
  bool stream(bool on) const {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    return descriptor_ >= 0 && control(on ? VIDIOC_STREAMON : VIDIOC_STREAMOFF, type);
  }

  Expected<void> choose_format() {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (!control(VIDIOC_G_FMT, format)) return complain("does not tell its format");
    const std::uint32_t offered = format.fmt.pix.pixelformat;
    if (offered != V4L2_PIX_FMT_Y10BPACK) {
      format.fmt.pix.pixelformat = V4L2_PIX_FMT_Z16;
      format.fmt.pix.width = 640;
      format.fmt.pix.height = 480;
      format.fmt.pix.field = V4L2_FIELD_ANY;
      // What it does not take is seen by what it has instead.
      if (!control(VIDIOC_S_FMT, format) && !control(VIDIOC_G_FMT, format)) return complain("does not take Z16");
    }
    const v4l2_pix_format& pix = format.fmt.pix;
    packed_ = pix.pixelformat == V4L2_PIX_FMT_Y10BPACK;
    if (!packed_ && pix.pixelformat != V4L2_PIX_FMT_Z16) return complain("sends no depth: expected Z16 or Y10B");
    if (pix.width < 1 || pix.height < 1 || pix.width > kMaxImageSide || pix.height > kMaxImageSide)
      return complain("has an image of " + std::to_string(pix.width) + " x " + std::to_string(pix.height));
    info_.intrinsics.width = static_cast<int>(pix.width);
    info_.intrinsics.height = static_cast<int>(pix.height);
    const std::size_t row = packed_ ? (std::size_t{pix.width} * 10 + 7) / 8 : std::size_t{pix.width} * 2;
    row_bytes_ = std::max<std::size_t>(pix.bytesperline, row);
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (control(VIDIOC_G_PARM, parameters)) {
      const v4l2_fract& period = parameters.parm.capture.timeperframe;
      if (period.numerator > 0 && period.denominator > 0)
        info_.frames_per_second = static_cast<double>(period.denominator) / period.numerator;
    }
    return {};
  }

  Expected<void> find_intrinsics(std::string_view card) {
    Intrinsics& k = info_.intrinsics;
    double focal_px = wanted_focal_px_;
    if (focal_px == 0 && packed_) focal_px = kKinectFocal_px * k.width / 640;
    for (const Model& model : kModels) {
      if (card.find(model.name) == std::string_view::npos) continue;
      if (focal_px == 0) focal_px = k.width / (2 * std::tan(model.horizontal_fov_deg * std::numbers::pi / 360));
      unit_mm_ = model.unit_mm;
    }
    if (focal_px == 0)
      return complain("is a '" + std::string(card) + "', whose focal length is not known: add ?focal_px=F");
    k.focal_x_px = k.focal_y_px = focal_px;
    k.centre_x_px = k.width / 2.0;
    k.centre_y_px = k.height / 2.0;
    return {};
  }

  Expected<void> map_buffers() {
    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (!control(VIDIOC_REQBUFS, request) || request.count < 2)
      return complain(errno == EBUSY ? "in use by another program" : "has no memory-mapped buffers");
    buffers_ = std::min<std::size_t>(request.count, kBuffers);
    for (std::size_t i = 0; i < buffers_; ++i) {
      v4l2_buffer buffer = blank_buffer();
      buffer.index = static_cast<__u32>(i);
      if (!control(VIDIOC_QUERYBUF, buffer)) return complain("does not tell about its buffers");
      mappings_[i] = {::mmap(nullptr, buffer.length, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, buffer.m.offset),
                      buffer.length};
      if (mappings_[i].memory == MAP_FAILED) return complain("its buffers cannot be mapped");
    }
    if (!queue_all()) return complain("does not take its buffers");
    return {};
  }
  bool queue_all() const {
    for (std::size_t i = 0; i < buffers_; ++i) {
      v4l2_buffer buffer = blank_buffer();
      buffer.index = static_cast<__u32>(i);
      if (!control(VIDIOC_QBUF, buffer)) return false;
    }
    return true;
  }
  void unmap() {
    for (Mapping& mapping : mappings_) {
      if (mapping.memory != MAP_FAILED) ::munmap(mapping.memory, mapping.size);
    }
  }

  /// False where the buffer does not hold a whole image.
  bool take(const v4l2_buffer& buffer, DepthFrame& frame) {
    const auto width = static_cast<std::size_t>(info_.intrinsics.width);
    const auto height = static_cast<std::size_t>(info_.intrinsics.height);
    if (buffer.index >= buffers_ || (buffer.flags & V4L2_BUF_FLAG_ERROR) != 0) return false;
    const Mapping& mapping = mappings_[buffer.index];
    const std::size_t row = packed_ ? (width * 10 + 7) / 8 : width * 2;
    const std::size_t needed = row_bytes_ * (height - 1) + row;
    if (buffer.bytesused < needed || mapping.size < needed) return false;
    frame.depth_mm.resize(width * height);
    const auto* bytes = static_cast<const std::uint8_t*>(mapping.memory);
    for (std::size_t y = 0; y < height; ++y) {
      const std::span<std::uint16_t> out = std::span(frame.depth_mm).subspan(y * width, width);
      if (packed_) {
        unpack_y10b({bytes + y * row_bytes_, row}, out);
        for (std::uint16_t& pixel : out)
          pixel = pixel == kNoDisparity ? std::uint16_t{0} : mm_of_raw_[std::size_t{pixel} * 2];
      } else {
        std::memcpy(out.data(), bytes + y * row_bytes_, row);
        for (std::uint16_t& pixel : out) {
          const double mm = pixel * unit_mm_;
          pixel = mm <= kFarthest_mm ? static_cast<std::uint16_t>(std::lround(mm)) : std::uint16_t{0};
        }
      }
    }
    frame.intrinsics = info_.intrinsics;
    frame.sequence = buffer.sequence;
    const auto time =
        std::chrono::seconds(buffer.timestamp.tv_sec) + std::chrono::microseconds(buffer.timestamp.tv_usec);
    const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    frame.sensor = {time, monotonic ? ClockId::HostMonotonic : ClockId::Device};
    frame.host = {clock_->now(), ClockId::HostMonotonic};
    return true;
  }

  [[nodiscard]] tl::unexpected<Error> complain(const std::string& what) const { return fail(info_.uri + ": " + what); }

  std::string path_;
  double wanted_focal_px_;
  std::shared_ptr<Clock> clock_;
  SourceInfo info_;
  int descriptor_ = -1;
  bool packed_ = false;
  double unit_mm_ = 1;  // of Z16
  std::size_t row_bytes_ = 0;
  std::size_t buffers_ = 0;
  std::array<Mapping, kBuffers> mappings_;
  std::array<std::uint16_t, 2048> mm_of_raw_ = kinect_raw_to_mm();
};

}  // namespace

void unpack_y10b(std::span<const std::uint8_t> packed, std::span<std::uint16_t> disparity) noexcept {
  std::uint32_t window = 0;
  int bits = 0;
  std::size_t next = 0;
  for (std::uint16_t& value : disparity) {
    while (bits < 10) {
      window = window << 8U | packed[next++];
      bits += 8;
    }
    bits -= 10;
    value = static_cast<std::uint16_t>(window >> static_cast<unsigned>(bits) & 0x3FFU);
  }
}

Expected<std::unique_ptr<DepthSource>> open_v4l2(std::string_view path_and_options, const OpenOptions& options) {
  const auto question = path_and_options.find('?');
  double focal_px = 0;
  if (question != std::string_view::npos) {
    constexpr std::string_view kKey = "focal_px=";
    auto option = path_and_options.substr(question + 1);
    const bool known = option.starts_with(kKey);
    option.remove_prefix(known ? kKey.size() : 0);
    const auto [end, error] = std::from_chars(option.data(), option.data() + option.size(), focal_px);
    if (!known || error != std::errc() || end != option.data() + option.size() ||
        !(focal_px >= 10 && focal_px <= 10'000))
      return fail("source 'v4l2:" + std::string(path_and_options) + "': expected ?focal_px=F, F from 10 to 10000");
  }
  auto source = std::make_unique<V4l2Source>(path_and_options.substr(0, question), focal_px, options);
  if (auto started = source->start(); !started) return tl::unexpected(started.error());
  return std::unique_ptr<DepthSource>(std::move(source));
}

}  // namespace armature
