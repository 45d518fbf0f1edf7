#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// The most corners a polygon may have: ear clipping takes time quadratic in them.
inline constexpr std::size_t kMostCorners = 10'000;
/// The most vertices or triangles a mesh may have: ids have 32 bits, and one of them names none.
inline constexpr std::size_t kMostElements = 0xFFFF'FFFE;

/// A mesh as a file has it: faces with any number of corners.
struct Polygons {
  std::vector<Eigen::Vector3d> positions;
  std::vector<VertexId> corners;      ///< of all polygons, one after the other
  std::vector<std::uint32_t> counts;  ///< by polygon: how many corners, 3 to kMostCorners
  std::vector<Colour> vertex_colours;
  std::vector<Colour> polygon_colours;
  std::vector<Eigen::Vector3d> normals = {};  ///< by position, of unit length; looked at where there is no polygon
  std::vector<double> areas = {};             ///< likewise, or empty
};

/// The polygons as triangles. Every corner names a position. Colours are kept where all vertices, or all polygons, have
/// one. `name` stands for the file in messages. Fails on a file
/// without a face and when asked to stop.
[[nodiscard]] Expected<Mesh> triangulated(Polygons polygons, std::string_view name, const Task& task);

/// The same, or points where there are positions and no polygon; with normals where all have one, else without any.
[[nodiscard]] Expected<MeshOrPoints> mesh_or_points(Polygons polygons, std::string_view name, const Task& task);

/// What is wrong with a normal of a file, and what to do, and leaves it as it is; empty if it has a direction, and it
/// comes out of unit length.
[[nodiscard]] std::string_view made_unit(Eigen::Vector3d& normal) noexcept;

/// A colour out of numbers of [0, 1].
[[nodiscard]] Colour colour_of_fractions(double red, double green, double blue) noexcept;

}  // namespace armature::sdk
