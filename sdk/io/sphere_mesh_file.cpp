#include <algorithm>
#include <cctype>

#include <armature/sdk/io/sphere_mesh_file.h>

#include "sdk/io/encode.h"
#include "sdk/io/file_bytes.h"
#include "sdk/io/ply_header.h"
#include "sdk/io/sphere_mesh_parsers.h"

namespace armature::sdk {
namespace {

std::string encode_ma(const SphereMesh& shape) {
  std::string out;
  append_line(out, shape.spheres.size(), shape.edges.size(), shape.triangles.size());
  for (const Sphere& s : shape.spheres) {
    out += "v ";
    append_line(out, s.centre.x(), s.centre.y(), s.centre.z(), s.radius);
  }
  for (const auto& [a, b] : shape.edges) {
    out += "e ";
    append_line(out, a.index(), b.index());
  }
  for (const auto& [a, b, c] : shape.triangles) {
    out += "f ";
    append_line(out, a.index(), b.index(), c.index());
  }
  return out;
}

std::string encode_sphere_ply(const SphereMesh& shape) {
  std::string out = "ply\nformat binary_little_endian 1.0\n";
  out += "element vertex " + std::to_string(shape.spheres.size()) + '\n';
  out += "property double x\nproperty double y\nproperty double z\nproperty double radius\n";
  out += "element edge " + std::to_string(shape.edges.size()) + '\n';
  out += "property uint vertex1\nproperty uint vertex2\n";
  out += "element face " + std::to_string(shape.triangles.size()) + '\n';
  out += "property list uchar uint vertex_indices\nend_header\n";
  const auto append_id = [&](SphereId id) { append_binary(out, static_cast<std::uint32_t>(id.index())); };
  for (const Sphere& s : shape.spheres) {
    for (const double coordinate : s.centre) append_binary(out, coordinate);
    append_binary(out, s.radius);
  }
  for (const SpherePair& pair : shape.edges)
    for (const SphereId id : pair) append_id(id);
  for (const SphereTriple& triple : shape.triangles) {
    append_binary(out, std::uint8_t{3});
    for (const SphereId id : triple) append_id(id);
  }
  return out;
}

std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      default: out += c >= ' ' || c < 0 ? c : ' ';
    }
  }
  return out;
}

std::string encode_urdf(const SphereMesh& shape, std::string_view name) {
  const std::string called = xml_text(name);
  std::string out = "<?xml version=\"1.0\"?>\n<robot name=\"" + called + "\">\n  <link name=\"" + called + "\">\n";
  for (const std::string_view use : {"collision", "visual"}) {
    for (const Sphere& s : shape.spheres) {
      // Simulators refuse a sphere without a radius.
      if (s.radius <= 0) continue;
      out.append("    <").append(use).append("><origin xyz=\"");
      append_line(out, s.centre.x(), s.centre.y(), s.centre.z());
      out.back() = '"';
      out += " rpy=\"0 0 0\"/><geometry><sphere radius=\"";
      append_number(out, s.radius);
      out.append("\"/></geometry></").append(use).append(">\n");
    }
  }
  out += "  </link>\n</robot>\n";
  return out;
}

}  // namespace

std::optional<SphereMeshFormat> sphere_mesh_format_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".ma") return SphereMeshFormat::Ma;
  if (extension == ".ply") return SphereMeshFormat::Ply;
  if (extension == ".urdf") return SphereMeshFormat::Urdf;
  return {};
}

bool holds_sphere_mesh(const std::filesystem::path& path) {
  const auto format = sphere_mesh_format_of(path);
  if (format != SphereMeshFormat::Ply) return format.has_value();
  constexpr std::size_t kLongestHeader = 1U << 16U;
  const auto bytes = read_file_bytes(path, kLongestHeader);
  if (!bytes) return false;
  const auto header = parse_ply_header(*bytes, path.string());
  return header && std::ranges::any_of(header->elements, [](const PlyElement& element) {
           return element.name == "vertex" && element.find({"radius"});
         });
}

Expected<SphereMesh> parse_sphere_mesh(std::string_view bytes, SphereMeshFormat format, std::string_view name,
                                       const Task& task) {
  switch (format) {
    case SphereMeshFormat::Ma: return parse_ma(bytes, name, task);
    case SphereMeshFormat::Ply: return parse_sphere_ply(bytes, name, task);
    case SphereMeshFormat::Urdf: break;
  }
  return fail(std::string(name) + ": expected a sphere-mesh as .ma or .ply; URDF is written only");
}

Expected<SphereMesh> read_sphere_mesh(const std::filesystem::path& path, const Task& task) {
  if (task.stopped()) return cancelled();
  const auto format = sphere_mesh_format_of(path);
  if (!format) return fail(path.string() + ": expected a name that ends with .ma or .ply");
  const auto bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return parse_sphere_mesh(*bytes, *format, path.string(), task);
}

std::string encode_sphere_mesh(const SphereMesh& shape, SphereMeshFormat format, std::string_view name) {
  switch (format) {
    case SphereMeshFormat::Ma: return encode_ma(shape);
    case SphereMeshFormat::Ply: return encode_sphere_ply(shape);
    case SphereMeshFormat::Urdf: break;
  }
  return encode_urdf(shape, name);
}

Expected<void> write_sphere_mesh(const SphereMesh& shape, const std::filesystem::path& path, const Task& task) {
  if (task.stopped()) return cancelled();
  const auto format = sphere_mesh_format_of(path);
  if (!format) return fail(path.string() + ": expected a name that ends with .ma, .ply or .urdf");
  return write_file_bytes(path, encode_sphere_mesh(shape, *format, path.stem().string()));
}

}  // namespace armature::sdk
