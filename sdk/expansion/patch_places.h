#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// A place where a patch like the reference may lie.
struct PatchPlace {
  VertexId centre;
  double scale;      ///< of the patch there, against the reference
  float similarity;  ///< of contexts
};

/// The local maxima of a similarity map that no better one is near, best first. `radius` is that of the patch there, in
/// the mesh's unit. Takes time in proportion to the mesh.
[[nodiscard]] std::vector<PatchPlace> maxima(const Surface& surface, std::span<const float> similarity, double radius,
                                             double scale);

/// Places by number, best first.
struct RankedPlaces {
  std::vector<std::size_t> first;   ///< those that differ in more than their size, and of the others the best two
  std::vector<std::size_t> others;  ///< the rest of these others
};
/// Ranks places of patches of several sizes. `radius` is that of the reference.
[[nodiscard]] RankedPlaces ranked(const Surface& surface, std::span<const PatchPlace> places, double radius);

}  // namespace armature::sdk
