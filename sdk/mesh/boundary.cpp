#include <algorithm>
#include <span>

#include <armature/sdk/mesh/boundary.h>

namespace armature::sdk {
namespace {

VertexId other_end(const VertexPair& edge, VertexId vertex) {
  return edge[0] == vertex ? edge[1] : edge[0];
}

/// The edge of a face that meets `edge` at `vertex`.
EdgeId other_edge(const Adjacency& adjacency, FaceId face, EdgeId edge, VertexId vertex) {
  for (const EdgeId candidate : adjacency.edges(face)) {
    const VertexPair& ends = adjacency.edge(candidate);
    if (candidate != edge && (ends[0] == vertex || ends[1] == vertex)) return candidate;
  }
  return {};
}

/// From a boundary edge around its end `vertex`, face after face: the boundary edge, or the edge of three or more
/// faces, at which the fan ends.
EdgeId across_fan(const Adjacency& adjacency, EdgeId edge, VertexId vertex) {
  FaceId face = adjacency.faces(edge)[0];
  for (;;) {
    edge = other_edge(adjacency, face, edge, vertex);
    const auto faces = adjacency.faces(edge);
    if (faces.size() != 2) return edge;
    face = faces[0] == face ? faces[1] : faces[0];
  }
}

}  // namespace

std::vector<BoundaryLoop> find_boundary_loops(const Mesh& mesh, const Adjacency& adjacency) {
  std::vector<BoundaryLoop> loops;
  std::vector<bool> walked(adjacency.edge_count(), false);
  // Goes on from the end `at` of a walked edge; appends the vertices passed. False where an edge of many faces is met.
  const auto walk = [&](EdgeId edge, VertexId at, std::vector<VertexId>& out) {
    for (;;) {
      edge = across_fan(adjacency, edge, at);
      if (adjacency.faces(edge).size() != 1) return false;
      if (walked[edge.index()]) return true;
      walked[edge.index()] = true;
      at = other_end(adjacency.edge(edge), at);
      out.push_back(at);
    }
  };
  for (std::size_t i = 0; i < adjacency.edge_count(); ++i) {
    const EdgeId first(i);
    if (walked[i] || adjacency.faces(first).size() != 1) continue;
    walked[i] = true;
    VertexPair ends = adjacency.edge(first);
    if (!walks_upwards(mesh, adjacency, adjacency.faces(first)[0], first)) std::swap(ends[0], ends[1]);
    BoundaryLoop& loop = loops.emplace_back();
    loop.vertices = {ends[0], ends[1]};
    loop.closed = walk(first, ends[1], loop.vertices);
    if (loop.closed) {
      loop.vertices.pop_back();  // back at the first vertex
    } else {
      std::vector<VertexId> before;
      (void)walk(first, ends[0], before);
      loop.vertices.insert(loop.vertices.begin(), before.rbegin(), before.rend());
    }
  }
  return loops;
}

std::vector<VertexId> find_pinched_vertices(const Mesh& mesh, const Adjacency& adjacency) {
  std::vector<VertexId> pinched;
  std::vector<bool> reached(mesh.triangles.size(), false);
  std::vector<FaceId> open;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const auto faces = adjacency.faces(VertexId(i));
    if (faces.size() < 2) continue;
    open.assign(1, faces[0]);
    reached[faces[0].index()] = true;
    std::size_t count = 0;
    while (!open.empty()) {
      const FaceId face = open.back();
      open.pop_back();
      ++count;
      for (const EdgeId edge : adjacency.edges(face)) {
        const VertexPair& ends = adjacency.edge(edge);
        if (ends[0] != VertexId(i) && ends[1] != VertexId(i)) continue;
        for (const FaceId next : adjacency.faces(edge)) {
          if (reached[next.index()]) continue;
          reached[next.index()] = true;
          open.push_back(next);
        }
      }
    }
    for (const FaceId face : faces) reached[face.index()] = false;
    if (count < faces.size()) pinched.emplace_back(i);
  }
  return pinched;
}

}  // namespace armature::sdk
