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
  const auto& points = std::get<PointSet>(*read);
  if (points.normals.empty()) return fail(std::string(name) + ": expected at least one face; it has none");
  return fail(std::string(name) + ": has " + std::to_string(points.positions.size()) +
              " points and no faces; expected a triangle mesh: reconstruct its surface first");
}

/// What was read, unless it is points without normals.
Expected<MeshOrPoints> of_use(Expected<MeshOrPoints> read, std::string_view name) {
  const auto* points = read ? std::get_if<PointSet>(&*read) : nullptr;
  if (points != nullptr && points->normals.empty())
    return fail(std::string(name) +
                ": expected at least one face, or a normal for every point; it has neither: estimate normals first");
  return read;
}

Expected<MeshOrPoints> parse(std::string_view bytes, MeshFormat format, std::string_view name, const Task& task) {
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

Expected<MeshOrPoints> read(const std::filesystem::path& path, const ReadOptions& options, const Task& task) {
  if (task.stopped()) return cancelled();
  task.report("reading", 0);
  const MeshFormat format = options.format.value_or(mesh_format_of(path));
  // The formats that assimp reads may refer to other files beside this one.
  if (format == MeshFormat::Other) return read_by_assimp(path, task);
  const auto bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  auto shape = parse(*bytes, format, path.string(), task);
  if (shape) task.report("reading", 1);
  return shape;
}

}  // namespace

Expected<Mesh> parse_mesh(std::string_view bytes, MeshFormat format, std::string_view name, const Task& task) {
  return mesh_of(parse(bytes, format, name, task), name);
}

Expected<MeshOrPoints> parse_mesh_or_points(std::string_view bytes, MeshFormat format, std::string_view name,
                                            const Task& task) {
  return of_use(parse(bytes, format, name, task), name);
}

Expected<Mesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options, const Task& task) {
  return mesh_of(read(path, options, task), path.string());
}

Expected<MeshOrPoints> read_mesh_or_points(const std::filesystem::path& path, const ReadOptions& options,
                                           const Task& task) {
  return of_use(read(path, options, task), path.string());
}

}  // namespace armature::sdk
