#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::sdk {

/// Where the region of a sphere has gone, as nearly as a similarity can take it.
struct RegionFrame {
  Eigen::Vector3d before = Eigen::Vector3d::Zero();    ///< the mean of its vertices before any deformation
  Eigen::Vector3d now = Eigen::Vector3d::Zero();       ///< their mean now
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< a rotation
  double scale = 1;                                    ///< how much larger the region has become
  /// Where a point that goes with the region is now.
  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& x) const {
    return now + scale * (turn * (x - before));
  }
};

/// A sphere and its region.
struct FittedSphere {
  Sphere sphere = {};      ///< in the model's coordinates
  RegionFrame frame = {};  ///< of the vertices that it stands for
};

/// Fits the spheres of a hierarchy to the mesh as it has been deformed (thesis, section 4.7.3): sums of quadrics over
/// the vertices that each sphere stands for, minimised as when the hierarchy was built with its default options; no
/// radius is bounded below what the region's own motion would make of it. A sphere of whose vertices none has moved is
/// as the hierarchy has it, whatever it was built with; what holds a sphere that the user pinned when it was built, or
/// has no area, goes along with its vertices. Thread-safe to read.
class Refit {
 public:
  /// The hierarchy must be of the mesh, and outlive this.
  Refit(const Mesh& mesh, const Hierarchy& hierarchy);

  /// The spheres of a cut, nodes of which none lies above another in the order of their ranges, which stand for all
  /// vertices, such as a level's. `positions`, [V], are those of now. `wanted`, [cut] or empty for all: spheres that
  /// are not wanted are left empty and cost nothing.
  [[nodiscard]] std::vector<FittedSphere> fit(std::span<const NodeId> cut, std::span<const Eigen::Vector3d> positions,
                                              const std::vector<bool>& wanted = {}) const;
  /// Where the vertices that a node stands for have gone.
  [[nodiscard]] RegionFrame frame(NodeId node, std::span<const Eigen::Vector3d> positions) const;

 private:
  struct Region;
  [[nodiscard]] Region measure(NodeId node, const std::vector<Eigen::Vector3d>& now) const;
  void add_triangles(std::span<const NodeId> cut, const std::vector<Eigen::Vector3d>& now,
                     std::vector<Region>& regions) const;
  [[nodiscard]] Sphere best_sphere(NodeId node, const Region& region, const std::vector<Eigen::Vector3d>& now) const;
  [[nodiscard]] double smallest_extent(NodeId node, const Region& region,
                                       const std::vector<Eigen::Vector3d>& now) const;
  [[nodiscard]] bool holds_pinned(NodeId node) const;

  [[nodiscard]] std::uint32_t subtree_size(NodeId node) const;

  // Places are those of the vertices in the order of the hierarchy's leaves, where every region is one piece. Nodes are
  // ordered parents first, subtree by subtree; a triangle belongs to the lowest node that holds all its corners, so
  // that the triangles within a region are one piece as well.
  const Hierarchy* hierarchy_;
  Eigen::Matrix3d shape_from_model_;                     // a rotation, to the frame that extents are measured in
  std::vector<Eigen::Vector3d> rest_;                    // by place
  std::vector<std::uint32_t> order_;                     // by node
  std::vector<std::array<std::uint32_t, 3>> triangles_;  // places
  std::vector<std::uint32_t> triangles_from_;            // by place in the order of nodes, and those of none
  std::vector<std::uint32_t> pinned_;                    // places, ascending
};

}  // namespace armature::sdk
