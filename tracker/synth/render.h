#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "firmware_host/depth_frame.h"
#include "tracker/body/body_surface.h"
#include "tracker/synth/scene.h"

namespace armature {

/// What an ideal camera sees. Every array [height][width], row-major.
struct SurfaceImage {
  Intrinsics intrinsics;
  std::vector<float> depth_m;          ///< along z; kNothing where the ray meets nothing
  std::vector<std::uint8_t> part;      ///< PartLabel or kNoPart
  std::vector<std::uint8_t> owner;     ///< whose surface (bodies and what they carry): 1, 2, ...; 0 = the room's
  std::vector<std::uint8_t> material;  ///< Material

  static constexpr float kNothing = 1e6F;

  /// Empties the image at this resolution.
  void reset(const Intrinsics& image_intrinsics);
};

/// Adds surfaces (camera frame, metres), nearest first per pixel. Rays go through pixel centres; each primitive is
/// intersected analytically within its projection's rectangle. What is nearer than `kNearest` along z is not seen.
void render_edges(std::span<const SurfaceEdge> edges, std::uint8_t owner, SurfaceImage& image);
void render_room(const Room& room, const RigidTransform& camera_from_world, SurfaceImage& image);
void render_boxes(std::span<const Box> boxes, const RigidTransform& camera_from_world, SurfaceImage& image);
inline constexpr double kNearest = 0.1;

}  // namespace armature
