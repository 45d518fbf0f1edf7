#pragma once

#include <chrono>
#include <cstdint>

#include "firmware_host/depth_frame.h"

namespace armature {

/// Tells frames that nobody may steer by from good ones: of another size than they say, full of depths that no sensor
/// sees, suddenly without half of their image, or of a time that has jumped. What keeps coming (a sensor that was
/// opened anew counts from zero, somebody stands right before the lens) is the new normal after a few frames; what
/// contradicts itself never is. Thread-safe: no. Realtime-safe: yes.
class FrameGuard {
 public:
  /// Null for a good frame, else what is wrong with it, in a word or two.
  [[nodiscard]] const char* complaint(const DepthView& frame) noexcept;

  /// The share of the last good frame's pixels that see anything, of those looked at; 1 before any.
  [[nodiscard]] double seen_share() const noexcept {
    return looked_at_ == 0 ? 1.0 : static_cast<double>(seen_pixels_) / static_cast<double>(looked_at_);
  }

  /// The stream has been interrupted: the next frame may be anything that is consistent in itself.
  void start_over() noexcept { known_ = false; }

 private:
  bool known_ = false;
  Intrinsics intrinsics_;
  std::chrono::nanoseconds sensor_{0}, host_{0};
  std::int64_t seen_pixels_ = 0, looked_at_ = 0;  // of the last good frame
  int odd_in_a_row_ = 0;
};

}  // namespace armature
