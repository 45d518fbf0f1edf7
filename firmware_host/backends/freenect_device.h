#pragma once

#include <cmath>
#include <memory>
#include <string_view>

#include "firmware_host/depth_source.h"

namespace armature {

/// `freenect:N`: the N-th Kinect v1 (or Kinect for Windows), from 0, in the order of bus and port; `freenect:1-2.1`:
/// the one on that port, whichever others are plugged in. Through libfreenect: 640 x 480 at 30 Hz, millimetres and
/// focal length by the device's own calibration, the sensor's own 60 MHz clock. libfreenect may crash or hang on
/// unplug: use it in a process of its own (open_depth_source() does).
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_freenect_device(std::string_view which,
                                                                          const OpenOptions& options);

/// A 32-bit counter that wraps, as a time that does not.
class UnwrappedTicks {
 public:
  explicit UnwrappedTicks(double ticks_per_second) : ticks_per_second_(ticks_per_second) {}
  /// Steps back, and steps forward by more than half of the range, are taken for a restarted counter: time goes on by
  /// one tick.
  std::chrono::nanoseconds operator()(std::uint32_t ticks) noexcept {
    const std::uint32_t step = began_ ? ticks - last_ : 0;
    total_ += step < 0x8000'0000U ? step : 1;
    began_ = true;
    last_ = ticks;
    return std::chrono::nanoseconds(std::llround(static_cast<double>(total_) * (1e9 / ticks_per_second_)));
  }

 private:
  double ticks_per_second_;
  std::uint64_t total_ = 0;
  std::uint32_t last_ = 0;
  bool began_ = false;
};

}  // namespace armature
