#include <cctype>
#include <string>
#include <utility>

#include <armature/sdk/io/read_mesh.h>

#include "sdk/io/assimp.h"
#include "sdk/io/file_bytes.h"
#include "sdk/io/mesh_parsers.h"

namespace armature::sdk {

MeshFormat mesh_format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".off") return MeshFormat::Off;
  if (extension == ".obj") return MeshFormat::Obj;
  if (extension == ".ply") return MeshFormat::Ply;
  if (extension == ".stl") return MeshFormat::Stl;
  if (extension == ".xyz" || extension == ".xyzn" || extension == ".pwn") return MeshFormat::Xyz;
  return MeshFormat::Other;
}

namespace {

/// The mesh, or that there is none.
Expected<Mesh> mesh_of(Expected<MeshOrPoints> read, std::string_view name) {
  if (!read) return tl::unexpected(read.error());
  if (auto* mesh = std::get_if<Mesh>(&*read)) return std::move(*mesh);
  return fail(std::string(name) + ": has " + std::to_string(std::get<PointSet>(*read).positions.size()) +
              " points and no faces; expected a triangle mesh: reconstruct its surface first");
}

}  // namespace

Expected<MeshOrPoints> parse_mesh_or_points(std::string_view bytes, MeshFormat format, std::string_view name,
                                            const Task& task) {
  switch (format) {
    case MeshFormat::Off: return parse_off(bytes, name, task);
    case MeshFormat::Obj: return parse_obj(bytes, name, task);
    case MeshFormat::Ply: return parse_ply(bytes, name, task);
    case MeshFormat::Stl: return parse_stl(bytes, name, task);
    case MeshFormat::Xyz: return parse_xyz(bytes, name, task);
    case MeshFormat::Other: break;
  }
  return parse_by_assimp(bytes, name, task);
}

Expected<Mesh> parse_mesh(std::string_view bytes, MeshFormat format, std::string_view name, const Task& task) {
  return mesh_of(parse_mesh_or_points(bytes, format, name, task), name);
}

Expected<MeshOrPoints> read_mesh_or_points(const std::filesystem::path& path, const ReadOptions& options,
                                           const Task& task) {
  if (task.stopped()) return cancelled();
  task.report("reading", 0);
  const MeshFormat format = options.format.value_or(mesh_format_of(path));
  // The formats that assimp reads may refer to other files beside this one.
  if (format == MeshFormat::Other) return read_by_assimp(path, task);
  const auto bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  auto read = parse_mesh_or_points(*bytes, format, path.string(), task);
  if (read) task.report("reading", 1);
  return read;
}

Expected<Mesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options, const Task& task) {
  return mesh_of(read_mesh_or_points(path, options, task), path.string());
}

}  // namespace armature::sdk
