#include "tracker/daemon/frame_guard.h"

#include <algorithm>
#include <utility>

namespace armature {
namespace {

using namespace std::chrono_literals;

/// Every so many rows is looked at: whole ones, so that the others need not come from memory.
constexpr int kEvery = 8;
/// Sensors see no farther, but for single wrong pixels.
constexpr std::uint16_t kFarthest_mm = 12'000;
constexpr std::int64_t kWrongShare = 20;  // one in so many is too many
/// Odd frames in a row that become the new normal.
constexpr int kNewNormal = 5;
/// The sensor's clock and ours may disagree so far about the time between two frames.
constexpr std::chrono::nanoseconds kJump = 500ms;
/// An image that shows something and has been the same for so long is frozen.
constexpr std::chrono::nanoseconds kFrozen = 120ms;
/// FNV-1a, over rows.
constexpr std::uint64_t kHashBasis = 0xcbf29ce484222325, kHashPrime = 0x100000001b3;

}  // namespace

const char* FrameGuard::complaint(const DepthView& frame) noexcept {
  const auto& k = frame.intrinsics;
  if (k.width <= 0 || k.height <= 0 || k.width > kMaxImageSide || k.height > kMaxImageSide ||
      frame.depth_mm.size() != static_cast<std::size_t>(k.width) * static_cast<std::size_t>(k.height)) {
    return "a torn frame";
  }
  std::int64_t looked_at = 0, seen = 0, wrong = 0;
  std::uint64_t image = kHashBasis;
  const auto width = static_cast<std::size_t>(k.width);
  for (int v = 0; v < k.height; v += kEvery) {
    const auto row = frame.depth_mm.subspan(static_cast<std::size_t>(v) * width, width);
    int seen_in_row = 0, wrong_in_row = 0;
    std::uint32_t weighed = 0;  // by odd numbers: it differs wherever a pixel does
    for (std::uint32_t u = 0; u < width; ++u) {
      seen_in_row += row[u] != 0 ? 1 : 0;
      wrong_in_row += row[u] > kFarthest_mm ? 1 : 0;
      weighed += row[u] * (2 * u + 1);
    }
    image = (image ^ weighed) * kHashPrime;
    looked_at += k.width;
    seen += seen_in_row;
    wrong += wrong_in_row;
  }
  if (wrong * kWrongShare > looked_at) return "a garbage frame";
  if (image != std::exchange(image_, image)) image_since_ = frame.host.time;
  if (shows(seen, looked_at) && frame.host.time - image_since_ >= kFrozen) return "a frozen image";
  if (frame.sensor.time == std::exchange(last_time_, frame.sensor.time)) return "a clock that stands still";

  const char* odd = nullptr;
  if (known_) {
    const auto by_sensor = frame.sensor.time - sensor_, by_host = frame.host.time - host_;
    const auto apart = by_sensor > by_host ? by_sensor - by_host : by_host - by_sensor;
    if (k != intrinsics_) odd = "a frame of another size";
    if (by_sensor <= 0ns || apart > kJump) odd = "a jump of the sensor's clock";
    if (k == intrinsics_ && seen * 2 < seen_pixels_) odd = "a torn frame";
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
  looked_at_ = looked_at;
  return nullptr;
}

}  // namespace armature
