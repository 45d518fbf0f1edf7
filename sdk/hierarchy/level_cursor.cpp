#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

#include <armature/sdk/hierarchy/level_cursor.h>

namespace armature::sdk {
namespace {

constexpr std::uint32_t kNone = 0xFFFF'FFFFU;

bool within(const std::array<std::uint32_t, 2>& range, std::uint32_t place) noexcept {
  return place >= range[0] && place < range[1];
}

}  // namespace

LevelCursor::LevelCursor(const Hierarchy& hierarchy, std::size_t spheres)
    : hierarchy_(&hierarchy),
      first_wire_corner_(static_cast<Corner>(3 * hierarchy.parts().triangles.size())),
      place_(hierarchy.node_count(), kNone),
      corners_(hierarchy.parts().triangles.size()),
      ends_(hierarchy.parts().wire_edges.size()),
      head_(hierarchy.node_count(), kNone),
      next_(3 * hierarchy.parts().triangles.size() + 2 * hierarchy.parts().wire_edges.size(), kNone),
      wire_place_(hierarchy.parts().wire_edges.size(), kNone),
      wires_by_first_(hierarchy.parts().wire_edges.size()) {
  const auto& wires = hierarchy.parts().wire_edges;
  std::iota(wires_by_first_.begin(), wires_by_first_.end(), 0U);
  std::stable_sort(wires_by_first_.begin(), wires_by_first_.end(),
                   [&](std::uint32_t x, std::uint32_t y) { return wires[x].first < wires[y].first; });
  start(spheres);
}

void LevelCursor::start(std::size_t spheres) {
  for (const auto node : nodes_) {
    place_[node.index()] = kNone;
    head_[node.index()] = kNone;
  }
  for (const auto wire : wires_) wire_place_[wire] = kNone;
  wires_.clear();

  collapses_ = static_cast<std::uint32_t>(hierarchy_->leaf_count() - spheres);
  nodes_ = hierarchy_->nodes_of_level(spheres);
  for (std::uint32_t k = 0; k < nodes_.size(); ++k) place_[nodes_[k].index()] = k;
  const auto node_at = [&](std::uint32_t vertex) {
    const std::uint32_t place = hierarchy_->place(VertexId(vertex));
    // nodes_ are in the order of their ranges here.
    return *std::upper_bound(nodes_.begin(), nodes_.end(), place,
                             [&](std::uint32_t p, NodeId node) { return p < hierarchy_->range(node)[1]; });
  };
  const auto& parts = hierarchy_->parts();
  for (Corner corner = 0; corner < 3 * parts.lasting[collapses_]; ++corner) chain(corner, node_at(vertex_of(corner)));
  for (std::uint32_t wire = 0; wire < parts.wire_edges.size() && parts.wire_edges[wire].last > collapses_; ++wire) {
    if (parts.wire_edges[wire].first > collapses_) continue;
    add_wire(wire);
    for (const Corner corner : {wire_corner(wire), wire_corner(wire) + 1}) chain(corner, node_at(vertex_of(corner)));
  }
}

NodeId& LevelCursor::node_of(Corner corner) noexcept {
  if (is_triangle(corner)) return corners_[corner / 3][corner % 3];
  corner -= first_wire_corner_;
  return ends_[corner / 2][corner % 2];
}

std::uint32_t LevelCursor::vertex_of(Corner corner) const noexcept {
  if (is_triangle(corner)) return hierarchy_->parts().triangles[corner / 3][corner % 3];
  corner -= first_wire_corner_;
  return hierarchy_->parts().wire_edges[corner / 2].ends[corner % 2];
}

void LevelCursor::chain(Corner corner, NodeId node) {
  node_of(corner) = node;
  next_[corner] = head_[node.index()];
  head_[node.index()] = corner;
}

void LevelCursor::unchain(Corner corner) {
  Corner* link = &head_[node_of(corner).index()];
  while (*link != corner) link = &next_[*link];
  *link = next_[corner];
}

void LevelCursor::add_wire(std::uint32_t wire) {
  wire_place_[wire] = static_cast<std::uint32_t>(wires_.size());
  wires_.push_back(wire);
}

void LevelCursor::remove_wire(std::uint32_t wire) {
  const std::uint32_t place = wire_place_[wire];
  wires_[place] = wires_.back();
  wire_place_[wires_[place]] = place;
  wires_.pop_back();
  wire_place_[wire] = kNone;
}

void LevelCursor::put_node(NodeId node, std::uint32_t place) {
  nodes_[place] = node;
  place_[node.index()] = place;
}

void LevelCursor::gather_neighbours(NodeId node) {
  for (Corner corner = head_[node.index()]; corner != kNone; corner = next_[corner]) {
    if (is_triangle(corner))
      neighbours_.insert(neighbours_.end(), corners_[corner / 3].begin(), corners_[corner / 3].end());
    else
      for (const auto end : ends_[(corner - first_wire_corner_) / 2]) neighbours_.push_back(end);
  }
}

NodeId LevelCursor::node_with(std::uint32_t vertex) const noexcept {
  const std::uint32_t place = hierarchy_->place(VertexId(vertex));
  const auto found = std::find_if(neighbours_.begin(), neighbours_.end(),
                                  [&](NodeId node) { return within(hierarchy_->range(node), place); });
  if (found != neighbours_.end()) return *found;
  // Only in a file that somebody made up.
  const std::size_t made = hierarchy_->leaf_count() + collapses_;
  NodeId node(vertex);
  while (hierarchy_->parent(node).valid() && hierarchy_->parent(node).index() < made) node = hierarchy_->parent(node);
  return node;
}

void LevelCursor::insert(Corner first, Corner count) {
  for (Corner corner = first; corner < first + count; ++corner) chain(corner, node_with(vertex_of(corner)));
}

void LevelCursor::erase(Corner first, Corner count) {
  for (Corner corner = first; corner < first + count; ++corner) unchain(corner);
}

template <class Triangles, class Wires>
void LevelCursor::for_each_that_ends(std::uint32_t level, Triangles&& triangles, Wires&& wires) const {
  const auto& parts = hierarchy_->parts();
  for (std::uint32_t t = parts.lasting[level]; t < parts.lasting[level - 1]; ++t) triangles(3 * t);
  const auto& list = parts.wire_edges;
  auto wire = std::partition_point(list.begin(), list.end(), [&](const auto& w) { return w.last > level; });
  for (; wire != list.end() && wire->last == level; ++wire) wires(static_cast<std::uint32_t>(wire - list.begin()));
}

template <class Wires>
void LevelCursor::for_each_that_begins(std::uint32_t level, Wires&& wires) const {
  const auto& list = hierarchy_->parts().wire_edges;
  auto at = std::partition_point(wires_by_first_.begin(), wires_by_first_.end(),
                                 [&](std::uint32_t wire) { return list[wire].first < level; });
  for (; at != wires_by_first_.end() && list[*at].first == level; ++at) wires(*at);
}

bool LevelCursor::coarsen() {
  if (collapses_ == hierarchy_->collapse_count()) return false;
  const NodeId merged(hierarchy_->leaf_count() + collapses_);
  const auto [a, b] = hierarchy_->children(merged);
  const std::uint32_t level = ++collapses_;
  // What begins lies between the new sphere and one that was beside its children.
  neighbours_.assign(1, merged);
  gather_neighbours(a);
  gather_neighbours(b);

  for_each_that_ends(
      level, [&](Corner first) { erase(first, 3); },
      [&](std::uint32_t wire) {
        erase(wire_corner(wire), 2);
        remove_wire(wire);
      });
  for (const NodeId child : {a, b}) {
    for (Corner corner = std::exchange(head_[child.index()], kNone); corner != kNone;) {
      const Corner next = next_[corner];
      chain(corner, merged);
      corner = next;
    }
  }
  for_each_that_begins(level, [&](std::uint32_t wire) {
    insert(wire_corner(wire), 2);
    add_wire(wire);
  });

  put_node(merged, place_[a.index()]);
  const std::uint32_t free = place_[b.index()];
  put_node(nodes_.back(), free);
  nodes_.pop_back();
  return true;
}

bool LevelCursor::refine() {
  if (collapses_ == 0) return false;
  const std::uint32_t level = collapses_--;
  const NodeId merged(hierarchy_->leaf_count() + collapses_);
  const auto [a, b] = hierarchy_->children(merged);
  neighbours_ = {a, b};
  gather_neighbours(merged);

  for_each_that_begins(level, [&](std::uint32_t wire) {
    erase(wire_corner(wire), 2);
    remove_wire(wire);
  });
  for (Corner corner = std::exchange(head_[merged.index()], kNone); corner != kNone;) {
    const Corner next = next_[corner];
    const bool in_a = within(hierarchy_->range(a), hierarchy_->place(VertexId(vertex_of(corner))));
    chain(corner, in_a ? a : b);
    corner = next;
  }
  for_each_that_ends(
      level, [&](Corner first) { insert(first, 3); },
      [&](std::uint32_t wire) {
        insert(wire_corner(wire), 2);
        add_wire(wire);
      });

  put_node(a, place_[merged.index()]);
  nodes_.push_back(b);
  place_[b.index()] = static_cast<std::uint32_t>(nodes_.size() - 1);
  return true;
}

bool LevelCursor::coarsen_step() {
  const std::size_t done = hierarchy_->steps_to(size());
  const bool ended = size() == hierarchy_->spheres_after(done);
  if (ended && done == hierarchy_->step_count()) return false;
  go_to(hierarchy_->spheres_after(ended ? done + 1 : done));
  return true;
}

bool LevelCursor::refine_step() {
  const std::size_t done = hierarchy_->steps_to(size());
  if (done == 0) return false;
  go_to(hierarchy_->spheres_after(done - 1));
  return true;
}

void LevelCursor::go_to(std::size_t spheres) {
  // A level begun anew costs about what as many steps do as it has spheres.
  const std::size_t steps = spheres > size() ? spheres - size() : size() - spheres;
  if (steps > 2 * spheres) return start(spheres);
  while (size() > spheres && coarsen()) {
  }
  while (size() < spheres && refine()) {
  }
}

SphereMesh LevelCursor::sphere_mesh() const {
  SphereMesh mesh;
  mesh.spheres.reserve(nodes_.size());
  for (const auto node : nodes_) mesh.spheres.push_back(hierarchy_->sphere(node));
  const auto sphere_of = [&](NodeId node) { return SphereId(place_[node.index()]); };
  mesh.triangles.reserve(triangles().size());
  for (const auto& [a, b, c] : triangles()) mesh.triangles.push_back({sphere_of(a), sphere_of(b), sphere_of(c)});
  mesh.edges.reserve(wires_.size());
  for (const auto wire : wires_) mesh.edges.push_back({sphere_of(ends_[wire][0]), sphere_of(ends_[wire][1])});
  for (auto& triple : mesh.triangles) std::sort(triple.begin(), triple.end());
  for (auto& pair : mesh.edges) std::sort(pair.begin(), pair.end());
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
  std::sort(mesh.edges.begin(), mesh.edges.end());
  return mesh;
}

}  // namespace armature::sdk
