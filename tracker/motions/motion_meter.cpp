#include "tracker/motions/motion_meter.h"

#include <algorithm>

namespace armature {

void MotionMeter::reset() noexcept {
  for (OneEuro& filter : filters_) filter.reset();
  held_ = {};
  readings_ = {};
}

const PerMotion<MotionReading>& MotionMeter::measure(const Skeleton& skeleton, const RestPose& rest,
                                                     std::chrono::nanoseconds dt) noexcept {
  const MotionAngles now = motion_angles(skeleton, rest);
  PerMotion<float> angle{};
  for (std::size_t m = 0; m < kMotionCount; ++m) angle[m] = options_.curve(m).true_angle(now.angle_rad[m]);
  float& hips = angle[index(MotionId::RotateHips)];
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    // What cannot be seen for a moment is held; what it draws along is, too.
    const bool seen = now.confidence[m] >= options_.min_confidence;
    hips -= options_.read_as_hips[m] * (seen ? angle[m] : readings_[m].angle_rad);
  }
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    MotionReading& reading = readings_[m];
    reading.confidence = now.confidence[m];
    if (now.confidence[m] < options_.min_confidence) {
      held_[m] += dt;
      if (held_[m] > options_.hold_time) {
        filters_[m].reset();
        reading = MotionReading{.confidence = now.confidence[m]};
      }
      continue;
    }
    const auto since_measured = held_[m] + dt;
    held_[m] = {};
    reading.angle_rad =
        filters_[m].filter(angle[m], std::chrono::duration<float>(since_measured).count(), options_.filter);
    reading.normalized = std::clamp(reading.angle_rad / options_.range_rad[m], -1.0F, 1.0F);
    reading.measured = true;
  }
  return readings_;
}

}  // namespace armature
