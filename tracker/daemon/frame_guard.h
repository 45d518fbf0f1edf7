#pragma once

#include <chrono>
#include <cstdint>

#include "firmware_host/depth_frame.h"

namespace armature {

/// Tells frames that nobody may steer by from good ones: of another size than they say, full of depths that no sensor
/// sees, suddenly without half of their image, of a time that has jumped or stands still, or of an image that does: no
/// sensor sees anything twice without noise. What keeps coming (a sensor that was opened anew counts from zero,
/// somebody stands right before the lens) is the new normal after a few frames; what contradicts itself or stands still
/// never is. Thread-safe: no. Realtime-safe: yes.
class FrameGuard {
 public:
  /// An image of which no more than this share of pixels sees anything shows nothing.
  static constexpr double kNoSight = 1e-3;

  /// Null for a good frame, else what is wrong with it, in a word or two.
  [[nodiscard]] const char* complaint(const DepthView& frame) noexcept;

  /// Whether the last good frame showed something; true before any.
  [[nodiscard]] bool sees() const noexcept { return looked_at_ == 0 || shows(seen_pixels_, looked_at_); }

  /// The stream has been interrupted: the next frame may be anything that is consistent in itself.
  void start_over() noexcept { known_ = false; }

 private:
  [[nodiscard]] static bool shows(std::int64_t seen, std::int64_t looked_at) noexcept {
    return static_cast<double>(seen) > kNoSight * static_cast<double>(looked_at);
  }

  bool known_ = false;
  Intrinsics intrinsics_;
  std::chrono::nanoseconds sensor_{0}, host_{0};
  std::int64_t seen_pixels_ = 0, looked_at_ = 0;                          // of the last good frame
  std::uint64_t image_ = 0;                                               // what was looked at, as a number;
  std::chrono::nanoseconds image_since_{0};                               // and since when it is the same, by the host
  std::chrono::nanoseconds last_time_ = std::chrono::nanoseconds::min();  // of any frame, by the sensor
  int odd_in_a_row_ = 0;
};

}  // namespace armature
