#include <armature/sdk/io/write_mesh.h>

#include "sdk/io/encode.h"
#include "sdk/io/file_bytes.h"

namespace armature::sdk {
namespace {

/// Tells a task of a long writing, and of its share of it: vertices first, then faces.
class WritingPace {
 public:
  WritingPace(const Task& task, std::size_t all) : task_(task), all_(all) {}
  WritingPace(const Task& task, const Mesh& mesh) : WritingPace(task, mesh.positions.size() + mesh.triangles.size()) {}

  [[nodiscard]] bool stopped() {
    if (++done_ % kEvery != 0) return false;
    task_.report("writing", static_cast<double>(done_) / static_cast<double>(all_));
    return task_.stopped();
  }

 private:
  static constexpr std::size_t kEvery = 16384;
  const Task& task_;
  std::size_t done_ = 0;
  std::size_t all_;
};

/// The statement of an OBJ vertex, which has a colour if any has.
void append_vertex(std::string& out, const Eigen::Vector3d& p, const std::vector<Colour>& colours, std::size_t i) {
  out += "v ";
  if (colours.empty())
    append_line(out, p.x(), p.y(), p.z());
  else
    append_line(out, p.x(), p.y(), p.z(), colours[i][0] / 255.0, colours[i][1] / 255.0, colours[i][2] / 255.0);
}

Expected<std::string> encode_obj(const Mesh& mesh, const Task& task) {
  std::string out;
  WritingPace pace(task, mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (pace.stopped()) return cancelled();
    append_vertex(out, mesh.positions[i], mesh.vertex_colours, i);
  }
  for (const Triangle& triangle : mesh.triangles) {
    if (pace.stopped()) return cancelled();
    out += "f ";
    append_line(out, triangle[0].index() + 1, triangle[1].index() + 1, triangle[2].index() + 1);
  }
  return out;
}

Expected<std::string> encode_off(const Mesh& mesh, const Task& task) {
  std::string out = mesh.vertex_colours.empty() ? "OFF\n" : "COFF\n";
  append_line(out, mesh.positions.size(), mesh.triangles.size(), 0);
  WritingPace pace(task, mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (pace.stopped()) return cancelled();
    const Eigen::Vector3d& p = mesh.positions[i];
    if (mesh.vertex_colours.empty()) {
      append_line(out, p.x(), p.y(), p.z());
    } else {
      const auto& [red, green, blue] = mesh.vertex_colours[i];
      append_line(out, p.x(), p.y(), p.z(), int{red}, int{green}, int{blue}, 255);
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (pace.stopped()) return cancelled();
    const auto& [a, b, c] = mesh.triangles[i];
    if (mesh.face_colours.empty()) {
      append_line(out, 3, a.index(), b.index(), c.index());
    } else {
      const auto& [red, green, blue] = mesh.face_colours[i];
      append_line(out, 3, a.index(), b.index(), c.index(), int{red}, int{green}, int{blue});
    }
  }
  return out;
}

constexpr std::string_view kColour = "property uchar red\nproperty uchar green\nproperty uchar blue\n";

/// What stands in a PLY header up to the coordinates of so many vertices.
std::string ply_vertices(std::size_t count, bool ascii) {
  std::string out = ascii ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_little_endian 1.0\n";
  out += "element vertex " + std::to_string(count) + '\n';
  return out + "property double x\nproperty double y\nproperty double z\n";
}

std::string ply_header(const Mesh& mesh, bool ascii) {
  std::string out = ply_vertices(mesh.positions.size(), ascii);
  if (!mesh.vertex_colours.empty()) out += kColour;
  out += "element face " + std::to_string(mesh.triangles.size()) + '\n';
  out += "property list uchar uint vertex_indices\n";
  if (!mesh.face_colours.empty()) out += kColour;
  out += "end_header\n";
  return out;
}

Expected<std::string> encode_ply(const Mesh& mesh, bool ascii, const Task& task) {
  std::string out = ply_header(mesh, ascii);
  PlyRow row(out, ascii);
  WritingPace pace(task, mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    if (pace.stopped()) return cancelled();
    for (const double coordinate : mesh.positions[i]) row.put(coordinate);
    if (!mesh.vertex_colours.empty()) row.put(mesh.vertex_colours[i]);
    row.end();
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (pace.stopped()) return cancelled();
    row.put(std::uint8_t{3});
    for (const VertexId corner : mesh.triangles[i]) row.put(static_cast<std::uint32_t>(corner.index()));
    if (!mesh.face_colours.empty()) row.put(mesh.face_colours[i]);
    row.end();
  }
  return out;
}

Expected<std::string> encode_ply(const PointSet& points, bool ascii, const Task& task) {
  std::string out = ply_vertices(points.positions.size(), ascii);
  out += "property double nx\nproperty double ny\nproperty double nz\n";
  if (!points.areas.empty()) out += "property double area\n";
  if (!points.colours.empty()) out += kColour;
  out += "end_header\n";
  PlyRow row(out, ascii);
  WritingPace pace(task, points.positions.size());
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    if (pace.stopped()) return cancelled();
    for (const double coordinate : points.positions[i]) row.put(coordinate);
    for (const double coordinate : points.normals[i]) row.put(coordinate);
    if (!points.areas.empty()) row.put(points.areas[i]);
    if (!points.colours.empty()) row.put(points.colours[i]);
    row.end();
  }
  return out;
}

Expected<std::string> encode_obj(const PointSet& points, const Task& task) {
  std::string out;
  WritingPace pace(task, points.positions.size());
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    if (pace.stopped()) return cancelled();
    append_vertex(out, points.positions[i], points.colours, i);
    out += "vn ";
    append_line(out, points.normals[i].x(), points.normals[i].y(), points.normals[i].z());
  }
  return out;
}

Expected<std::string> encode_xyz(const PointSet& points, const Task& task) {
  std::string out;
  WritingPace pace(task, points.positions.size());
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    if (pace.stopped()) return cancelled();
    const Eigen::Vector3d& p = points.positions[i];
    const Eigen::Vector3d& n = points.normals[i];
    append_line(out, p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  }
  return out;
}

}  // namespace

Expected<std::string> encode_mesh(const Mesh& mesh, MeshFormat format, bool ascii, const Task& task) {
  switch (format) {
    case MeshFormat::Obj: return encode_obj(mesh, task);
    case MeshFormat::Off: return encode_off(mesh, task);
    case MeshFormat::Ply: return encode_ply(mesh, ascii, task);
    case MeshFormat::Stl:
    case MeshFormat::Xyz:
    case MeshFormat::Other: break;
  }
  return fail("meshes are written as OBJ, OFF or PLY");
}

Expected<std::string> encode_points(const PointSet& points, MeshFormat format, bool ascii, const Task& task) {
  if (auto fine = validate(points); !fine) return tl::unexpected(fine.error());
  if (format == MeshFormat::Ply) return encode_ply(points, ascii, task);
  if (format == MeshFormat::Obj) return encode_obj(points, task);
  if (format == MeshFormat::Xyz) return encode_xyz(points, task);
  return fail("points are written as PLY, OBJ or XYZ");
}

Expected<void> write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                          const Task& task) {
  if (task.stopped()) return cancelled();
  const auto bytes = encode_mesh(mesh, options.format.value_or(mesh_format_of(path)), options.ascii, task);
  if (!bytes && bytes.error().kind == ErrorKind::Cancelled) return cancelled();
  if (!bytes) return fail(path.string() + ": expected a name that ends with .obj, .off or .ply");
  return write_file_bytes(path, *bytes);
}

Expected<void> write_points(const PointSet& points, const std::filesystem::path& path, const WriteOptions& options,
                            const Task& task) {
  if (task.stopped()) return cancelled();
  const auto bytes = encode_points(points, options.format.value_or(mesh_format_of(path)), options.ascii, task);
  if (!bytes && bytes.error().kind == ErrorKind::Cancelled) return cancelled();
  if (!bytes) return fail(path.string() + ": " + bytes.error().message);
  return write_file_bytes(path, *bytes);
}

}  // namespace armature::sdk
