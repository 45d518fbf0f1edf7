#pragma once

#include <array>
#include <span>

#include <armature/sdk/expansion/patch_map.h>

namespace armature::sdk {

/// The bins of a patch context. [PatchContexts::kDistances][PatchContexts::kAngles]
using PatchContext = std::array<float, PatchContexts::kDistances * PatchContexts::kAngles>;

/// What contexts are compared by: every bin's share spread over it and its neighbours by 1/4, 1/2, 1/4, in either
/// direction, since noise carries points over the edges of bins; nothing leaves. As many bins go in.
[[nodiscard]] PatchContext spread(std::span<const float> context) noexcept;

}  // namespace armature::sdk
