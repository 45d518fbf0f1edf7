#include "viewer/scene/camera.h"

#include <algorithm>
#include <cmath>

namespace armature::viewer {
namespace {

/// Half the angle that the picture's longer side spans: that of a long lens, so that little is distorted.
constexpr double kHalfAngleRad = 0.21;
/// How much of the picture's width and height the shapes fill.
constexpr double kFilled = 0.93;

/// Turns the model so that y is up and z towards a viewer at the front.
Eigen::Matrix3d upright(Up up) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  switch (up) {
    case Up::X: rotation << 0, 1, 0, 1, 0, 0, 0, 0, -1; break;
    case Up::Y: break;
    case Up::Z: rotation << 1, 0, 0, 0, 0, 1, 0, -1, 0; break;
    case Up::MinusX: rotation << 0, -1, 0, -1, 0, 0, 0, 0, -1; break;
    case Up::MinusY: rotation << 1, 0, 0, 0, -1, 0, 0, 0, -1; break;
    case Up::MinusZ: rotation << 1, 0, 0, 0, 0, -1, 0, 1, 0; break;
  }
  return rotation;
}

}  // namespace

Eigen::Matrix3d view_rotation(const View& view) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(view.elevation_rad, Vector3d::UnitX()) * AngleAxisd(-view.azimuth_rad, Vector3d::UnitY()))
             .toRotationMatrix() *
         upright(view.up);
}

CameraFit::CameraFit(const View& view, double aspect)
    : half_width_(std::tan(kHalfAngleRad) * std::min(1.0, aspect)),
      half_height_(std::tan(kHalfAngleRad) * std::min(1.0, 1 / aspect)) {
  view_from_world_ = view_rotation(view);
}

void CameraFit::include(const sdk::Sphere& sphere) {
  const Eigen::Vector3d at = view_from_world_ * sphere.centre;
  // A little narrower than the view, which leaves a margin.
  const double tx = kFilled * half_width_;
  const double ty = kFilled * half_height_;
  const double rx = sphere.radius * std::hypot(1, tx);
  const double ry = sphere.radius * std::hypot(1, ty);
  right_ = std::max(right_, at.x() + tx * at.z() + rx);
  left_ = std::max(left_, -at.x() + tx * at.z() + rx);
  top_ = std::max(top_, at.y() + ty * at.z() + ry);
  bottom_ = std::max(bottom_, -at.y() + ty * at.z() + ry);
  front_ = std::max(front_, at.z() + sphere.radius);
  back_ = std::max(back_, sphere.radius - at.z());
}

void CameraFit::include(const sdk::Mesh& mesh) {
  for (const sdk::Triangle& triangle : mesh.triangles)
    for (const sdk::VertexId corner : triangle) include(sdk::Sphere{mesh.position(corner), 0});
}

void CameraFit::include(const sdk::SphereMesh& shape) {
  for (const sdk::Sphere& sphere : shape.spheres) include(sphere);
}

Camera CameraFit::camera() const {
  if (front_ == kNothing) {
    CameraFit unit = *this;
    unit.include(sdk::Sphere{Eigen::Vector3d::Zero(), 1});
    return unit.camera();
  }
  const double depth = front_ + back_;
  // Each pair of opposite planes meets in a line; the eye stands on the line that is farther out.
  Eigen::Vector3d eye((right_ - left_) / 2, (top_ - bottom_) / 2, 0);
  eye.z() = std::max((right_ + left_) / (2 * kFilled * half_width_), (top_ + bottom_) / (2 * kFilled * half_height_));
  double to_front = eye.z() - front_;
  if (!(to_front + depth > 0)) {  // a single point
    to_front = std::max(1.0, 1e-3 * std::abs(front_));
    eye.z() = front_ + to_front;
  }
  Camera camera;
  camera.view_from_world.linear() = view_from_world_;
  camera.view_from_world.translation() = -eye;
  camera.half_width = half_width_;
  camera.half_height = half_height_;
  const double slack = 0.01 * (to_front + depth);
  camera.near = std::max(to_front - slack, slack);
  camera.far = to_front + depth + slack;
  return camera;
}

}  // namespace armature::viewer
