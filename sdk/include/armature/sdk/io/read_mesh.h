#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <variant>

#include <armature/sdk/error.h>
#include <armature/sdk/io/mesh_format.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How a mesh is to be read.
struct ReadOptions {
  std::optional<MeshFormat> format = {};  ///< by the file's extension where empty
};

/// Reads a triangle mesh from a file. Vertices keep their order, faces theirs; a polygon becomes consecutive triangles
/// (see `triangulate_polygon()`). Numbers become the doubles nearest to them. Non-manifold, open, degenerate,
/// duplicated and inside-out meshes are read as they are. A file that is truncated, corrupt, without a face (one of
/// points with normals alone is told so), or has triangle strips (of PLY), an index out of range or a coordinate that
/// is not finite is refused with its name, the line or byte, and what was expected. What is not of a mesh (normals,
/// radii, edges) is skipped.
[[nodiscard]] Expected<Mesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options = {},
                                       const Task& task = {});

/// The same for the bytes of a file of that format. `name` stands for the file in messages. Never reads another file.
[[nodiscard]] Expected<Mesh> parse_mesh(std::string_view bytes, MeshFormat format, std::string_view name,
                                        const Task& task = {});

/// What a file of a shape holds.
using MeshOrPoints = std::variant<Mesh, PointSet>;

/// Reads a triangle mesh as read_mesh() does, or points with normals from a file that has no faces: PLY with properties
/// nx, ny, nz (and area, if there is one), OBJ with as many lines vn as v, which belong together in their order, OFF
/// with normals (NOFF), and lines of six numbers (MeshFormat::Xyz). Points keep their order; normals come out of unit
/// length. Refused as well, with the line or byte: a normal that is 0 0 0 or not finite, fewer or more normals than
/// points, a negative area.
[[nodiscard]] Expected<MeshOrPoints> read_mesh_or_points(const std::filesystem::path& path,
                                                         const ReadOptions& options = {}, const Task& task = {});

/// The same for the bytes of a file of that format, as parse_mesh().
[[nodiscard]] Expected<MeshOrPoints> parse_mesh_or_points(std::string_view bytes, MeshFormat format,
                                                          std::string_view name, const Task& task = {});

}  // namespace armature::sdk
