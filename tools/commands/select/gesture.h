#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/lasso.h>
#include <armature/sdk/selection/patch_brush.h>

#include "firmware_host/error.h"

namespace armature::tools {

/// A click on a connected component: {"tool":"component","face":F}.
struct ComponentGesture {
  sdk::FaceId face;
};

/// Strokes of a brush: {"tool":"patch","strokes":[[[x,y,z],...],...],"radius":R,"background":[[[x,y,z],...],...]}; the
/// background may be left out, or be one stroke.
struct PatchGesture {
  sdk::PatchStrokes drawn;
};

/// Strokes along one cut: {"tool":"part","stroke":[[x,y,z],...]}, or a list of such strokes.
struct PartGesture {
  std::vector<std::vector<Eigen::Vector3d>> strokes;
};

/// A loop in a picture: {"tool":"lasso","loop":[[x,y,z],...],"eye":[x,y,z],"through":true,"snap":W}; a parallel
/// picture has a "direction" instead of the eye, and the last two keys may be left out.
struct LassoGesture {
  sdk::Lasso drawn;
  double snap = 0;  ///< how far the boundary may move to where the surface is better cut, in the mesh's unit
};

/// What a user does to select a region.
using Gesture = std::variant<ComponentGesture, PartGesture, PatchGesture, LassoGesture>;

/// Reads a gesture from JSON, for a mesh of so many faces, 0 for points. Refused in one line with the place: what is
/// not JSON, keys that are unknown, missing or there twice, numbers that are not finite, faces that are not there.
/// `name` stands for the file in messages.
[[nodiscard]] Expected<Gesture> parse_gesture(std::string_view bytes, std::string_view name, std::size_t faces);

/// The same of a file.
[[nodiscard]] Expected<Gesture> read_gesture(const std::string& file, std::size_t faces);

}  // namespace armature::tools
