#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/selection/surface.h>

#include "sdk/selection/flood.h"

namespace armature::sdk {

/// Which faces of a surface lie beside which, and where: what floods over tens of thousands of faces ask for, close
/// together in memory. Immutable.
class FaceGraph {
 public:
  /// The surface must outlive it.
  explicit FaceGraph(const Surface& surface);

  [[nodiscard]] const Surface& surface() const noexcept { return *surface_; }
  /// The middle of its corners.
  [[nodiscard]] const Eigen::Vector3d& middle(FaceId face) const noexcept { return nodes_[face.index()].middle; }
  /// The faces that share an edge with it, edge by edge.
  [[nodiscard]] std::span<const FaceId> beside(FaceId face) const noexcept {
    const std::uint32_t first = nodes_[face.index()].first;
    return std::span(beside_).subspan(first, nodes_[face.index() + 1].first - first);
  }
  /// Where the surface comes nearest to a point, of what lies downhill from a face: from face to face as long as that
  /// leads nearer. The closest point of all where the start is near enough, in a small part of the time.
  [[nodiscard]] SurfacePoint closest_from(FaceId start, const Eigen::Vector3d& point) const noexcept;
  /// Whether its middle or a corner of it lies within a ball.
  [[nodiscard]] bool touches(FaceId face, const Eigen::Vector3d& centre, double radius) const noexcept;
  /// What hangs together with some faces and is wanted; see `flood_over()`.
  template <class Wanted>
  [[nodiscard]] std::vector<FaceId> flood(std::span<const FaceId> seeds, const Wanted& wanted) const {
    const auto reach_all = [&](FaceId face, const auto& reach) {
      for (const FaceId next : beside(face)) reach(next);
    };
    return flood_over(reach_all, seeds, nodes_.size(), wanted);
  }

 private:
  struct Node {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    float spread = 0;         // no corner is farther from the middle
    std::uint32_t first = 0;  // of beside_
  };
  const Surface* surface_;
  std::vector<Node> nodes_;  // by face, and one behind
  std::vector<FaceId> beside_;
};

}  // namespace armature::sdk
