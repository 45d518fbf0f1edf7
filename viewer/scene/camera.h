#pragma once

#include <cstdint>
#include <limits>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::viewer {

/// Which direction of a model is up.
enum class Up : std::uint8_t { X, Y, Z, MinusX, MinusY, MinusZ };

/// From where a shape is seen. With y up the front is seen from +z, with x to the right; with z up from -y.
struct View {
  double azimuth_rad = 0;    ///< about the up direction; 0 = front, a quarter turn = from the picture's right, +x
  double elevation_rad = 0;  ///< above the horizon
  Up up = Up::Y;
};

/// Turns the world into the frame of a view: x right, y up, z towards the viewer.
[[nodiscard]] Eigen::Matrix3d view_rotation(const View& view);

/// A perspective camera without an aspect of its own: it looks along -z of its view frame (x right, y up), where the
/// picture's edges lie at +-half_width and +-half_height times the depth.
struct Camera {
  Eigen::Isometry3d view_from_world = Eigen::Isometry3d::Identity();
  double half_width = 0.2;
  double half_height = 0.2;
  double near = 0.1;  ///< depths between which everything lies
  double far = 10;
};

/// Finds the camera that sees all it was told of as large as it fits into a picture, exactly: by the extreme planes
/// parallel to the four sides of the view.
class CameraFit {
 public:
  /// `aspect`: the picture's width over its height.
  CameraFit(const View& view, double aspect);

  void include(const sdk::Sphere& sphere);
  void include(const sdk::Mesh& mesh);
  void include(const sdk::SphereMesh& shape);

  /// The camera for what was included; for nothing at all, one that looks at the origin.
  [[nodiscard]] Camera camera() const;

 private:
  static constexpr double kNothing = -std::numeric_limits<double>::infinity();

  Eigen::Matrix3d view_from_world_;  // the rotation alone
  double half_width_, half_height_;  // at depth 1
  // Extremes of x + z half_width, and so on, over all spheres: beyond them there is nothing.
  double right_ = kNothing, left_ = kNothing, top_ = kNothing, bottom_ = kNothing, front_ = kNothing, back_ = kNothing;
};

}  // namespace armature::viewer
