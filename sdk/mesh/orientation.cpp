#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/mesh/orientation.h>

#include "sdk/mesh/nesting.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// Which faces of each patch (faces linked by edges of two faces) disagree with the larger part of its area.
struct Patches {
  std::vector<bool> turned;  ///< by FaceId
  bool orientable = true;
};

Patches agree_within_patches(const Mesh& mesh, const Adjacency& adjacency) {
  Patches result{.turned = std::vector<bool>(mesh.triangles.size(), false)};
  std::vector<bool> reached(mesh.triangles.size(), false);
  std::vector<FaceId> patch;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (reached[i]) continue;
    reached[i] = true;
    patch.assign(1, FaceId(i));
    double turned_area = 0;
    double kept_area = 0;
    bool orientable = true;
    for (std::size_t next = 0; next < patch.size(); ++next) {
      const FaceId face = patch[next];
      const bool turned = result.turned[face.index()];
      (turned ? turned_area : kept_area) += area_vector(mesh, face).stableNorm();
      for (const EdgeId edge : adjacency.edges(face)) {
        if (!edge.valid() || adjacency.faces(edge).size() != 2) continue;
        const auto faces = adjacency.faces(edge);
        const FaceId neighbour = faces[0] == face ? faces[1] : faces[0];
        const bool same_way =
            walks_upwards(mesh, adjacency, face, edge) == walks_upwards(mesh, adjacency, neighbour, edge);
        if (!reached[neighbour.index()]) {
          reached[neighbour.index()] = true;
          result.turned[neighbour.index()] = turned != same_way;
          patch.push_back(neighbour);
        } else if (result.turned[neighbour.index()] != (turned != same_way)) {
          orientable = false;
        }
      }
    }
    result.orientable = result.orientable && orientable;
    // What has one side only stays as it is.
    if (!orientable)
      for (const FaceId face : patch) result.turned[face.index()] = false;
    else if (turned_area > kept_area)
      for (const FaceId face : patch) result.turned[face.index()] = !result.turned[face.index()];
  }
  return result;
}

/// A part of the surface linked by edges.
struct Shell {
  std::vector<FaceId> faces;
  Eigen::AlignedBox3d box;
  double volume = 0;
  bool closed = true;
  bool inward = false;
};

/// The centroid of faces, weighted by area; the centre of the box where they have none.
Vector3d centroid(const Mesh& mesh, const Shell& shell) {
  Vector3d sum = Vector3d::Zero();
  double area = 0;
  const Vector3d origin = shell.box.center();
  for (const FaceId face : shell.faces) {
    const double weight = area_vector(mesh, face).norm();
    area += weight;
    for (std::size_t k = 0; k < 3; ++k) sum += weight / 3 * (mesh.corner(face, k) - origin);
  }
  if (!(area > 0)) return origin;
  return origin + sum / area;
}

/// The volume of the tetrahedra from a point to faces.
double volume_from(const Mesh& mesh, const Vector3d& apex, FaceId face) {
  return (mesh.corner(face, 0) - apex).dot((mesh.corner(face, 1) - apex).cross(mesh.corner(face, 2) - apex)) / 6;
}

/// The parts with their volumes.
std::vector<Shell> gather(const Mesh& mesh, const Components& components, const std::vector<bool>& turned) {
  std::vector<Shell> shells(components.count);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (components.of_face[i] == Components::kNone) continue;
    Shell& shell = shells[components.of_face[i]];
    shell.faces.emplace_back(i);
    for (const VertexId vertex : mesh.triangles[i]) shell.box.extend(mesh.position(vertex));
  }
  for (Shell& shell : shells) {
    const Vector3d apex = centroid(mesh, shell);
    for (const FaceId face : shell.faces) {
      const double volume = volume_from(mesh, apex, face);
      shell.volume += turned[face.index()] ? -volume : volume;
    }
  }
  return shells;
}

std::vector<Shell> find_shells(const Mesh& mesh, const Adjacency& adjacency, const std::vector<bool>& turned) {
  std::vector<Shell> shells = gather(mesh, find_components(mesh, adjacency, LinkedBy::Edges), turned);
  for (Shell& shell : shells) {
    double area = 0;
    for (const FaceId face : shell.faces) {
      area += area_vector(mesh, face).norm();
      for (const EdgeId edge : adjacency.edges(face))
        if (adjacency.faces(edge).size() == 1) shell.closed = false;
    }
    // In parts of the volume of a ball with the same area; a sheet that is nearly flat has no side that is outside.
    const double ball = area * std::sqrt(area / std::numbers::pi) / 6;
    constexpr double kLeastClosed = 1e-12;
    constexpr double kLeastOpen = 1e-2;
    shell.inward = shell.volume < -(shell.closed ? kLeastClosed : kLeastOpen) * ball;
  }
  return shells;
}

/// The shells by what lies in what, their faces turned as given.
Nesting nesting_of(const Mesh& mesh, const std::vector<Shell>& shells, const std::vector<bool>& turned) {
  std::vector<NestedPart> parts;
  parts.reserve(shells.size());
  for (const Shell& shell : shells) {
    const FaceId face = shell.faces.front();
    const Vector3d point = (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
    parts.push_back({.box = shell.box, .point = point, .inward = shell.inward});
  }
  return {std::move(parts), [&](std::size_t shell, const Vector3d& point) {
            double sum = 0;
            for (const FaceId face : shells[shell].faces) {
              const double part = winding(mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2), point);
              sum += turned[face.index()] ? -part : part;
            }
            return sum;
          }};
}

}  // namespace

bool is_oriented(const Mesh& mesh, const Adjacency& adjacency) {
  for (std::size_t i = 0; i < adjacency.edge_count(); ++i) {
    const auto faces = adjacency.faces(EdgeId(i));
    if (faces.size() == 2 &&
        walks_upwards(mesh, adjacency, faces[0], EdgeId(i)) == walks_upwards(mesh, adjacency, faces[1], EdgeId(i)))
      return false;
  }
  return true;
}

bool is_orientable(const Mesh& mesh, const Adjacency& adjacency) {
  return agree_within_patches(mesh, adjacency).orientable;
}

std::vector<double> signed_volumes(const Mesh& mesh, const Components& components) {
  std::vector<double> volumes;
  volumes.reserve(components.count);
  const std::vector<bool> as_they_are(mesh.triangles.size(), false);
  for (const Shell& part : gather(mesh, components, as_they_are)) volumes.push_back(part.volume);
  return volumes;
}

Expected<std::vector<bool>> find_inward_faces(const Mesh& mesh, const Adjacency& adjacency, const Task& task) {
  std::vector<bool> turned = agree_within_patches(mesh, adjacency).turned;
  const std::vector<Shell> shells = find_shells(mesh, adjacency, turned);
  const Nesting nesting = nesting_of(mesh, shells, turned);
  if (!nesting.any_inward()) return turned;
  std::vector<bool> result = turned;
  for (std::size_t i = 0; i < shells.size(); ++i) {
    if (task.stopped()) return cancelled();
    task.report("orientation", static_cast<double>(i) / static_cast<double>(shells.size()));
    if (!nesting.points_inward(i)) continue;
    for (const FaceId face : shells[i].faces) result[face.index()] = !turned[face.index()];
  }
  return result;
}

Expected<std::size_t> orient_outward(Mesh& mesh, const Task& task) {
  const auto inward = find_inward_faces(mesh, Adjacency(mesh), task);
  if (!inward) return tl::unexpected(inward.error());
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!(*inward)[i]) continue;
    std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
    ++count;
  }
  return count;
}

}  // namespace armature::sdk
