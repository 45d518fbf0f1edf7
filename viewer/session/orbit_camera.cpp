#include "viewer/session/orbit_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace armature::viewer {

void OrbitCamera::orbit(double azimuth_rad, double elevation_rad) {
  view.azimuth_rad = std::remainder(view.azimuth_rad + azimuth_rad, 2 * std::numbers::pi);
  view.elevation_rad = std::clamp(view.elevation_rad + elevation_rad, -1.55, 1.55);
}

void OrbitCamera::pan(const ViewPoint& by) {
  const double scale = kHalfHeight * distance;
  target -= view_from_world().linear().transpose() * Eigen::Vector3d(scale * by.x(), scale * by.y(), 0);
}

void OrbitCamera::zoom(double factor) {
  distance = std::clamp(distance / factor, 1e-12, 1e12);
}

void OrbitCamera::fit(const sdk::Sphere& around, double aspect) {
  target = around.centre;
  const double tangent = kHalfHeight * std::min(1.0, aspect);
  distance = 1.02 * std::max(around.radius, 1e-9) / std::sin(std::atan(tangent));
}

Eigen::Isometry3d OrbitCamera::view_from_world() const {
  const Eigen::Matrix3d rotation = view_rotation(view);
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = rotation;
  result.translation() = -(rotation * target) - Eigen::Vector3d(0, 0, distance);
  return result;
}

Camera OrbitCamera::camera(const sdk::Sphere& around, double aspect) const {
  Camera camera;
  camera.view_from_world = view_from_world();
  camera.half_height = kHalfHeight;
  camera.half_width = kHalfHeight * aspect;
  const double depth = -(camera.view_from_world * around.centre).z();
  camera.far = std::max(depth + 1.01 * around.radius, 1e-3 * distance);
  camera.near = std::max(depth - 1.01 * around.radius, 1e-3 * camera.far);
  return camera;
}

sdk::Ray OrbitCamera::ray(const ViewPoint& at) const {
  const Eigen::Isometry3d view_from = view_from_world();
  const Eigen::Vector3d direction(kHalfHeight * at.x(), kHalfHeight * at.y(), -1);
  return {eye(), (view_from.linear().transpose() * direction).normalized()};
}

ViewPoint OrbitCamera::project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d p = view_from_world() * point;
  const double depth = std::max(-p.z(), 1e-9 * distance);
  return ViewPoint(p.x(), p.y()) / (kHalfHeight * depth);
}

Eigen::Vector3d OrbitCamera::eye() const {
  return view_from_world().inverse().translation();
}

}  // namespace armature::viewer
