#include "tracker/transfer/actuator.h"

#include <algorithm>
#include <cmath>

namespace armature {
namespace {

float approached(float now, float wanted, float step) {
  if (now * wanted < 0) now = 0;  // turning round passes through a stop
  if (std::abs(wanted) <= std::abs(now)) return wanted;
  return wanted > 0 ? std::min(wanted, now + step) : std::max(wanted, now - step);
}

}  // namespace

const CameraVelocity& Actuator::drive(float walk, float turn, std::chrono::nanoseconds dt) noexcept {
  const float dt_s = std::chrono::duration<float>(dt).count();
  velocity_.linear_m_s =
      approached(velocity_.linear_m_s, walk * options_.max_walk_m_s, options_.walk_acceleration_m_s2 * dt_s);
  velocity_.angular_rad_s =
      approached(velocity_.angular_rad_s, turn * options_.max_turn_rad_s, options_.turn_acceleration_rad_s2 * dt_s);
  return velocity_;
}

const CameraVelocity& Actuator::stop() noexcept {
  velocity_ = {};
  return velocity_;
}

}  // namespace armature
