#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include <armature/sdk/hierarchy/hierarchy.h>

namespace armature::sdk {
namespace {

/// Collects the simplices of a sphere-mesh, which may come in any order and more than once.
class SimplexCollector {
 public:
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a == b && b == c) return;
    if (a == b || b == c || c == a) return add_edge(std::min({a, b, c}), std::max({a, b, c}));
    std::array<std::uint32_t, 3> corners{a, b, c};
    std::sort(corners.begin(), corners.end());
    triangles_.push_back(corners);
  }
  void add_edge(std::uint32_t a, std::uint32_t b) {
    if (a != b) edges_.push_back({std::min(a, b), std::max(a, b)});
  }

  /// Wire edges alone are kept.
  void finish(SphereMesh& mesh) {
    const auto make_unique = [](auto& list) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    make_unique(triangles_);
    make_unique(edges_);
    if (!edges_.empty()) {
      std::vector<std::array<std::uint32_t, 2>> sides;
      sides.reserve(3 * triangles_.size());
      for (const auto& [a, b, c] : triangles_) sides.insert(sides.end(), {{a, b}, {b, c}, {a, c}});
      make_unique(sides);
      std::vector<std::array<std::uint32_t, 2>> wire;
      std::set_difference(edges_.begin(), edges_.end(), sides.begin(), sides.end(), std::back_inserter(wire));
      edges_ = std::move(wire);
    }
    mesh.triangles.reserve(triangles_.size());
    for (const auto& [a, b, c] : triangles_) mesh.triangles.push_back({SphereId(a), SphereId(b), SphereId(c)});
    mesh.edges.reserve(edges_.size());
    for (const auto& [a, b] : edges_) mesh.edges.push_back({SphereId(a), SphereId(b)});
  }

 private:
  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<std::array<std::uint32_t, 2>> edges_;
};

bool finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

/// What is wrong with the parts, or nothing.
std::string fault(const Hierarchy::Parts& parts) {
  const std::size_t leaves = parts.leaves.size();
  const std::size_t collapses = parts.children.size();
  const auto at = [](const char* what, std::size_t index) { return std::string(what) + " " + std::to_string(index); };
  if (leaves == 0 || leaves > 0x7FFF'FFFFU) return "expected 1 to 2^31 - 1 vertices, found " + std::to_string(leaves);
  if (!parts.origin.allFinite() || !std::isfinite(parts.scale) || !(parts.scale > 0))
    return "expected a finite origin and a positive scale";
  if (collapses >= leaves) return "expected fewer collapses than vertices, found " + std::to_string(collapses);
  if (parts.spheres.size() != collapses || parts.lasting.size() != collapses + 1)
    return "expected a sphere and a count of triangles for every collapse";
  for (std::size_t k = 0; k < parts.steps.size(); ++k)
    if (parts.steps[k] <= (k == 0 ? 0 : parts.steps[k - 1])) return at("step", k) + ": expected one collapse or more";
  if (!parts.steps.empty() && parts.steps.back() != collapses)
    return "expected steps that end with the last collapse, " + std::to_string(collapses);
  for (std::size_t k = 0; k < leaves; ++k)
    if (!finite(parts.leaves[k])) return at("vertex", k) + " is not finite";
  for (std::size_t k = 0; k < parts.pinned.size(); ++k) {
    const auto& [vertex, sphere] = parts.pinned[k];
    if (vertex >= leaves || (k > 0 && vertex <= parts.pinned[k - 1].vertex))
      return at("pinned sphere", k) + ": expected vertices in ascending order";
    if (!finite(sphere) || sphere[3] < 0)
      return at("pinned sphere", k) + ": expected finite numbers and a radius that is not negative";
  }
  std::vector<bool> used(leaves + collapses, false);
  for (std::size_t k = 0; k < collapses; ++k) {
    if (!finite(parts.spheres[k]) || parts.spheres[k][3] < 0)
      return at("sphere", k) + ": expected finite numbers and a radius that is not negative";
    for (const auto child : parts.children[k]) {
      if (child >= leaves + k || used[child])
        return at("collapse", k) + ": expected two nodes made before it that no other collapse joins";
      used[child] = true;
    }
  }
  for (std::size_t k = 0; k <= collapses; ++k)
    if (parts.lasting[k] > (k == 0 ? parts.triangles.size() : parts.lasting[k - 1]))
      return at("level", k) + " has more triangles than the one before";
  for (std::size_t k = 0; k < parts.triangles.size(); ++k)
    for (const auto corner : parts.triangles[k])
      if (corner >= leaves) return at("triangle", k) + ": corner out of range";
  for (std::size_t k = 0; k < parts.wire_edges.size(); ++k) {
    const auto& wire = parts.wire_edges[k];
    if (wire.ends[0] >= leaves || wire.ends[1] >= leaves) return at("wire edge", k) + ": end out of range";
    if (wire.first >= wire.last || wire.last > collapses + 1 || (k > 0 && wire.last > parts.wire_edges[k - 1].last))
      return at("wire edge", k) + ": levels out of order";
  }
  return {};
}

}  // namespace

Expected<Hierarchy> Hierarchy::assemble(Parts parts) {
  if (auto wrong = fault(parts); !wrong.empty()) return fail(wrong);
  Hierarchy hierarchy;
  hierarchy.parts_ = std::move(parts);
  hierarchy.index_tree();
  return hierarchy;
}

void Hierarchy::index_tree() {
  const auto leaves = static_cast<std::uint32_t>(leaf_count());
  parents_.assign(node_count(), NodeId());
  // Sizes upward, then places downward; children always come before their parent.
  ranges_.assign(node_count(), {0, 1});
  for (std::size_t k = 0; k < collapse_count(); ++k) {
    const auto [a, b] = parts_.children[k];
    ranges_[leaves + k][1] = ranges_[a][1] + ranges_[b][1];
    parents_[a] = parents_[b] = NodeId(leaves + k);
  }
  std::uint32_t next = 0;
  for (std::size_t node = node_count(); node-- > 0;) {
    auto& [begin, end] = ranges_[node];
    if (!parents_[node].valid()) {
      roots_.emplace_back(node);
      begin = next;
      next += end;
    }
    if (node >= leaves) {
      const auto [a, b] = parts_.children[node - leaves];
      ranges_[a][0] = begin;
      ranges_[b][0] = begin + ranges_[a][1];
    }
    end += begin;
  }
  leaf_order_.resize(leaves);
  for (std::uint32_t leaf = 0; leaf < leaves; ++leaf) leaf_order_[ranges_[leaf][0]] = VertexId(leaf);
}

Sphere Hierarchy::sphere(NodeId node) const noexcept {
  const auto place_in_model = [&](float x, float y, float z) {
    return Eigen::Vector3d(parts_.origin + parts_.scale * Eigen::Vector3d(x, y, z));
  };
  const auto unpacked = [&](const PackedSphere& packed) {
    const auto& [x, y, z, r] = packed;
    return Sphere{place_in_model(x, y, z), parts_.scale * static_cast<double>(r)};
  };
  if (!is_leaf(node)) return unpacked(parts_.spheres[node.index() - leaf_count()]);
  const auto pin = std::ranges::lower_bound(parts_.pinned, node.index(), {}, &Pinned::vertex);
  if (pin != parts_.pinned.end() && pin->vertex == node.index()) return unpacked(pin->sphere);
  const auto& [x, y, z] = parts_.leaves[node.index()];
  return {place_in_model(x, y, z), 0};
}

std::array<NodeId, 2> Hierarchy::children(NodeId node) const noexcept {
  assert(!is_leaf(node));
  const auto [a, b] = parts_.children[node.index() - leaf_count()];
  return {NodeId(a), NodeId(b)};
}

std::size_t Hierarchy::steps_to(std::size_t spheres) const noexcept {
  const std::size_t collapses = leaf_count() - spheres;
  if (parts_.steps.empty() || collapses == 0) return collapses;
  return static_cast<std::size_t>(std::ranges::lower_bound(parts_.steps, collapses) - parts_.steps.begin()) + 1;
}

std::vector<NodeId> Hierarchy::nodes_of_level(std::size_t spheres) const {
  assert(spheres >= min_spheres() && spheres <= leaf_count());
  const std::size_t made = leaf_count() + (leaf_count() - spheres);  // nodes of this level are below
  std::vector<NodeId> nodes;
  nodes.reserve(spheres);
  std::vector<NodeId> pending(roots_.rbegin(), roots_.rend());
  while (!pending.empty()) {
    const NodeId node = pending.back();
    pending.pop_back();
    if (node.index() < made) {
      nodes.push_back(node);
      continue;
    }
    const auto [a, b] = children(node);
    pending.push_back(b);
    pending.push_back(a);
  }
  return nodes;
}

Expected<SphereMesh> Hierarchy::level(std::size_t spheres) const {
  if (spheres < min_spheres() || spheres > leaf_count())
    return fail("expected " + std::to_string(min_spheres()) + " to " + std::to_string(leaf_count()) +
                " spheres, found " + std::to_string(spheres));
  const std::size_t collapses = leaf_count() - spheres;
  const auto nodes = nodes_of_level(spheres);
  SphereMesh mesh;
  mesh.spheres.reserve(nodes.size());
  for (const auto node : nodes) mesh.spheres.push_back(sphere(node));

  const auto sphere_at = [&](std::uint32_t vertex) {
    const auto found = std::upper_bound(nodes.begin(), nodes.end(), ranges_[vertex][0],
                                        [&](std::uint32_t place, NodeId node) { return place < range(node)[1]; });
    return static_cast<std::uint32_t>(found - nodes.begin());
  };
  SimplexCollector simplices;
  for (std::size_t t = 0; t < parts_.lasting[collapses]; ++t) {
    const auto& [a, b, c] = parts_.triangles[t];
    simplices.add(sphere_at(a), sphere_at(b), sphere_at(c));
  }
  for (const auto& wire : parts_.wire_edges) {
    if (wire.last <= collapses) break;
    if (wire.first <= collapses) simplices.add_edge(sphere_at(wire.ends[0]), sphere_at(wire.ends[1]));
  }
  simplices.finish(mesh);
  return mesh;
}

SphereMesh Hierarchy::cut(std::span<const NodeId> nodes) const {
  constexpr std::uint32_t kNobody = 0xFFFF'FFFFU;
  SphereMesh mesh;
  std::vector<std::uint32_t> sphere_at(leaf_count(), kNobody);  // by place
  for (const auto node : nodes) {
    const auto [begin, end] = range(node);
    assert(std::all_of(sphere_at.begin() + begin, sphere_at.begin() + end, [](auto id) { return id == kNobody; }));
    std::fill(sphere_at.begin() + begin, sphere_at.begin() + end, static_cast<std::uint32_t>(mesh.spheres.size()));
    mesh.spheres.push_back(sphere(node));
  }
  const auto image = [&](std::uint32_t vertex) { return sphere_at[ranges_[vertex][0]]; };
  SimplexCollector simplices;
  for (const auto& triangle : parts_.triangles) {
    const std::uint32_t a = image(triangle[0]), b = image(triangle[1]), c = image(triangle[2]);
    if (a != kNobody && b != kNobody && c != kNobody) {
      simplices.add(a, b, c);
      continue;
    }
    for (const auto& [x, y] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      if (x != kNobody && y != kNobody) simplices.add_edge(x, y);
  }
  for (const auto& wire : parts_.wire_edges) {
    const std::uint32_t a = image(wire.ends[0]), b = image(wire.ends[1]);
    if (wire.first == 0 && a != kNobody && b != kNobody) simplices.add_edge(a, b);
  }
  simplices.finish(mesh);
  return mesh;
}

}  // namespace armature::sdk
