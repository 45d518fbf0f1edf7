#include "tracker/daemon/frame_guard.h"

#include <algorithm>

namespace armature {
namespace {

using namespace std::chrono_literals;

/// Every so many pixels is looked at.
constexpr std::size_t kStride = 7;
/// Sensors see no farther, but for single wrong pixels.
constexpr std::uint16_t kFarthest_mm = 12'000;
constexpr std::int64_t kWrongShare = 20;  // one in so many is too many
/// Odd frames in a row that become the new normal.
constexpr int kNewNormal = 5;
/// The sensor's clock and ours may disagree so far about the time between two frames.
constexpr std::chrono::nanoseconds kJump = 500ms;

}  // namespace

const char* FrameGuard::complaint(const DepthView& frame) noexcept {
  const auto& k = frame.intrinsics;
  if (k.width <= 0 || k.height <= 0 || k.width > kMaxImageSide || k.height > kMaxImageSide ||
      frame.depth_mm.size() != static_cast<std::size_t>(k.width) * static_cast<std::size_t>(k.height)) {
    return "a torn frame";
  }
  std::int64_t looked_at = 0, seen = 0, wrong = 0;
  for (std::size_t i = 0; i < frame.depth_mm.size(); i += kStride) {
    ++looked_at;
    seen += frame.depth_mm[i] != 0 ? 1 : 0;
    wrong += frame.depth_mm[i] > kFarthest_mm ? 1 : 0;
  }
  if (wrong * kWrongShare > looked_at) return "a garbage frame";

  const char* odd = nullptr;
  if (known_) {
    const auto by_sensor = frame.sensor.time - sensor_, by_host = frame.host.time - host_;
    const auto apart = by_sensor > by_host ? by_sensor - by_host : by_host - by_sensor;
    if (k != intrinsics_) odd = "a frame of another size";
    if (by_sensor <= 0ns || apart > kJump) odd = "a jump of the sensor's clock";
    if (seen * 2 < seen_pixels_) odd = "a torn frame";
  }
  if (odd != nullptr && ++odd_in_a_row_ < kNewNormal) {
    return odd;
  }
  odd_in_a_row_ = 0;
  known_ = true;
  intrinsics_ = k;
  sensor_ = frame.sensor.time;
  host_ = frame.host.time;
  seen_pixels_ = seen;
  return nullptr;
}

}  // namespace armature
