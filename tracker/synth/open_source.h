#pragma once

#include <memory>
#include <string_view>

#include "firmware_host/depth_source.h"

namespace armature {

/// Opens any source by its URI: `synth:NAME[?option=value&...]`, a synthetic person (synth_source.h), or what
/// firmware_host knows (open_depth_source). This is what programs call.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_source(std::string_view uri, const OpenOptions& options = {});

}  // namespace armature
