#include "viewer/scene/scene.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "viewer/scene/shading.h"

namespace armature::viewer {
namespace {

using Eigen::Vector3d;

std::array<float, 3> floats(const Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Neither of its spheres holds the other, so that a cone lies between them.
bool has_cone(const sdk::SphereEdge& edge) {
  return (edge.b.centre - edge.a.centre).norm() > std::abs(edge.b.radius - edge.a.radius);
}

/// The sides of the triangles, each once, without those that are wire edges anyhow.
std::vector<sdk::SpherePair> sides_of(const sdk::SphereMesh& shape) {
  std::vector<sdk::SpherePair> sides;
  for (const sdk::SphereTriple& t : shape.triangles)
    sides.insert(sides.end(), {{t[0], t[1]}, {t[0], t[2]}, {t[1], t[2]}});
  std::sort(sides.begin(), sides.end());
  sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
  return sides;
}

}  // namespace

Scene::Scene(const sdk::Sphere& frame, const Palette& palette) : frame_(frame), palette_(palette) {
  if (!(frame_.radius > 0)) frame_.radius = 1;
}

std::array<float, 3> Scene::local(const Vector3d& point) const {
  return floats((point - frame_.centre) / frame_.radius);
}

std::array<float, 4> Scene::local(const sdk::Sphere& sphere) const {
  const auto centre = local(sphere.centre);
  return {centre[0], centre[1], centre[2], static_cast<float>(sphere.radius / frame_.radius)};
}

void Scene::add(const sdk::Mesh& mesh, const MeshStyle& style) {
  Content& content = content_of(style.layer);
  std::vector<std::array<Vector3d, 3>> found;
  if (style.normals.empty()) found = corner_normals(mesh, style.crease_rad);
  const auto normals = style.normals.empty() ? std::span<const std::array<Vector3d, 3>>(found) : style.normals;
  const std::uint32_t flags = style.wireframe ? kLines : 0;
  content.corners.reserve(content.corners.size() + 3 * mesh.triangles.size());
  content.colours.reserve(content.colours.size() + 3 * mesh.triangles.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t vertex = mesh.triangles[f][k].index();
      sdk::Colour colour = palette_.mesh;
      if (!style.colours.empty()) {
        colour = style.colours[f][k];
      } else if (!mesh.face_colours.empty()) {
        colour = mesh.face_colours[f];
      } else if (!mesh.vertex_colours.empty()) {
        colour = mesh.vertex_colours[vertex];
      }
      content.corners.push_back({local(mesh.positions[vertex]), floats(normals[f][k]), flags});
      content.colours.push_back(colour);
    }
  }
}

void Scene::add(const sdk::SphereMesh& shape, const SphereMeshStyle& style) {
  Content& content = content_of(style.layer);
  if (style.shape == SphereMeshStyle::Shape::Surface) {
    add_surface(shape, content);
  } else {
    add_structure(shape, content);
  }
}

void Scene::add_surface(const sdk::SphereMesh& shape, Content& content) const {
  for (const sdk::Sphere& sphere : shape.spheres) add_ball(sphere, palette_.sphere, content);
  for (const auto& [a, b] : shape.edges) add_cone({shape.sphere(a), shape.sphere(b)}, palette_.edge, content);
  for (const auto& [a, b] : sides_of(shape)) add_cone({shape.sphere(a), shape.sphere(b)}, palette_.triangle, content);
  for (const auto& [a, b, c] : shape.triangles)
    add_facets({shape.sphere(a), shape.sphere(b), shape.sphere(c)}, content);
}

void Scene::add_facets(const sdk::SphereTriangle& triangle, Content& content) const {
  const auto normals = sdk::tangent_normals(triangle);
  if (!normals) return;
  for (const Vector3d& normal : *normals) {
    const auto touched = [&](const sdk::Sphere& sphere) -> Vector3d { return sphere.centre + sphere.radius * normal; };
    add_triangle({touched(triangle.a), touched(triangle.b), touched(triangle.c)}, normal, kOneSided, content);
  }
}

void Scene::add_structure(const sdk::SphereMesh& shape, Content& content) const {
  // Many spheres are drawn thinner, so that they stay apart.
  const double crowd = std::sqrt(60.0 / std::max<double>(60, static_cast<double>(shape.spheres.size())));
  const double thin = 0.006 * crowd * frame_.radius;
  const double triangle_side = 0.6 * thin;
  for (const sdk::Sphere& sphere : shape.spheres)
    add_ball({sphere.centre, std::max(2.2 * thin, 0.3 * sphere.radius)}, palette_.sphere, content);
  const auto add_tube = [&](sdk::SphereId a, sdk::SphereId b, double radius, const sdk::Colour& colour) {
    add_cone({{shape.sphere(a).centre, radius}, {shape.sphere(b).centre, radius}}, colour, content);
  };
  for (const auto& [a, b] : shape.edges) add_tube(a, b, thin, palette_.edge);
  for (const auto& [a, b] : sides_of(shape)) add_tube(a, b, triangle_side, palette_.edge);
  for (const auto& [a, b, c] : shape.triangles) {
    const std::array<Vector3d, 3> corners = {shape.sphere(a).centre, shape.sphere(b).centre, shape.sphere(c).centre};
    const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).stableNormalized();
    add_triangle(corners, normal, kTwoSided, content);
  }
}

void Scene::add_ball(const sdk::Sphere& sphere, const sdk::Colour& colour, Content& content) const {
  if (sphere.radius > 0) content.balls.push_back({local(sphere), colour});
}

void Scene::add_cone(const sdk::SphereEdge& edge, const sdk::Colour& colour, Content& content) const {
  if (has_cone(edge)) content.cones.push_back({local(edge.a), local(edge.b), colour});
}

void Scene::add_triangle(const std::array<Vector3d, 3>& corners, const Vector3d& normal, std::uint32_t flags,
                         Content& content) const {
  // Counter-clockwise around its normal, as the front of a face is told from its back.
  const bool flip = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(normal) < 0;
  for (const std::size_t k : {std::size_t{0}, std::size_t{flip ? 2U : 1U}, std::size_t{flip ? 1U : 2U}})
    content.corners.push_back({local(corners[k]), floats(normal), flags});
  content.colours.insert(content.colours.end(), 3, palette_.triangle);
}

}  // namespace armature::viewer
