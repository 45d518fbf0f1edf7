#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <armature/sdk/error.h>
#include <armature/sdk/io/mesh_format.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/mesh/point_set.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How a mesh is to be written.
struct WriteOptions {
  std::optional<MeshFormat> format = {};  ///< Obj, Off or Ply; by the file's extension where empty
  bool ascii = false;                     ///< PLY as text instead of little-endian binary
};

/// Writes a mesh as OBJ, OFF or PLY. Coordinates read back as the same bits. Colours are kept, but for those of faces
/// in OBJ, which has none. The file appears under its name once it is complete, or not at all.
[[nodiscard]] Expected<void> write_mesh(const Mesh& mesh, const std::filesystem::path& path,
                                        const WriteOptions& options = {}, const Task& task = {});

/// The bytes of such a file. `format` is Obj, Off or Ply.
[[nodiscard]] Expected<std::string> encode_mesh(const Mesh& mesh, MeshFormat format, bool ascii = false,
                                                const Task& task = {});

/// Writes points with their normals as PLY, which keeps areas and colours, OBJ (v and vn), which keeps colours, or XYZ.
/// As write_mesh() else.
[[nodiscard]] Expected<void> write_points(const PointSet& points, const std::filesystem::path& path,
                                          const WriteOptions& options = {}, const Task& task = {});

/// The bytes of such a file. `format` is Ply, Obj or Xyz.
[[nodiscard]] Expected<std::string> encode_points(const PointSet& points, MeshFormat format, bool ascii = false,
                                                  const Task& task = {});

}  // namespace armature::sdk
