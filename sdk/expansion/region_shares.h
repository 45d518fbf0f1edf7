#pragma once

#include <span>
#include <vector>

#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// By vertex, which share of the area around it belongs to some faces: a region whose border does not follow the
/// staircase of triangles so closely.
class RegionShares {
 public:
  /// The surface must outlive it.
  RegionShares(const Surface& surface, std::span<const FaceId> faces);

  /// Between the vertices; more than a half is inside. The point must be on a face.
  [[nodiscard]] double at(const SurfacePoint& point) const noexcept;

 private:
  const Surface* surface_;
  std::vector<double> share_;
};

}  // namespace armature::sdk
