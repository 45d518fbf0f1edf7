#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "firmware_host/depth_frame.h"
#include "tracker/body/skeleton.h"

namespace armature::tools {

/// A piece of a trunk that is looked at: a strip as wide as all trunks are, between two points of the spine.
struct TrunkStrip {
  Eigen::Vector3f top, bottom;  ///< metres, camera frame
};

/// Across the shoulders, and across the hips, of a skeleton whose shoulders and hips have positions.
[[nodiscard]] TrunkStrip shoulder_strip(const Skeleton& skeleton) noexcept;
[[nodiscard]] TrunkStrip hip_strip(const Skeleton& skeleton) noexcept;

/// How far what is seen of a strip is turned to the left about the vertical of the camera, radians: of the plane that
/// most of its pixels lie near. A witness of turns that knows no joints. It says less than the whole turn, by a share
/// that belongs to the build of the body. Nothing where fewer than 30 pixels are seen, or all of them in one line.
[[nodiscard]] std::optional<double> surface_turn(const DepthView& frame, std::span<const std::uint8_t> mask,
                                                 const TrunkStrip& strip);

}  // namespace armature::tools
