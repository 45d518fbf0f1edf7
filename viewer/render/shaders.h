#pragma once

#include <span>

namespace armature::viewer::shaders {

/// What one draw call needs of the card. Inputs of the vertex stage are numbered as in renderer.cpp.
struct Source {
  const char* name;
  const char* vertex;
  const char* fragment;
};

/// Triangles -> colour, normal and depth.
extern const Source kTriangles;
/// One point of four a sphere -> a quad that covers it exactly, in which the sphere is ray-cast.
extern const Source kBalls;
/// A strip of fourteen corners a cone -> a box around it, in which the cone is ray-cast.
extern const Source kCones;
/// Colour, normal and depth of a layer -> light.
extern const Source kLight;
/// Light, supersampled -> sRGB.
extern const Source kResolve;

}  // namespace armature::viewer::shaders
