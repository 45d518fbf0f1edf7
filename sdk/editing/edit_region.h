#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// A region of a surface as a mesh of its own, with its place against a reference.
struct EditRegion {
  Mesh mesh;                        ///< its faces alone
  std::vector<VertexId> vertex_of;  ///< of the surface, by vertex of `mesh`
  std::vector<double> inside;       ///< by vertex of `mesh`: how much of an edit it takes, 0 at the boundary
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();  ///< reference_from_region
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  double scale = 1;  ///< how many times as large as here lengths are on the reference

  [[nodiscard]] Eigen::Vector3d to_reference(const Eigen::Vector3d& p) const { return linear * p + offset; }
  /// A place of the reference here.
  [[nodiscard]] Eigen::Vector3d from_reference(const Eigen::Vector3d& p) const {
    return linear.inverse() * (p - offset);
  }
  [[nodiscard]] Eigen::Vector3d direction_from_reference(const Eigen::Vector3d& d) const {
    return linear.inverse() * d;
  }
  /// Laid onto the reference.
  [[nodiscard]] Mesh laid_on() const;
};

/// Cuts a region out of a surface. `name` stands for it in messages.
[[nodiscard]] Expected<EditRegion> edit_region(const Surface& surface, std::span<const FaceId> faces,
                                               const Eigen::Matrix4d& reference_from_region, double blend,
                                               const std::string& name);

}  // namespace armature::sdk
