#include <cmath>

#include <armature/navproto/nav_camera.h>

namespace armature::navproto {

void NavCamera::move(double distance_m) noexcept {
  pose_.x_m += distance_m * std::cos(pose_.heading_rad);
  pose_.y_m += distance_m * std::sin(pose_.heading_rad);
}

void NavCamera::rotate(double angle_rad) noexcept {
  pose_.heading_rad += angle_rad;
}

void NavCamera::advance(const Velocity& velocity, std::chrono::duration<double> time) noexcept {
  const double distance_m = velocity.linear_m_s * time.count();
  const double half_turn_rad = velocity.angular_rad_s * time.count() / 2;
  if (!(time.count() > 0) || !std::isfinite(distance_m) || !std::isfinite(half_turn_rad)) return;
  // The chord of an arc lies half the turn away from its tangent and is shorter than it by sin(h) / h.
  const double shortening = half_turn_rad == 0 ? 1 : std::sin(half_turn_rad) / half_turn_rad;
  rotate(half_turn_rad);
  move(distance_m * shortening);
  rotate(half_turn_rad);
}

}  // namespace armature::navproto
