#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// Two vertices joined by a face, the smaller id first.
using VertexPair = std::array<VertexId, 2>;

/// The two in order.
[[nodiscard]] constexpr VertexPair vertex_pair(VertexId a, VertexId b) noexcept {
  return a < b ? VertexPair{a, b} : VertexPair{b, a};
}

/// Which elements of a mesh touch which, in compact arrays. Any number of faces may share an edge. A face that names a
/// vertex twice has no three edges and is left out: no element knows it. Built in time linear in the mesh (but for the
/// sorting of neighbours), immutable, thread-safe to read. Refers to ids alone: it stays valid while the triangles do.
class Adjacency {
 public:
  /// Of no mesh at all.
  Adjacency() = default;
  /// Every corner of the mesh must name one of its positions.
  explicit Adjacency(const Mesh& mesh);

  /// The faces at a vertex, ascending.
  [[nodiscard]] std::span<const FaceId> faces(VertexId vertex) const noexcept {
    return vertex_faces_.of(vertex.index());
  }
  /// The vertices that share an edge with a vertex, ascending.
  [[nodiscard]] std::span<const VertexId> neighbours(VertexId vertex) const noexcept {
    return vertex_neighbours_.of(vertex.index());
  }
  /// The edges at a vertex, in the order of `neighbours()`.
  [[nodiscard]] std::span<const EdgeId> edges(VertexId vertex) const noexcept {
    return vertex_edges_.of(vertex.index());
  }

  /// All edges by EdgeId, ascending.
  [[nodiscard]] std::span<const VertexPair> edges() const noexcept { return edges_; }
  /// The ends of an edge.
  [[nodiscard]] const VertexPair& edge(EdgeId edge) const noexcept { return edges_[edge.index()]; }
  /// The faces at an edge, ascending: one on a boundary, two within a manifold, more elsewhere.
  [[nodiscard]] std::span<const FaceId> faces(EdgeId edge) const noexcept { return edge_faces_.of(edge.index()); }
  /// The edges of a face, that from corner k to corner k + 1 at place k; none of them valid for a face left out.
  [[nodiscard]] const std::array<EdgeId, 3>& edges(FaceId face) const noexcept { return face_edges_[face.index()]; }

  [[nodiscard]] std::size_t vertex_count() const noexcept { return vertex_faces_.size(); }  ///< of the mesh
  [[nodiscard]] std::size_t edge_count() const noexcept { return edges_.size(); }           ///< of the mesh

 private:
  /// Lists of ids, one behind the other: list i lies between starts[i] and starts[i + 1].
  template <class Element>
  struct Lists {
    std::vector<std::uint32_t> starts;
    std::vector<Element> elements;

    [[nodiscard]] std::size_t size() const noexcept { return starts.empty() ? 0 : starts.size() - 1; }
    [[nodiscard]] std::span<const Element> of(std::size_t i) const noexcept {
      return std::span(elements).subspan(starts[i], starts[i + 1] - starts[i]);
    }
  };

  void find_vertex_faces(const Mesh& mesh);
  void find_edges(const Mesh& mesh);
  void find_neighbours();

  Lists<FaceId> vertex_faces_;
  Lists<VertexId> vertex_neighbours_;
  Lists<EdgeId> vertex_edges_;
  std::vector<VertexPair> edges_;
  Lists<FaceId> edge_faces_;
  std::vector<std::array<EdgeId, 3>> face_edges_;
};

/// Whether a face walks one of its edges from the smaller vertex to the larger one.
[[nodiscard]] bool walks_upwards(const Mesh& mesh, const Adjacency& adjacency, FaceId face, EdgeId edge);

/// Whether a face names a vertex twice.
[[nodiscard]] constexpr bool repeats_a_vertex(const Triangle& triangle) noexcept {
  return triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
}

}  // namespace armature::sdk
