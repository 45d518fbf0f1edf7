#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include <armature/sdk/mesh/adjacency.h>

namespace armature::sdk {
namespace {

/// Turns counts, each one place to the right of its list, into the lists' starts.
void sum_up(std::vector<std::uint32_t>& counts) {
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
}

/// A face's side, kept with the smaller of its two vertices.
struct Side {
  VertexId larger;
  FaceId face;
  std::uint32_t corner = 0;
};

/// Sorts the sides at a vertex by edge; those of one edge stay in their order, that of faces.
void sort_by_edge(std::span<Side> sides) {
  constexpr std::size_t kFew = 16;  // that insertion sorts faster than merging
  if (sides.size() > kFew)
    return std::stable_sort(sides.begin(), sides.end(),
                            [](const Side& a, const Side& b) { return a.larger < b.larger; });
  for (std::size_t i = 1; i < sides.size(); ++i)
    for (std::size_t k = i; k > 0 && sides[k].larger < sides[k - 1].larger; --k) std::swap(sides[k], sides[k - 1]);
}

}  // namespace

Adjacency::Adjacency(const Mesh& mesh) {
  find_vertex_faces(mesh);
  find_edges(mesh);
  find_neighbours();
}

void Adjacency::find_vertex_faces(const Mesh& mesh) {
  auto& [starts, faces] = vertex_faces_;
  starts.assign(mesh.positions.size() + 1, 0);
  for (const Triangle& triangle : mesh.triangles)
    if (!repeats_a_vertex(triangle))
      for (const VertexId vertex : triangle) ++starts[vertex.index() + 1];
  sum_up(starts);
  faces.resize(starts.back());
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    if (!repeats_a_vertex(mesh.triangles[i]))
      for (const VertexId vertex : mesh.triangles[i]) faces[next[vertex.index()]++] = FaceId(i);
}

void Adjacency::find_edges(const Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  face_edges_.assign(mesh.triangles.size(), {});
  std::vector<std::uint32_t> starts(vertices + 1, 0);
  for (const Triangle& triangle : mesh.triangles)
    if (!repeats_a_vertex(triangle))
      for (std::size_t k = 0; k < 3; ++k) ++starts[std::min(triangle[k], triangle[(k + 1) % 3]).index() + 1];
  sum_up(starts);
  std::vector<Side> sides(starts.back());
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    if (repeats_a_vertex(triangle)) continue;
    for (std::uint32_t k = 0; k < 3; ++k) {
      const auto [smaller, larger] = std::minmax(triangle[k], triangle[(k + 1) % 3]);
      sides[next[smaller.index()]++] = {larger, FaceId(i), k};
    }
  }
  edge_faces_.elements.reserve(sides.size());
  edges_.reserve(sides.size() / 2 + 1);
  for (std::size_t v = 0; v < vertices; ++v) {
    const std::span<Side> here = std::span(sides).subspan(starts[v], starts[v + 1] - starts[v]);
    sort_by_edge(here);
    for (const Side& side : here) {
      const VertexPair ends = {VertexId(v), side.larger};
      if (edges_.empty() || edges_.back() != ends) {
        edges_.push_back(ends);
        edge_faces_.starts.push_back(static_cast<std::uint32_t>(edge_faces_.elements.size()));
      }
      edge_faces_.elements.push_back(side.face);
      face_edges_[side.face.index()][side.corner] = EdgeId(edges_.size() - 1);
    }
  }
  edge_faces_.starts.push_back(static_cast<std::uint32_t>(edge_faces_.elements.size()));
}

void Adjacency::find_neighbours() {
  std::vector<std::uint32_t>& starts = vertex_neighbours_.starts;
  std::vector<VertexId>& neighbours = vertex_neighbours_.elements;
  starts.assign(vertex_faces_.starts.size(), 0);
  for (const auto& [a, b] : edges_) {
    ++starts[a.index() + 1];
    ++starts[b.index() + 1];
  }
  sum_up(starts);
  neighbours.resize(starts.back());
  vertex_edges_.starts = starts;
  vertex_edges_.elements.resize(starts.back());
  std::vector<std::uint32_t> next(starts.begin(), starts.end() - 1);
  // The edges ascend, so the smaller neighbours of a vertex come first, ascending, if all edges that end at it are
  // filled in before those that begin at it.
  const auto put = [&](VertexId at, VertexId neighbour, std::size_t edge) {
    const std::uint32_t place = next[at.index()]++;
    neighbours[place] = neighbour;
    vertex_edges_.elements[place] = EdgeId(edge);
  };
  for (std::size_t i = 0; i < edges_.size(); ++i) put(edges_[i][1], edges_[i][0], i);
  for (std::size_t i = 0; i < edges_.size(); ++i) put(edges_[i][0], edges_[i][1], i);
}

bool walks_upwards(const Mesh& mesh, const Adjacency& adjacency, FaceId face, EdgeId edge) {
  const auto& edges = adjacency.edges(face);
  const auto k = static_cast<std::size_t>(std::find(edges.begin(), edges.end(), edge) - edges.begin());
  return mesh.triangle(face)[k] == adjacency.edge(edge)[0];
}

}  // namespace armature::sdk
