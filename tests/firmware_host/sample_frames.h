#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "firmware_host/depth_frame.h"
#include "firmware_host/recording/recorder.h"

namespace armature::test {

/// Depth that exercises every form of the codec: slopes, steps, runs, noise and both ends of the range. The same
/// arguments give the same frame.
inline DepthFrame sample_frame(int width, int height, std::uint64_t number) {
  DepthFrame frame;
  frame.intrinsics = {width, height, width * 0.9, width * 0.91, width / 2.0 - 0.25, height / 2.0 + 0.75};
  frame.sequence = number;
  frame.sensor = {std::chrono::microseconds(number * 33333 + number % 7), ClockId::Synthetic};
  frame.depth_mm.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  std::uint32_t random = static_cast<std::uint32_t>(number) * 2654435761U + 12345;
  for (std::size_t i = 0; i < frame.depth_mm.size(); ++i) {
    random = random * 1664525U + 1013904223U;
    const auto stripe = (i / 37 + number) % 6;
    const auto noise = static_cast<std::uint16_t>(random >> 20);
    switch (stripe) {
      case 0: frame.depth_mm[i] = 0; break;
      case 1: frame.depth_mm[i] = static_cast<std::uint16_t>(1500 + i % 37); break;
      case 2: frame.depth_mm[i] = static_cast<std::uint16_t>(800 + noise % 5); break;
      case 3: frame.depth_mm[i] = static_cast<std::uint16_t>(noise * 15); break;
      case 4: frame.depth_mm[i] = 2222; break;
      default: frame.depth_mm[i] = static_cast<std::uint16_t>(i % 2 == 0 ? 65534 : 1); break;
    }
  }
  return frame;
}

inline std::vector<DepthFrame> sample_frames(int width, int height, std::uint64_t count) {
  std::vector<DepthFrame> frames;
  for (std::uint64_t i = 0; i < count; ++i) frames.push_back(sample_frame(width, height, i));
  return frames;
}

/// Frames that are there already, as a source.
class FrameSource final : public DepthSource {
 public:
  explicit FrameSource(std::vector<DepthFrame> frames, double frames_per_second = 30) : frames_(std::move(frames)) {
    info_.uri = "test:frames";
    info_.frames_per_second = frames_per_second;
    if (!frames_.empty()) info_.intrinsics = frames_.front().intrinsics;
    info_.frame_count = static_cast<long>(frames_.size());
  }
  /// As a sensor: live.
  void go_live() { info_.live = true; }
  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds) override {
    if (next_ == frames_.size()) return ReadStatus::EndOfStream;
    frame = frames_[next_++];
    return ReadStatus::Frame;
  }

 private:
  std::vector<DepthFrame> frames_;
  SourceInfo info_;
  std::size_t next_ = 0;
};

inline void record(const std::filesystem::path& path, const std::vector<DepthFrame>& frames, double fps = 30) {
  FrameSource source(frames, fps);
  if (const auto count = write_recording(path, source); !count) throw std::runtime_error(count.error().message);
}

}  // namespace armature::test
