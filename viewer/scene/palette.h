#pragma once

#include <armature/sdk/mesh/mesh.h>

namespace armature::viewer {

/// The colours of pictures, sRGB. Spheres, edges and triangles differ in hue and in lightness, so that they can be told
/// apart in grey and by colour-blind eyes.
struct Palette {
  sdk::Colour mesh = {206, 201, 192};
  sdk::Colour sphere = {199, 84, 70};
  sdk::Colour edge = {229, 184, 92};
  sdk::Colour triangle = {118, 151, 190};
  sdk::Colour line = {38, 44, 54};      ///< wire edges of meshes
  sdk::Colour inside = {122, 84, 110};  ///< back faces: seen through a hole, or where a mesh is inside out
  sdk::Colour background_top = {252, 252, 252};
  sdk::Colour background_bottom = {225, 229, 234};
};

}  // namespace armature::viewer
