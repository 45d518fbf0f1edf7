#pragma once

#include <span>
#include <vector>

#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::tools {

/// The mesh in pale grey, its reference red, its matches blue: the more alike, the more saturated (thesis,
/// figure 5.10). Where matches overlap, the better one shows.
[[nodiscard]] sdk::Mesh painted(const sdk::Mesh& mesh, std::span<const sdk::FaceId> reference,
                                std::span<const sdk::Match> matches);

}  // namespace armature::tools
