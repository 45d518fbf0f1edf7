#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <armature/sdk/hierarchy/hierarchy.h>

namespace armature::sdk {

/// One level of a hierarchy at a time, from which the neighbouring ones are reached in time proportional to what
/// changes: the simplices about one sphere. Spans are valid until the level changes. The hierarchy must outlive it.
/// Not thread-safe.
class LevelCursor {
 public:
  /// Stands at the level with so many spheres, which the hierarchy must have.
  LevelCursor(const Hierarchy& hierarchy, std::size_t spheres);

  /// Spheres of the level.
  [[nodiscard]] std::size_t size() const noexcept { return nodes_.size(); }
  /// One sphere less; false, and nothing, at the coarsest level.
  bool coarsen();
  /// One sphere more; false, and nothing, at the finest level.
  bool refine();
  /// To the end of the next step, all of whose collapses are done together; false, and nothing, at the coarsest level.
  /// The same as `coarsen()` where no collapses are done together.
  bool coarsen_step();
  /// Back to where the last step began; false, and nothing, at the finest level.
  bool refine_step();
  /// To the level with so many spheres, which the hierarchy must have: step by step, or anew where that is shorter.
  void go_to(std::size_t spheres);

  /// The level's spheres, in no order.
  [[nodiscard]] std::span<const NodeId> nodes() const noexcept { return nodes_; }
  /// Its triangles, each with the orientation of the input triangle that it is the image of.
  [[nodiscard]] std::span<const std::array<NodeId, 3>> triangles() const noexcept {
    return {corners_.data(), hierarchy_->parts().lasting[collapses_]};
  }
  /// How many edges are on no triangle.
  [[nodiscard]] std::size_t edge_count() const noexcept { return wires_.size(); }
  /// One of them.
  [[nodiscard]] const std::array<NodeId, 2>& edge(std::size_t k) const noexcept { return ends_[wires_[k]]; }

  /// The level as a sphere-mesh of its own; costs what it holds. Sphere i is node `nodes()[i]`.
  [[nodiscard]] SphereMesh sphere_mesh() const;

 private:
  // A simplex's corner: 3 t + k of triangle t, then 3 T + 2 w + k of wire edge w. The corners at one node are chained.
  using Corner = std::uint32_t;

  void start(std::size_t spheres);
  [[nodiscard]] bool is_triangle(Corner corner) const noexcept { return corner < first_wire_corner_; }
  [[nodiscard]] NodeId& node_of(Corner corner) noexcept;
  [[nodiscard]] std::uint32_t vertex_of(Corner corner) const noexcept;
  [[nodiscard]] Corner wire_corner(std::uint32_t wire) const noexcept { return first_wire_corner_ + 2 * wire; }
  void chain(Corner corner, NodeId node);
  void unchain(Corner corner);
  void insert(Corner first, Corner count);
  void erase(Corner first, Corner count);
  template <class Triangles, class Wires>
  void for_each_that_ends(std::uint32_t level, Triangles&& triangles, Wires&& wires) const;
  template <class Wires>
  void for_each_that_begins(std::uint32_t level, Wires&& wires) const;
  void add_wire(std::uint32_t wire);
  void remove_wire(std::uint32_t wire);
  [[nodiscard]] NodeId node_with(std::uint32_t vertex) const noexcept;
  void gather_neighbours(NodeId node);
  void put_node(NodeId node, std::uint32_t place);

  const Hierarchy* hierarchy_;
  std::uint32_t collapses_ = 0;  // the level
  Corner first_wire_corner_ = 0;
  std::vector<NodeId> nodes_;
  std::vector<std::uint32_t> place_;            // by node: where in nodes_
  std::vector<std::array<NodeId, 3>> corners_;  // by triangle; of those that ended, as they were last
  std::vector<std::array<NodeId, 2>> ends_;     // by wire edge; likewise
  std::vector<Corner> head_;                    // by node
  std::vector<Corner> next_;                    // by corner
  std::vector<std::uint32_t> wires_;            // those of the level
  std::vector<std::uint32_t> wire_place_;       // by wire edge: where in wires_
  std::vector<std::uint32_t> wires_by_first_;   // by ascending first level
  std::vector<NodeId> neighbours_;              // what a step looks ends up in
};

}  // namespace armature::sdk
