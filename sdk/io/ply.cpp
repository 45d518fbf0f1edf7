#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <armature/sdk/spheremesh/make_sphere_mesh.h>

#include "sdk/io/mesh_parsers.h"
#include "sdk/io/ply_header.h"
#include "sdk/io/ply_rows.h"
#include "sdk/io/polygons.h"
#include "sdk/io/sphere_mesh_parsers.h"

namespace armature::sdk {
namespace {

/// What a PLY file is asked for; of what is not, nothing is looked at.
enum class PlyAsk : std::uint8_t {
  Surface,  ///< faces, or points with normals and areas
  Spheres,  ///< radii, edges and faces
};

/// What a PLY file tells of shapes.
struct PlyContent {
  Polygons polygons = {};
  std::vector<double> radii = {};  ///< by vertex, or empty
  std::vector<SpherePair> edges = {};
};

/// The places of red, green and blue among the properties of an element, and what one is.
struct ColourProperties {
  std::array<std::size_t, 3> at = {};
  double one = 255;

  [[nodiscard]] Colour of(const PlyRows& rows) const noexcept {
    return colour_of_fractions(rows.value(at[0]) / one, rows.value(at[1]) / one, rows.value(at[2]) / one);
  }
};

std::optional<ColourProperties> find_colour(const PlyElement& element) {
  const auto red = element.find({"red", "diffuse_red"});
  const auto green = element.find({"green", "diffuse_green"});
  const auto blue = element.find({"blue", "diffuse_blue"});
  if (!red || !green || !blue) return {};
  const PlyProperty& property = element.properties[*red];
  if (property.count) return {};
  ColourProperties colour{.at = {*red, *green, *blue}};
  if (property.type >= PlyType::Float32) colour.one = 1;
  if (property.type == PlyType::Uint16) colour.one = 65535;
  return colour;
}

std::optional<std::array<std::size_t, 3>> find_normal(const PlyElement& element) {
  const auto x = element.find({"nx", "normal_x"});
  const auto y = element.find({"ny", "normal_y"});
  const auto z = element.find({"nz", "normal_z"});
  if (!x || !y || !z) return {};
  return std::array{*x, *y, *z};
}

std::string shown(double value) {
  return value == std::floor(value) && std::abs(value) < 1e15 ? std::to_string(static_cast<std::int64_t>(value))
                                                              : std::to_string(value);
}

std::string shown(const Eigen::Vector3d& v) {
  return shown(v.x()) + " " + shown(v.y()) + " " + shown(v.z());
}

class PlyParser {
 public:
  PlyParser(std::string_view bytes, std::string_view name, const PlyHeader& header, PlyAsk ask, const Task& task)
      : bytes_(bytes), header_(header), ask_(ask), rows_(bytes, name, header), pace_(task) {
    for (const PlyElement& element : header.elements)
      if (element.name == "vertex")
        vertices_ = element.count;
      else if (element.name == "face")
        faces_ = element.count;
  }

  Expected<PlyContent> parse() {
    for (const PlyElement& element : header_.elements)
      if (element.name == "tristrips" && element.count > 0)
        return fail(std::string(name()) + ": holds triangle strips; convert them to faces");
    for (const PlyElement& element : header_.elements) {
      auto read = element.name == "vertex"                            ? vertices(element)
                  : element.name == "face"                            ? faces(element)
                  : element.name == "edge" && ask_ == PlyAsk::Spheres ? edges(element)
                                                                      : skip(element);
      if (!read) return tl::unexpected(read.error());
    }
    if (auto read = rows_.end(); !read) return tl::unexpected(read.error());
    return std::move(content_);
  }

 private:
  Expected<void> vertices(const PlyElement& element) {
    const auto x = element.find({"x"});
    const auto y = element.find({"y"});
    const auto z = element.find({"z"});
    if (!x || !y || !z) return fail(std::string(name()) + ": expected properties x, y and z of element vertex");
    if (!content_.polygons.positions.empty()) return fail(std::string(name()) + ": expected one element vertex");
    const auto radius = ask_ == PlyAsk::Spheres ? element.find({"radius"}) : std::nullopt;
    const auto colour = find_colour(element);
    // Of what has faces nobody asks for normals.
    const auto normal = ask_ == PlyAsk::Surface && faces_ == 0 ? find_normal(element) : std::nullopt;
    const auto area = normal ? element.find({"area"}) : std::nullopt;
    if (auto read = rows_.begin(element); !read) return read;
    content_.polygons.positions.reserve(element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
      if (auto read = next(); !read) return read;
      const Eigen::Vector3d p(rows_.value(*x), rows_.value(*y), rows_.value(*z));
      for (const double coordinate : p)
        if (!std::isfinite(coordinate)) return rows_.expected("finite coordinates", shown(coordinate));
      content_.polygons.positions.push_back(p);
      if (colour) content_.polygons.vertex_colours.push_back(colour->of(rows_));
      if (normal) {
        Eigen::Vector3d n(rows_.value((*normal)[0]), rows_.value((*normal)[1]), rows_.value((*normal)[2]));
        if (const auto wrong = made_unit(n); !wrong.empty()) return rows_.expected(wrong, shown(n));
        content_.polygons.normals.push_back(n);
      }
      if (area) {
        const double a = rows_.value(*area);
        if (!std::isfinite(a) || a < 0) return rows_.expected("an area that is finite and not negative", shown(a));
        content_.polygons.areas.push_back(a);
      }
      if (!radius) continue;
      const double r = rows_.value(*radius);
      if (!std::isfinite(r) || r < 0) return rows_.expected("a radius that is finite and not negative", shown(r));
      content_.radii.push_back(r);
    }
    if (rows_.surplus()) content_.polygons.vertex_colours.clear();
    return {};
  }

  Expected<void> faces(const PlyElement& element) {
    const auto corners = element.find({"vertex_indices", "vertex_index"});
    if (!corners || !element.properties[*corners].count)
      return fail(std::string(name()) + ": expected a list vertex_indices of element face");
    const auto colour = find_colour(element);
    if (auto read = rows_.begin(element, corners); !read) return read;
    Polygons& polygons = content_.polygons;
    polygons.counts.reserve(element.count);
    polygons.corners.reserve(3 * element.count);
    for (std::size_t i = 0; i < element.count; ++i) {
      if (auto read = next(); !read) return read;
      const std::size_t count = rows_.list().size();
      if (count < 3 || count > kMostCorners)
        return rows_.expected("a face of 3 to 10000 corners", std::to_string(count));
      polygons.counts.push_back(static_cast<std::uint32_t>(count));
      for (const double index : rows_.list()) {
        if (!names_vertex(index)) return not_a_vertex(index);
        polygons.corners.emplace_back(static_cast<std::uint32_t>(index));
      }
      if (colour) polygons.polygon_colours.push_back(colour->of(rows_));
    }
    if (rows_.surplus()) polygons.polygon_colours.clear();
    return {};
  }

  Expected<void> edges(const PlyElement& element) {
    const auto first = element.find({"vertex1"});
    const auto second = element.find({"vertex2"});
    if (!first || !second) return skip(element);
    if (auto read = rows_.begin(element); !read) return read;
    for (std::size_t i = 0; i < element.count; ++i) {
      if (auto read = next(); !read) return read;
      const double a = rows_.value(*first);
      const double b = rows_.value(*second);
      if (!names_vertex(a)) return not_a_vertex(a);
      if (!names_vertex(b)) return not_a_vertex(b);
      content_.edges.push_back({SphereId(static_cast<std::uint32_t>(a)), SphereId(static_cast<std::uint32_t>(b))});
    }
    return {};
  }

  Expected<void> skip(const PlyElement& element) {
    if (auto read = rows_.begin(element); !read) return read;
    for (std::size_t i = 0; i < element.count; ++i)
      if (auto read = next(); !read) return read;
    return {};
  }

  Expected<void> next() {
    if (pace_.stopped(rows_.position(), bytes_.size())) return cancelled();
    return rows_.next();
  }

  [[nodiscard]] bool names_vertex(double index) const noexcept {
    return index >= 0 && index < static_cast<double>(vertices_) && index == std::floor(index);
  }

  [[nodiscard]] tl::unexpected<Error> not_a_vertex(double index) const {
    return rows_.expected("the number of a vertex below " + std::to_string(vertices_), shown(index));
  }

  [[nodiscard]] std::string_view name() const noexcept { return rows_.name(); }

  std::string_view bytes_;
  const PlyHeader& header_;
  PlyAsk ask_;
  PlyRows rows_;
  ReadingPace pace_;
  PlyContent content_;
  std::size_t vertices_ = 0, faces_ = 0;
};

Expected<PlyContent> parse_content(std::string_view bytes, std::string_view name, PlyAsk ask, const Task& task) {
  const auto header = parse_ply_header(bytes, name);
  if (!header) return tl::unexpected(header.error());
  return PlyParser(bytes, name, *header, ask, task).parse();
}

}  // namespace

Expected<MeshOrPoints> parse_ply(std::string_view bytes, std::string_view name, const Task& task) {
  auto content = parse_content(bytes, name, PlyAsk::Surface, task);
  if (!content) return tl::unexpected(content.error());
  return mesh_or_points(std::move(content->polygons), name, task);
}

Expected<SphereMesh> parse_sphere_ply(std::string_view bytes, std::string_view name, const Task& task) {
  auto content = parse_content(bytes, name, PlyAsk::Spheres, task);
  if (!content) return tl::unexpected(content.error());
  const Polygons& polygons = content->polygons;
  if (polygons.positions.empty()) return fail(std::string(name) + ": expected at least one sphere; it has none");
  if (content->radii.empty()) return fail(std::string(name) + ": expected a property radius of element vertex");
  std::vector<Sphere> spheres;
  spheres.reserve(polygons.positions.size());
  for (std::size_t i = 0; i < polygons.positions.size(); ++i)
    spheres.push_back({polygons.positions[i], content->radii[i]});
  std::vector<SphereTriple> triangles;
  triangles.reserve(polygons.counts.size());
  for (std::size_t i = 0; i < polygons.counts.size(); ++i) {
    if (polygons.counts[i] != 3)
      return fail(std::string(name) + ": expected triangles; face " + std::to_string(i) + " has " +
                  std::to_string(polygons.counts[i]) + " corners");
    SphereTriple& triple = triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) triple[k] = SphereId(polygons.corners[3 * i + k].index());
  }
  return make_sphere_mesh(std::move(spheres), content->edges, triangles);
}

}  // namespace armature::sdk
