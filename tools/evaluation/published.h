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

/// A row of Table 5.2, in milliseconds, and a model of about the same size that can be had. `r` is the patch's radius
/// over the diagonal; where the thesis prints 0.02 and 36.7 s, it is almost surely 0.2.
struct PublishedPatchRow {
  std::string_view model;
  double thousand_vertices;
  double select_ms, r, map_ms, training_ms, match_ms;
  std::string_view file;
};
inline constexpr std::array<PublishedPatchRow, 8> kTable52 = {{
    {"SeaMonster", 57, 8, 0.07, 3776, 718, 4, "qmvc_SpikyBox.obj"},
    {"Armchair", 102, 27, 0.16, 14304, 3829, 142, "sd_dragon_vrip_res2.ply"},
    {"Julius", 43, 11, 0.2, 11623, 6470, 24, "igl_armadillo.obj"},
    {"Old Man", 84, 18, 0.06, 8119, 1712, 18, "sd_dragon_vrip_res2.ply"},
    {"Old Man", 84, 18, 0.05, 7165, 1731, 13, "sd_dragon_vrip_res2.ply"},
    {"Old Man", 84, 18, 0.2, 36689, 5768, 131, "sd_dragon_vrip_res2.ply"},
    {"Dragon", 100, 25, 0.06, 10591, 1175, 10, "sd_dragon_vrip_res2.ply"},
    {"Goro", 82, 7, 0.02, 5685, 1471, 56, "sd_dragon_vrip_res2.ply"},
}};

/// A row of Table 5.1, in milliseconds, a model of about the same size that can be had, and what is cut off from it:
/// about where its tip is, in the model's frame and unit, and how far below that the stroke lies, of the diagonal.
struct PublishedPartRow {
  std::string_view model;
  double thousand_vertices;
  double precompute_ms, step_ms;
  int strokes;
  double expand_ms;
  std::string_view file;
  std::array<double, 3> tip;
  double below;
};
inline constexpr std::array<PublishedPartRow, 6> kTable51 = {{
    {"Octopus", 12, 374, 16, 6, 97, "vh_octopus.off", {0.076, 0.153, 0.366}, 0.2},
    {"SeaMonster", 57, 1793, 83, 35, 2385, "qmvc_SpikyBox.obj", {0.235, 9.992, 0.565}, 0.03},
    {"Goro", 82, 2822, 95, 12, 1158, "sd_dragon_vrip_res2.ply", {0.038, 0.161, -0.019}, 0.04},
    {"Dragon", 100, 3588, 162, 47, 6900, "sd_dragon_vrip_res2.ply", {0.038, 0.161, -0.019}, 0.04},
    {"Chair", 14, 360, 102, 4, 56, "ml_office_chair.obj", {-18.28, -34.4, 14.1}, 0.05},
    {"Hand", 55, 2870, 102, 8, 1056, "cg_handman.off", {-0.945, -0.089, -0.23}, 0.15},
}};

}  // namespace armature::tools
