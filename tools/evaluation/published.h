#pragma once

#include <array>
#include <string_view>

namespace armature::tools {

/// Distances between an input and its approximation, in percent of the input's bounding box's diagonal.
struct PublishedError {
  double hausdorff;
  double input_to_approximation;  ///< mean, M12
  double approximation_to_input;  ///< mean, M21
};

/// A row of Table 4.1 whose model can be had: a file with the same numbers of vertices and triangles.
struct PublishedRow {
  std::string_view model;
  std::string_view file;
  int spheres, edges, triangles;
  PublishedError sphere_mesh;
  PublishedError qem;
};

inline constexpr std::array<PublishedRow, 4> kTable41 = {{
    {"Elephant", "elephant_24955.off", 45, 6, 68, {3.357, 0.564, 0.620}, {6.371, 1.038, 0.684}},
    {"Camel", "camel_mc_2020.off", 50, 19, 34, {7.201, 0.465, 0.384}, {12.477, 1.071, 0.576}},
    {"Centaur", "nr3d_centaur0.off", 50, 17, 42, {3.557, 0.373, 0.401}, {15.626, 1.629, 0.523}},
    {"Gorilla", "nr3d_gorilla18_main.off", 36, 5, 37, {6.109, 0.530, 0.446}, {9.353, 1.610, 1.122}},
}};

/// Six models on which fitted sphere-meshes are compared, by the geometric mean.
inline constexpr std::array<std::string_view, 6> kFittedModels = {
    "elephant_24955.off", "igl_armadillo.obj", "vh_Hand1.off", "vm_neptune.off", "vm_bear.off", "vh_octopus.off"};

/// What peers reach on six models like those, geometric means.
struct PublishedFit {
  std::string_view peer;
  int spheres;
  PublishedError mean;
};
inline constexpr std::array<PublishedFit, 3> kPublishedFits = {{
    {"VMAS", 50, {3.40, 0.48, 0.40}},
    {"Q-MAT", 50, {3.58, 0.43, 0.34}},
    {"VMAS", 100, {2.28, 0.28, 0.24}},
}};

}  // namespace armature::tools
