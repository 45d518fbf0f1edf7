#pragma once

#include <memory>
#include <string_view>

#include "firmware_host/depth_source.h"

namespace armature {

/// `openni2:` (any) or `openni2:URI`: a PrimeSense, Xtion or whatever has an OpenNI2 driver, 640 x 480 at 30 Hz where
/// it can, in millimetres; intrinsics by its field of view; the sensor's own microseconds.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_openni2_device(std::string_view uri,
                                                                         const OpenOptions& options);

}  // namespace armature
