#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/part_model.h>

#include "sdk/selection/level_tree.h"

namespace armature::sdk {

/// What lies near the boundary of a region above a level.
struct Ring {
  std::vector<VertexId> near = {};     ///< closer than the reach, by distance
  std::vector<VertexId> inside = {};   ///< the first beyond it within the region
  std::vector<VertexId> outside = {};  ///< the first beyond it outside
};

/// Cuts off regions along the best isoline of the harmonic field between two closed rings around a virtual stroke: the
/// isoline of a field that bounds them. All of the two rings is held fast, so that what lies beyond them does not
/// matter, and the field between them alone is the same as that of the whole surface. Holds an array for the surface:
/// made once a thread.
class RingCut {
 public:
  /// The model must outlive it.
  explicit RingCut(const PartModel& model);

  /// What lies within `reach` of the boundary of a node's region, along edges.
  [[nodiscard]] Ring ring_around(const LevelNode& node, double reach);
  /// The harmonic field at `ring.near`: 1 on its inner side, 0 on its outer one.
  [[nodiscard]] Eigen::VectorXd field(const Ring& ring) const;
  /// The faces within the best isoline between the rings, ascending; empty where there is none.
  [[nodiscard]] std::vector<FaceId> cut(const LevelNode& node, const Ring& ring);
  /// The faces at the ring's near vertices, ascending.
  [[nodiscard]] std::vector<FaceId> band(const Ring& ring) const;
  /// The faces within a region, of which `is_in` says whether those of the band, in its order, lie in it.
  [[nodiscard]] std::vector<FaceId> within(const LevelNode& node, const Ring& ring, std::span<const FaceId> band,
                                           const std::vector<bool>& is_in);

 private:
  void fill_region(const LevelNode& node);
  void forget(const Ring& ring);

  const PartModel* model_;
  std::vector<double> value_;     ///< by VertexId; 0 between calls
  std::vector<VertexId> region_;  ///< of the last node
};

}  // namespace armature::sdk
