#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "sdk/spheremesh/convex_union.h"

namespace armature::sdk {

/// Clefts between bodies: a mesh that keeps within a tolerance of their union may span narrow ones, yet far below it is
/// their bottom, the crease where two bodies meet.
class Cracks {
 public:
  Cracks(const ConvexUnion& bodies, double tolerance) : bodies_(bodies), tolerance_(tolerance) {}

  /// The cosine between the normals at two points of the surface if the way between them leads over a cleft; else 1.
  [[nodiscard]] double cosine(const Eigen::Vector3d& a, const Eigen::Vector3d& b);
  /// The cleft's bottom below that way, or where a third body fills it; none if the bodies do not meet close by.
  [[nodiscard]] std::optional<Eigen::Vector3d> bottom(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

 private:
  /// The body whose surface a point lies on; false if there is none.
  [[nodiscard]] bool find(const Eigen::Vector3d& point, ConvexUnion::BodyId& body);
  [[nodiscard]] double distance(const Eigen::Vector3d& point);

  const ConvexUnion& bodies_;
  double tolerance_;
  std::vector<ConvexUnion::BodyId> near_;
};

}  // namespace armature::sdk
