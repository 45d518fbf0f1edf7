#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/mesh/normalised_shape.h"

namespace armature::sdk {

/// Links every vertex on no triangle to a vertex near it that is on one (by label, if there are any), so that what is
/// no part of the surface is gone first.
[[nodiscard]] std::vector<CollapseComplex::Pair> links_of_loose_vertices(const NormalisedShape& shape,
                                                                         std::span<const std::uint32_t> labels);

/// Links vertices nearer than `reach` that face away from each other through the solid (thesis, section 4.6.5): each
/// lies behind the other's tangent plane, and their normals oppose. Of the vertices in a cell of a third of that size
/// which face the same octant one stands for all; it is linked to the nearest few. Links may repeat edges.
[[nodiscard]] std::vector<CollapseComplex::Pair> links_through_the_solid(const NormalisedShape& shape, double reach);

/// Links regions that nothing joins, to go on with when no edge is left: all pairs, or neighbours along a curve that
/// fills space where those would be too many. `centres` are those of `slots`.
[[nodiscard]] std::vector<CollapseComplex::Pair> links_between_components(std::span<const std::uint32_t> slots,
                                                                          std::span<const Eigen::Vector3d> centres);

}  // namespace armature::sdk
