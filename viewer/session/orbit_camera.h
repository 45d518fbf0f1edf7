#pragma once

#include <Eigen/Core>
#include <armature/sdk/spheremesh/primitives.h>

#include "viewer/scene/camera.h"

namespace armature::viewer {

/// A place in the view: (0, 0) is its centre, y = 1 its upper edge and -1 its lower one, and x has the same unit. So it
/// means the same in a window of any size and shape.
using ViewPoint = Eigen::Vector2d;

/// A camera that turns about a target, the model's up direction upright.
struct OrbitCamera {
  static constexpr double kHalfHeight = 0.3;  ///< of the view, at depth 1

  View view{.azimuth_rad = 0.6, .elevation_rad = 0.25};  ///< from where it looks
  Eigen::Vector3d target = Eigen::Vector3d::Zero();      ///< in the middle of the view
  double distance = 3;                                   ///< from there

  /// Turns the model under the mouse, angles in radians; stays short of the poles.
  void orbit(double azimuth_rad, double elevation_rad);
  /// Moves what is seen at the target by so much of the view.
  void pan(const ViewPoint& by);
  /// Comes nearer by a factor above 1, within sensible bounds.
  void zoom(double factor);
  /// Sees all of a sphere in a view of that shape (width over height).
  void fit(const sdk::Sphere& around, double aspect);

  /// For a view of that shape; all of `around` lies between its planes.
  [[nodiscard]] Camera camera(const sdk::Sphere& around, double aspect) const;
  /// What is seen at a place of the view, from the eye on.
  [[nodiscard]] sdk::Ray ray(const ViewPoint& at) const;
  /// Where in the view a point is seen; what lies behind the eye comes out far outside.
  [[nodiscard]] ViewPoint project(const Eigen::Vector3d& point) const;
  /// From where it looks.
  [[nodiscard]] Eigen::Vector3d eye() const;
  /// Model to view frame: x right, y up, looking along -z.
  [[nodiscard]] Eigen::Isometry3d view_from_world() const;
};

}  // namespace armature::viewer
