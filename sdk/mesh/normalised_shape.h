#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>

namespace armature::sdk {

/// Which way a shape is turned.
enum class ShapeFrame : std::uint8_t {
  Model,  ///< as it comes
  Own,    ///< to the principal axes of its surface, so that nothing depends on how it came; as it comes where two of
          ///< its spreads are so alike that noise would decide
};

/// A mesh, or points and what joins them, turned, moved and scaled to a bounding box about the origin with a diagonal
/// of 1 (if it has none: to an area of 1, or unscaled), its triangles and normals turned outward.
struct NormalisedShape {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Eigen::Vector3d> normals;                ///< of points, by position; empty where it is a mesh
  std::vector<double> areas;                           ///< likewise, in units of this shape
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< the bounding box's middle, in the model's coordinates
  double scale = 1;                                    ///< the diagonal, or the root of the area
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< shape_from_model, a rotation

  /// The places of a triangle's corners.
  [[nodiscard]] std::array<Eigen::Vector3d, 3> corners(std::size_t triangle) const {
    const auto& [a, b, c] = triangles[triangle];
    return {positions[a], positions[b], positions[c]};
  }

  /// A point of the model where the shape has it.
  [[nodiscard]] Eigen::Vector3d from_model(const Eigen::Vector3d& point) const {
    return turn * ((point - origin) / scale);
  }

  /// A component (linked by vertices) of negative volume is turned over together with all that lies within it, unless
  /// it lies within another: what does keeps its relation to what is around it, so that cavities stay cavities.
  /// `points`, unless null, are what `mesh` joins (`surface_of()`).
  [[nodiscard]] static NormalisedShape of(const Mesh& mesh, ShapeFrame frame = ShapeFrame::Model,
                                          const PointSet* points = nullptr);
};

}  // namespace armature::sdk
