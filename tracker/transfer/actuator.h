#pragma once

#include <chrono>

namespace armature {

/// What the two shaped motions may make of the camera (section 3.4.3). Ours, for a walk through a city.
struct ActuatorOptions {
  float max_walk_m_s = 1.5F;
  float max_turn_rad_s = 1.0F;
  float walk_acceleration_m_s2 = 3.0F;
  float turn_acceleration_rad_s2 = 4.0F;
};

/// Linear velocity forward and angular velocity to the left (counter-clockwise seen from above; ROS REP 103).
struct CameraVelocity {
  float linear_m_s = 0;
  float angular_rad_s = 0;
};

/// Shaped motions -> camera velocity. Speeding up is limited; slowing down and stopping are not, so that a person who
/// returns to rest stands at once. Realtime-safe: yes.
class Actuator {
 public:
  explicit Actuator(const ActuatorOptions& options) : options_(options) {}

  void set_options(const ActuatorOptions& options) noexcept { options_ = options; }

  /// `walk` and `turn` in [-1, 1]: forward and to the left are positive.
  const CameraVelocity& drive(float walk, float turn, std::chrono::nanoseconds dt) noexcept;

  /// Zero, at once.
  const CameraVelocity& stop() noexcept;

 private:
  ActuatorOptions options_;
  CameraVelocity velocity_;
};

}  // namespace armature
