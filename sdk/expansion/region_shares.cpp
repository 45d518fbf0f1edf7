#include "sdk/expansion/region_shares.h"

#include <armature/sdk/mesh/measures.h>

namespace armature::sdk {

RegionShares::RegionShares(const Surface& surface, std::span<const FaceId> faces)
    : surface_(&surface), share_(surface.mesh.positions.size()) {
  for (const FaceId face : faces)
    for (const VertexId corner : surface.mesh.triangle(face))
      if (const double cell = surface.vertex_areas[corner.index()]; cell > 0)
        share_[corner.index()] += area_vector(surface.mesh, face).norm() / (3 * cell);
}

double RegionShares::at(const SurfacePoint& point) const noexcept {
  double share = 0;
  for (std::size_t k = 0; k < 3; ++k)
    share += point.barycentric[static_cast<Eigen::Index>(k)] * share_[surface_->mesh.triangle(point.face)[k].index()];
  return share;
}

}  // namespace armature::sdk
