#pragma once

#include <array>
#include <chrono>

#include "tracker/motions/motion_options.h"
#include "tracker/motions/one_euro.h"
#include "tracker/motions/receptors.h"

namespace armature {

/// What the motion receptors put out (section 3.4.1).
struct MotionReading {
  float angle_rad = 0;    ///< signed, filtered
  float normalized = 0;   ///< angle over range, in [-1, 1]
  float confidence = 0;   ///< in [0, 1]
  bool measured = false;  ///< false: the joints were not good enough for longer than the hold time
};

/// Skeleton against rest pose -> filtered, normalised motions. Realtime-safe: yes. Thread-safe: no.
class MotionMeter {
 public:
  explicit MotionMeter(const MotionOptions& options) : options_(options) {}

  void set_options(const MotionOptions& options) noexcept { options_ = options; }
  [[nodiscard]] const MotionOptions& options() const noexcept { return options_; }

  /// Forgets the past: the next reading is unfiltered.
  void reset() noexcept;

  /// `dt` is the time since the last call (or reset), positive.
  const PerMotion<MotionReading>& measure(const Skeleton& skeleton, const RestPose& rest,
                                          std::chrono::nanoseconds dt) noexcept;

 private:
  MotionOptions options_;
  PerMotion<OneEuro> filters_;
  PerMotion<std::chrono::nanoseconds> held_{};
  PerMotion<MotionReading> readings_{};
};

}  // namespace armature
