#pragma once

#include <cstdint>
#include <span>

#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// The part of a mesh's area that lies in staves: regions three times as long as wide, straight along, and facing one
/// side, as a cooper cuts a barrel. `regions` names the region of every vertex, by any numbers below that of vertices;
/// a triangle counts by thirds for those of its corners.
[[nodiscard]] double share_of_staves(const Mesh& mesh, std::span<const std::uint32_t> regions);

}  // namespace armature::sdk
