#include <algorithm>
#include <array>
#include <string>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/boundary.h>
#include <armature/sdk/mesh/components.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/mesh/orientation.h>
#include <armature/sdk/mesh/report.h>

namespace armature::sdk {
namespace {

std::size_t count_duplicates(const Mesh& mesh) {
  std::vector<Triangle> sorted = mesh.triangles;
  for (Triangle& triangle : sorted) std::sort(triangle.begin(), triangle.end());
  std::sort(sorted.begin(), sorted.end());
  return static_cast<std::size_t>(sorted.end() - std::unique(sorted.begin(), sorted.end()));
}

void count_edges(const Adjacency& adjacency, MeshReport& report) {
  report.edges = adjacency.edge_count();
  for (std::size_t i = 0; i < adjacency.edge_count(); ++i) {
    const std::size_t faces = adjacency.faces(EdgeId(i)).size();
    if (faces == 1) ++report.boundary_edges;
    if (faces > 2) ++report.nonmanifold_edges;
  }
}

/// Of a manifold whose faces could all agree; nothing for others.
std::optional<std::int64_t> genus(const Mesh& mesh, const Adjacency& adjacency, const MeshReport& report) {
  if (report.nonmanifold_edges > 0 || report.nonmanifold_vertices > 0) return {};
  if (!report.oriented && !is_orientable(mesh, adjacency)) return {};
  std::int64_t faces = 0;
  for (const Triangle& triangle : mesh.triangles)
    if (!repeats_a_vertex(triangle)) ++faces;
  const auto signed_of = [](std::size_t count) { return static_cast<std::int64_t>(count); };
  const std::int64_t euler = signed_of(report.vertices - report.unused_vertices) - signed_of(report.edges) + faces;
  return (2 * signed_of(report.components) - euler - signed_of(report.boundary_loops)) / 2;
}

}  // namespace

bool is_degenerate(const Mesh& mesh, FaceId face) {
  if (repeats_a_vertex(mesh.triangle(face))) return true;
  std::array<Eigen::Vector3d, 3> sides;
  for (std::size_t k = 0; k < 3; ++k) sides[k] = mesh.corner(face, (k + 1) % 3) - mesh.corner(face, k);
  double longest = 0;
  for (const Eigen::Vector3d& side : sides) longest = std::max(longest, side.stableNorm());
  if (!(longest > 0)) return true;
  constexpr double kFlat = 1e-12;
  return (sides[0] / longest).cross(sides[1] / longest).norm() <= kFlat;
}

Expected<MeshReport> analyse(const Mesh& mesh, const Task& task) {
  MeshReport report{.vertices = mesh.positions.size(), .faces = mesh.triangles.size()};
  constexpr double kSteps = 6;
  double step = 0;
  const auto go_on = [&] {
    task.report("analysing", step++ / kSteps);
    return !task.stopped();
  };
  if (!go_on()) return cancelled();
  const Adjacency adjacency(mesh);
  count_edges(adjacency, report);
  report.closed = report.boundary_edges == 0 && report.edges > 0;
  if (!go_on()) return cancelled();
  const Components components = find_components(mesh, adjacency, LinkedBy::Vertices);
  report.components = components.count;
  for (const double volume : signed_volumes(mesh, components)) report.volume += volume;
  if (!go_on()) return cancelled();
  report.boundary_loops = find_boundary_loops(mesh, adjacency).size();
  report.nonmanifold_vertices = find_pinched_vertices(mesh, adjacency).size();
  for (std::size_t i = 0; i < report.vertices; ++i)
    if (adjacency.faces(VertexId(i)).empty()) ++report.unused_vertices;
  if (!go_on()) return cancelled();
  for (std::size_t i = 0; i < report.faces; ++i)
    if (is_degenerate(mesh, FaceId(i))) ++report.degenerate_faces;
  report.duplicate_faces = count_duplicates(mesh);
  if (!go_on()) return cancelled();
  report.oriented = is_oriented(mesh, adjacency);
  report.genus = genus(mesh, adjacency, report);
  const auto inward = find_inward_faces(mesh, adjacency, task);
  if (!inward) return tl::unexpected(inward.error());
  report.inward_faces = static_cast<std::size_t>(std::count(inward->begin(), inward->end(), true));
  if (!go_on()) return cancelled();
  report.bbox_diagonal = bounding_box_diagonal(mesh);
  report.area = surface_area(mesh);
  return report;
}

Expected<void> validate(const Mesh& mesh) {
  constexpr std::size_t kMost = 0xFFFF'FFFE;
  const std::size_t vertices = mesh.positions.size();
  const std::size_t faces = mesh.triangles.size();
  if (vertices > kMost || faces > kMost) return fail("mesh: expected fewer than 2^32 - 1 vertices and faces");
  for (std::size_t i = 0; i < vertices; ++i)
    if (!mesh.positions[i].allFinite())
      return fail("mesh, vertex " + std::to_string(i) + ": expected finite coordinates");
  for (std::size_t i = 0; i < faces; ++i)
    for (const VertexId corner : mesh.triangles[i])
      if (corner.index() >= vertices)
        return fail("mesh, face " + std::to_string(i) + ": expected corners below " + std::to_string(vertices));
  if (!mesh.vertex_colours.empty() && mesh.vertex_colours.size() != vertices)
    return fail("mesh: expected a colour of every vertex, or none");
  if (!mesh.face_colours.empty() && mesh.face_colours.size() != faces)
    return fail("mesh: expected a colour of every face, or none");
  return {};
}

}  // namespace armature::sdk
