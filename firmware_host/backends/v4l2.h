#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "firmware_host/depth_source.h"

namespace armature {

/// `v4l2:/dev/videoN[?focal_px=F]`: a depth camera with a kernel driver: Z16 (RealSense and other UVC depth
/// cameras, in the unit of their model; millimetres of one that is not known) or Y10B (the Kinect v1's kernel driver:
/// packed 10-bit disparities). Memory-mapped buffers; the buffers' own time stamps. V4L2 does not tell the intrinsics:
/// they are the nominal ones of the model by its name, or of `focal_px`; a model that is not known needs it.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_v4l2(std::string_view path_and_options,
                                                               const OpenOptions& options);

/// Unpacks Y10B: ten bits a pixel, the most significant first, without gaps. `packed` holds at least 10 bits for each
/// pixel of `disparity`.
void unpack_y10b(std::span<const std::uint8_t> packed, std::span<std::uint16_t> disparity) noexcept;

}  // namespace armature
