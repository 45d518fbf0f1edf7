#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::sdk {

using NodeId = Id<struct NodeTag>;  ///< a sphere of a hierarchy

/// Every level of a sphere-mesh at once, from a sphere for each input vertex down to the last (thesis, section 4.6.4;
/// De Floriani, Magillo, Puppo, Sobrero 2004). The nodes are binary trees: node i below `leaf_count()` is input vertex
/// i, and node `leaf_count() + k` is the sphere that the k-th collapse made of its two children. Level k is what is
/// there after k collapses. Its triangles and wire edges are images of the input's: of each is kept up to which level
/// it lasts (and a wire edge, from which on), so a level costs what it holds. About 100 bytes an input vertex.
///
/// Immutable; any number of threads may read it.
class Hierarchy {
 public:
  /// A triangle of the input, by its input vertices.
  using Triangle = std::array<std::uint32_t, 3>;
  /// An edge on no triangle, present at levels first <= k < last.
  struct WireEdge {
    std::array<std::uint32_t, 2> ends;  ///< input vertices
    std::uint32_t first;                ///< level
    std::uint32_t last;                 ///< level
    friend bool operator==(const WireEdge&, const WireEdge&) = default;
  };
  /// A centre and a radius in units of the model, about its middle: 6e-8 of its size is all a float loses there.
  using PackedSphere = std::array<float, 4>;
  /// An input vertex that has a sphere of its own from the finest level on.
  struct Pinned {
    std::uint32_t vertex;  ///< of the input
    PackedSphere sphere;   ///< instead of the vertex
    friend bool operator==(const Pinned&, const Pinned&) = default;
  };

  /// What a hierarchy is made of; also what its file holds.
  struct Parts {
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();    ///< in the model's coordinates
    double scale = 1;                                    ///< lengths of the model to a unit; positive
    std::vector<std::array<float, 3>> leaves;            ///< centres by input vertex; their radius is 0 unless pinned
    std::vector<Pinned> pinned;                          ///< vertices ascending
    std::vector<PackedSphere> spheres;                   ///< by collapse
    std::vector<std::array<std::uint32_t, 2>> children;  ///< nodes by collapse, each made earlier, each used once
    std::vector<Triangle> triangles;                     ///< those that last longest first
    std::vector<std::uint32_t> lasting;  ///< by level: how many triangles it has; collapses + 1 entries, descending
    std::vector<WireEdge> wire_edges;    ///< those that last longest first
    /// Where collapses are done together (`build_similar_hierarchy()`): how many are done at the end of each step,
    /// ascending to all of them. Empty: every collapse is a step.
    std::vector<std::uint32_t> steps = {};
  };

  Hierarchy() = default;
  /// Checks every part and every relation between them; fails with what is wrong.
  [[nodiscard]] static Expected<Hierarchy> assemble(Parts parts);

  /// Input vertices.
  [[nodiscard]] std::size_t leaf_count() const noexcept { return parts_.leaves.size(); }
  /// How many spheres were made by joining two.
  [[nodiscard]] std::size_t collapse_count() const noexcept { return parts_.children.size(); }
  /// Spheres of all levels together.
  [[nodiscard]] std::size_t node_count() const noexcept { return leaf_count() + collapse_count(); }
  /// Spheres of the coarsest level.
  [[nodiscard]] std::size_t min_spheres() const noexcept { return leaf_count() - collapse_count(); }

  /// How many steps lead from the finest level to the coarsest: as many as collapses, fewer where these are done
  /// together.
  [[nodiscard]] std::size_t step_count() const noexcept {
    return parts_.steps.empty() ? collapse_count() : parts_.steps.size();
  }
  /// Spheres of the level after so many steps, up to `step_count()`; 0 is the finest.
  [[nodiscard]] std::size_t spheres_after(std::size_t steps) const noexcept {
    if (steps == 0) return leaf_count();
    return leaf_count() - (parts_.steps.empty() ? steps : parts_.steps[steps - 1]);
  }
  /// How many steps are done, at least in part, at the level with so many spheres.
  [[nodiscard]] std::size_t steps_to(std::size_t spheres) const noexcept;

  /// Whether the node is an input vertex.
  [[nodiscard]] bool is_leaf(NodeId node) const noexcept { return node.index() < leaf_count(); }
  /// In the model's coordinates.
  [[nodiscard]] Sphere sphere(NodeId node) const noexcept;
  /// The two nodes that a collapse joined; not of a leaf.
  [[nodiscard]] std::array<NodeId, 2> children(NodeId node) const noexcept;
  /// Not valid for a root.
  [[nodiscard]] NodeId parent(NodeId node) const noexcept { return parents_[node.index()]; }
  /// The input vertices that a sphere stands for.
  [[nodiscard]] std::span<const VertexId> vertices(NodeId node) const noexcept {
    const auto [begin, end] = ranges_[node.index()];
    return {leaf_order_.data() + begin, end - begin};
  }
  /// The same as places [begin, end) in the order of the leaves: nodes nest as their ranges do.
  [[nodiscard]] std::array<std::uint32_t, 2> range(NodeId node) const noexcept { return ranges_[node.index()]; }
  /// Where an input vertex stands in that order.
  [[nodiscard]] std::uint32_t place(VertexId vertex) const noexcept { return ranges_[vertex.index()][0]; }

  /// The nodes of the level with so many spheres, in the order of their ranges: sphere i of `level()` is node i here.
  /// `spheres` lies in [min_spheres(), leaf_count()]. Costs what the level holds.
  [[nodiscard]] std::vector<NodeId> nodes_of_level(std::size_t spheres) const;
  /// The sphere-mesh with so many spheres, or why there is none.
  [[nodiscard]] Expected<SphereMesh> level(std::size_t spheres) const;
  /// The sphere-mesh of any nodes of which none lies above another: its simplices are the images of the input's, as far
  /// as they lie below these nodes. Sphere i is node i. Costs what the whole hierarchy holds.
  [[nodiscard]] SphereMesh cut(std::span<const NodeId> nodes) const;

  /// What it is made of.
  [[nodiscard]] const Parts& parts() const noexcept { return parts_; }

 private:
  void index_tree();

  Parts parts_;
  std::vector<NodeId> parents_;                       // by node
  std::vector<std::array<std::uint32_t, 2>> ranges_;  // by node
  std::vector<VertexId> leaf_order_;
  std::vector<NodeId> roots_;  // in the order of their ranges
};

}  // namespace armature::sdk
