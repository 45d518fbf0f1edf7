#include "firmware_host/backends/openni2.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <optional>
#include <thread>

#include <OpenNI.h>

#include "firmware_host/backends/openni2_runtime.h"
#include "firmware_host/backends/pacer.h"
#include "firmware_host/recording/depth_codec.h"
#include "firmware_host/recording/file_reader.h"
#include "firmware_host/recording/oni_layout.h"
#include "firmware_host/recording/sidecar.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

constexpr float kOneFrameATime = -1;        // the player hands out a frame when it is asked for one
constexpr int kPlayerPatience_ms = 30'000;  // an image takes it a millisecond
constexpr auto kPlayerPause = 20ms;         // its thread looks every 10 ms whether its stream still runs

Expected<SourceInfo> describe(const std::filesystem::path& path, const OniLayout& layout) {
  SourceInfo info;
  info.uri = "oni:" + path.string();
  info.frame_count = static_cast<long>(layout.frames.size());
  const auto beside = sidecar_path(path);
  std::error_code ignored;
  if (std::filesystem::exists(beside, ignored)) {
    const auto facts = read_sidecar(beside);
    if (!facts) return tl::unexpected(facts.error());
    info.intrinsics = facts->intrinsics;
    info.frames_per_second = facts->frames_per_second;
    if (info.intrinsics.width != layout.width || info.intrinsics.height != layout.height)
      return fail(beside.string() + ": says " + std::to_string(info.intrinsics.width) + " x " +
                  std::to_string(info.intrinsics.height) + ": expected " + std::to_string(layout.width) + " x " +
                  std::to_string(layout.height) + " as in the recording");
    return info;
  }
  const auto focal_px = [](int pixels, double fov_rad) { return pixels / (2 * std::tan(fov_rad / 2)); };
  const auto plausible = [](double fov_rad) { return fov_rad > 0.001 && fov_rad < std::numbers::pi - 0.001; };
  if (!plausible(layout.horizontal_fov_rad) || !plausible(layout.vertical_fov_rad))
    return fail(path.string() + ": holds no field of view: expected the intrinsics in " + beside.string());
  info.intrinsics = {layout.width,
                     layout.height,
                     focal_px(layout.width, layout.horizontal_fov_rad),
                     focal_px(layout.height, layout.vertical_fov_rad),
                     layout.width / 2.0,
                     layout.height / 2.0};
  if (layout.frames_per_second > 0) info.frames_per_second = layout.frames_per_second;
  return info;
}

/// What `record` says of the image in `frame`.
void stamp(DepthFrame& frame, const OniFrameRecord& record, const SourceInfo& info, std::chrono::nanoseconds now) {
  frame.intrinsics = info.intrinsics;
  frame.sequence = record.index - 1;
  frame.sensor = {std::chrono::microseconds(record.timestamp_us), ClockId::Recording};
  frame.host = {now, ClockId::HostMonotonic};
}

class OniSource final : public DepthSource {
 public:
  OniSource(FileReader file, OniLayout layout, SourceInfo info, const OpenOptions& options)
      : file_(std::move(file)),
        layout_(std::move(layout)),
        info_(std::move(info)),
        pacer_(options),
        clock_(options.clock) {}

  // In this order, with the pause: the player's thread walks its list of streams without a lock.
  ~OniSource() override {
    if (stream_.isValid()) {
      stream_.stop();
      std::this_thread::sleep_for(kPlayerPause);
      stream_.destroy();
    }
    device_.close();
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<void> start() {
    scratch_.resize(static_cast<std::size_t>(layout_.width) * static_cast<std::size_t>(layout_.height));
    if (auto checked = check_images_through(0); !checked) return checked;
    const auto complain = [&](const char* step) {
      return fail(info_.uri.substr(4) + ": OpenNI2 cannot play it: " + openni2_complaint(step));
    };
    // By its descriptor: the file that was checked, whatever its name says now, and a name of its own a source.
    if (device_.open(file_.path_of_descriptor().c_str()) != openni::STATUS_OK) return complain("it does not open");
    if (!device_.isFile()) return complain("it is not taken for a recording");
    auto* control = device_.getPlaybackControl();
    // Repeating: after the last frame the player waits at the first instead of spinning.
    if (control == nullptr || control->setSpeed(kOneFrameATime) != openni::STATUS_OK ||
        control->setRepeatEnabled(true) != openni::STATUS_OK)
      return complain("its speed cannot be set");
    if (stream_.create(device_, openni::SENSOR_DEPTH) != openni::STATUS_OK) return complain("no depth stream");
    if (stream_.start() != openni::STATUS_OK) return complain("its stream does not start");
    return {};
  }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    if (next_ == layout_.frames.size()) return ReadStatus::EndOfStream;
    const OniFrameRecord& record = layout_.frames[next_];
    if (!pacer_.wait_until_due(std::chrono::microseconds(record.timestamp_us), timeout)) return ReadStatus::Timeout;

    // The player reads one image ahead.
    const auto ahead = std::min(next_ + 1, layout_.frames.size() - 1);
    if (auto checked = check_images_through(ahead); !checked) return tl::unexpected(checked.error());
    if (auto played = play(record, frame); !played) return tl::unexpected(played.error());
    stamp(frame, record, info_, clock_->now());
    ++next_;
    return ReadStatus::Frame;
  }

 private:
  Expected<void> check_images_through(std::size_t last) {
    for (; checked_ <= last; ++checked_) {
      const OniFrameRecord& record = layout_.frames[checked_];
      payload_.resize(record.payload_bytes);
      const std::string place = info_.uri.substr(4) + ": image " + std::to_string(record.index) + " at byte " +
                                std::to_string(record.payload_offset);
      if (!file_.read_at(record.payload_offset, payload_)) return fail(place + " is gone: the file has changed");
      if (!decode_depth(layout_.codec, payload_, scratch_))
        return fail(place + " is corrupt: expected " + std::to_string(layout_.width) + " x " +
                    std::to_string(layout_.height) + " coded pixels");
    }
    return {};
  }

  Expected<void> play(const OniFrameRecord& record, DepthFrame& frame) {
    const auto complain = [&](const std::string& what) {
      return fail(info_.uri.substr(4) + ": image " + std::to_string(record.index) + ": OpenNI2 " + what);
    };
    openni::VideoStream* streams[] = {&stream_};
    int ready = -1;
    if (openni::OpenNI::waitForAnyStream(streams, 1, &ready, kPlayerPatience_ms) != openni::STATUS_OK)
      return complain("stopped playing: " + openni2_complaint("no reason given"));
    openni::VideoFrameRef image;
    if (stream_.readFrame(&image) != openni::STATUS_OK) return complain(openni2_complaint("cannot read it"));
    if (static_cast<std::uint32_t>(image.getFrameIndex()) != record.index ||
        image.getTimestamp() != record.timestamp_us)
      return complain("played image " + std::to_string(image.getFrameIndex()) + " instead");
    const auto row_bytes = static_cast<std::size_t>(layout_.width) * sizeof(std::uint16_t);
    if (image.getWidth() != layout_.width || image.getHeight() != layout_.height ||
        static_cast<std::size_t>(image.getStrideInBytes()) != row_bytes ||
        static_cast<std::size_t>(image.getDataSize()) != scratch_.size() * sizeof(std::uint16_t))
      return complain("played it in another size");
    frame.depth_mm.resize(scratch_.size());
    std::memcpy(frame.depth_mm.data(), image.getData(), scratch_.size() * sizeof(std::uint16_t));
    return {};
  }

  FileReader file_;
  OniLayout layout_;
  SourceInfo info_;
  Pacer pacer_;
  std::shared_ptr<Clock> clock_;
  openni::Device device_;
  openni::VideoStream stream_;
  std::size_t next_ = 0;     // image
  std::size_t checked_ = 0;  // images before this one are safe to play
  std::vector<std::byte> payload_;
  std::vector<std::uint16_t> scratch_;
};

/// A recording whose recorder was killed. OpenNI2's player wants its end; we decode what is there ourselves.
class UnfinishedOniSource final : public DepthSource {
 public:
  UnfinishedOniSource(FileReader file, OniLayout layout, SourceInfo info, const OpenOptions& options)
      : file_(std::move(file)),
        layout_(std::move(layout)),
        info_(std::move(info)),
        pacer_(options),
        clock_(options.clock) {}

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    if (next_ == layout_.frames.size()) return ReadStatus::EndOfStream;
    const OniFrameRecord& record = layout_.frames[next_];
    if (!pacer_.wait_until_due(std::chrono::microseconds(record.timestamp_us), timeout)) return ReadStatus::Timeout;
    payload_.resize(record.payload_bytes);
    frame.depth_mm.resize(static_cast<std::size_t>(layout_.width) * static_cast<std::size_t>(layout_.height));
    if (!file_.read_at(record.payload_offset, payload_) || !decode_depth(layout_.codec, payload_, frame.depth_mm))
      return fail(info_.uri.substr(4) + ": image " + std::to_string(record.index) + " at byte " +
                  std::to_string(record.payload_offset) + " is corrupt");
    stamp(frame, record, info_, clock_->now());
    ++next_;
    return ReadStatus::Frame;
  }

 private:
  FileReader file_;
  OniLayout layout_;
  SourceInfo info_;
  Pacer pacer_;
  std::shared_ptr<Clock> clock_;
  std::size_t next_ = 0;
  std::vector<std::byte> payload_;
};

}  // namespace

Expected<std::unique_ptr<DepthSource>> open_oni(const std::filesystem::path& path, const OpenOptions& options) {
  auto file = FileReader::open(path);
  if (!file) return tl::unexpected(file.error());
  auto layout = read_oni_layout(*file, path.string());
  if (!layout) return tl::unexpected(layout.error());
  auto info = describe(path, *layout);
  if (!info) return tl::unexpected(info.error());
  if (layout->unfinished) {
    return std::make_unique<UnfinishedOniSource>(std::move(*file), std::move(*layout), std::move(*info), options);
  }
  if (auto loaded = load_openni2(); !loaded) return tl::unexpected(loaded.error());
  auto source = std::make_unique<OniSource>(std::move(*file), std::move(*layout), std::move(*info), options);
  if (auto started = source->start(); !started) return tl::unexpected(started.error());
  return source;
}

}  // namespace armature
