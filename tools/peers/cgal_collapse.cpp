// CGAL's edge collapse, to its end. A program of its own: these parts of CGAL are GPL, and the product links none of
// them.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>

#include "tools/peers/peer.h"

namespace {

namespace simplification = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

SurfaceMesh surface_of(const armature::sdk::Mesh& mesh) {
  SurfaceMesh surface;
  for (const auto& p : mesh.positions) surface.add_vertex({p.x(), p.y(), p.z()});
  const auto vertex = [](armature::sdk::VertexId id) {
    return SurfaceMesh::Vertex_index(static_cast<unsigned>(id.index()));
  };
  for (const auto& t : mesh.triangles) surface.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2]));
  return surface;
}

}  // namespace

int main(int argc, char** argv) {
  const armature::sdk::Mesh mesh = armature::peers::mesh_of_command_line(argc, argv);
  const simplification::Count_stop_predicate<SurfaceMesh> to_the_end(1);

  // What edge_collapse() returns counts edges, three or so a collapse.
  const auto removed = [&](const SurfaceMesh& surface) { return mesh.positions.size() - surface.number_of_vertices(); };
  armature::peers::report("CGAL, Lindstrom-Turk", surface_of(mesh), [&](SurfaceMesh& surface) {
    simplification::edge_collapse(surface, to_the_end);
    return removed(surface);
  });
  armature::peers::report("CGAL, Garland-Heckbert", surface_of(mesh), [&](SurfaceMesh& surface) {
    using Policies = simplification::GarlandHeckbert_plane_policies<SurfaceMesh, Kernel>;
    const Policies policies(surface);
    simplification::edge_collapse(
        surface, to_the_end, CGAL::parameters::get_cost(policies.get_cost()).get_placement(policies.get_placement()));
    return removed(surface);
  });
  return 0;
}
