#include "sdk/hierarchy/collapse_complex.h"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <utility>

namespace armature::sdk {
namespace {

using Pair = CollapseComplex::Pair;
using Triangle = CollapseComplex::Triangle;

Pair sorted_pair(std::uint32_t a, std::uint32_t b) noexcept {
  return a < b ? Pair{a, b} : Pair{b, a};
}

bool degenerate(const Triangle& t) noexcept {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Every edge of the triangles once, in ascending order.
std::vector<Pair> edges_of_triangles(std::span<const Triangle> triangles) {
  std::vector<Pair> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (t[k] != t[(k + 1) % 3]) edges.push_back(sorted_pair(t[k], t[(k + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  edges.shrink_to_fit();
  return edges;
}

}  // namespace

std::string CollapseComplex::refuses(std::size_t vertices, std::size_t triangles) {
  if (vertices == 0) return "expected a mesh with vertices, found none";
  if (vertices >= std::size_t{1} << 31 || triangles > std::size_t{1} << 29)
    return "expected at most 2^31 - 1 vertices and 2^29 triangles, found " + std::to_string(vertices) + " and " +
           std::to_string(triangles);
  return {};
}

CollapseComplex::CollapseComplex(std::uint32_t vertices, std::span<const Triangle> triangles,
                                 std::span<const Pair> links)
    : triangles_(triangles.begin(), triangles.end()),
      deaths_(triangles.size(), kNoIndex),
      edge_to_(vertices, kNoIndex) {
  const std::vector<Pair> pairs = edges_of_triangles(triangles);
  edges_.reserve(pairs.size() + links.size());
  for (const Pair& pair : pairs) edges_.push_back({.ends = pair, .flags = Wire});

  std::vector<std::uint32_t> sizes(vertices, 0);
  for (const Triangle& t : triangles_)
    if (!degenerate(t))
      for (const auto corner : t) ++sizes[corner];
  triangle_stars_.allot(sizes);
  for (std::uint32_t id = 0; id < triangles_.size(); ++id) {
    const Triangle& t = triangles_[id];
    bool kept = !degenerate(t);
    if (kept) {
      const auto quietest = *std::min_element(t.begin(), t.end(), [&](std::uint32_t a, std::uint32_t b) {
        return triangle_stars_.of(a).size() < triangle_stars_.of(b).size();
      });
      for (const auto other : triangle_stars_.of(quietest))
        kept = kept && !(has_corner(other, t[0]) && has_corner(other, t[1]) && has_corner(other, t[2]));
    }
    if (!kept) {
      deaths_[id] = kNever;
      continue;
    }
    for (const auto corner : t) triangle_stars_.push(corner, id);
  }

  std::fill(sizes.begin(), sizes.end(), 0);
  for (const Edge& e : edges_)
    for (const auto end : e.ends) ++sizes[end];
  edge_stars_.allot(sizes);
  for (std::uint32_t id = 0; id < edges_.size(); ++id)
    for (const auto end : edges_[id].ends) edge_stars_.push(end, id);
  for (std::uint32_t id = 0; id < edges_.size(); ++id) {
    const auto [a, b] = edges_[id].ends;
    if (triangles_on(a, b) != 0)
      edges_[id].flags = 0;
    else
      wire_events_.push_back({0, id, a, b});
  }
  add_links(links);
}

std::size_t CollapseComplex::triangles_on(std::uint32_t a, std::uint32_t b) const noexcept {
  const auto star = triangle_stars_.of(a);
  return static_cast<std::size_t>(
      std::count_if(star.begin(), star.end(), [&](std::uint32_t t) { return has_corner(t, b); }));
}

CollapseComplex::Merged CollapseComplex::collapse(std::uint32_t edge) {
  assert(alive(edge));
  auto [kept, gone] = edges_[edge].ends;
  if (edge_stars_.of(gone).size() > edge_stars_.of(kept).size()) std::swap(kept, gone);

  for (const auto e : edge_stars_.of(kept)) edge_to_[other_end(e, kept)] = e;
  merge_triangles(kept, gone);
  merge_edges(edge, kept, gone);
  settle_wires(kept);
  ++steps_;
  return {kept, gone, edge_stars_.of(kept)};
}

void CollapseComplex::merge_triangles(std::uint32_t kept, std::uint32_t gone) {
  star_.clear();
  for (const auto t : triangle_stars_.of(kept)) {
    if (!has_corner(t, gone)) {
      star_.push_back(t);
      continue;
    }
    const Triangle& corners = triangles_[t];
    triangle_stars_.remove(corners[0] ^ corners[1] ^ corners[2] ^ kept ^ gone, t);
    deaths_[t] = steps_ + 1;
  }
  const std::size_t of_kept = star_.size();
  for (const auto t : triangle_stars_.of(gone)) {
    if (deaths_[t] != kNoIndex) continue;
    Triangle& corners = triangles_[t];
    const std::size_t at = corners[0] == gone ? 0 : corners[1] == gone ? 1 : 2;
    const std::uint32_t y = corners[(at + 1) % 3];
    const std::uint32_t z = corners[(at + 2) % 3];
    corners[at] = kept;
    if (edge_to_[y] != kNoIndex && edge_to_[z] != kNoIndex &&
        std::any_of(star_.begin(), star_.begin() + static_cast<std::ptrdiff_t>(of_kept),
                    [&](std::uint32_t twin) { return has_corner(twin, y) && has_corner(twin, z); })) {
      triangle_stars_.remove(y, t);
      triangle_stars_.remove(z, t);
      deaths_[t] = steps_ + 1;
      continue;
    }
    star_.push_back(t);
  }
  triangle_stars_.merge(kept, gone, star_);
}

void CollapseComplex::merge_edges(std::uint32_t collapsed, std::uint32_t kept, std::uint32_t gone) {
  doubled_.clear();
  star_.clear();
  const auto kill = [&](std::uint32_t e) {
    edges_[e].flags |= Dead;
    if ((edges_[e].flags & Wire) != 0) end_wire(e);
  };
  for (const auto e : edge_stars_.of(gone)) {
    if (e == collapsed) continue;
    const std::uint32_t y = other_end(e, gone);
    edges_[e].ends = {kept, y};
    const std::uint32_t twin = edge_to_[y];
    if (twin == kNoIndex) {
      star_.push_back(e);
      continue;
    }
    const std::uint32_t winner = edges_[e].key > edges_[twin].key ? e : twin;
    const std::uint32_t loser = e ^ twin ^ winner;
    // A link that meets an edge of the complex becomes one.
    const bool link = is_link(e) && is_link(twin);
    edge_stars_.remove(y, loser);
    kill(loser);
    if (!link) edges_[winner].flags &= static_cast<std::uint8_t>(~Link);
    edge_to_[y] = winner;
    doubled_.push_back(winner);
  }
  // The kept vertex's own edges come first, in their order.
  const std::size_t added = star_.size();
  for (const auto e : edge_stars_.of(kept)) {
    const std::uint32_t y = e == collapsed ? gone : other_end(e, kept);
    if (y != gone) star_.push_back(edge_to_[y]);
    edge_to_[y] = kNoIndex;
  }
  std::rotate(star_.begin(), star_.begin() + static_cast<std::ptrdiff_t>(added), star_.end());
  kill(collapsed);
  edge_stars_.merge(kept, gone, star_);
}

void CollapseComplex::settle_wires(std::uint32_t kept) {
  for (const auto e : doubled_) {
    if (is_link(e)) continue;
    const std::uint32_t y = other_end(e, kept);
    const bool wire = triangles_on(kept, y) == 0;
    const bool was = (edges_[e].flags & Wire) != 0;
    if (wire && !was) {
      edges_[e].flags |= Wire;
      wire_events_.push_back({steps_ + 1, e, kept, y});
    } else if (!wire && was) {
      edges_[e].flags &= static_cast<std::uint8_t>(~Wire);
      end_wire(e);
    }
  }
}

void CollapseComplex::end_wire(std::uint32_t edge) {
  wire_events_.push_back({steps_ + 1, edge, kNoIndex, kNoIndex});
}

bool CollapseComplex::joined(std::uint32_t a, std::uint32_t b) const noexcept {
  const auto star = edges_of(a);
  return std::any_of(star.begin(), star.end(), [&](std::uint32_t e) { return other_end(e, a) == b; });
}

std::uint32_t CollapseComplex::add_links(std::span<const Pair> links) {
  const std::uint32_t first = edge_count();
  if (links.empty()) return first;
  std::vector<std::uint32_t> sizes(edge_to_.size(), 0);
  for (std::uint32_t slot = 0; slot < sizes.size(); ++slot)
    sizes[slot] = static_cast<std::uint32_t>(edge_stars_.of(slot).size());
  for (const Pair& pair : links)
    for (const auto end : pair) ++sizes[end];
  Stars grown;
  grown.allot(sizes);
  for (std::uint32_t slot = 0; slot < sizes.size(); ++slot)
    for (const auto e : edge_stars_.of(slot)) grown.push(slot, e);
  for (const Pair& pair : links) {
    const std::uint32_t id = edge_count();
    edges_.push_back({.ends = pair, .flags = Link});
    for (const auto end : pair) grown.push(end, id);
  }
  edge_stars_ = std::move(grown);
  return first;
}

bool CollapseComplex::keeps_topology(std::uint32_t edge) {
  if (is_link(edge)) return false;
  const auto [u, v] = edges_[edge].ends;
  const auto open = [&](std::uint32_t a, std::uint32_t b) { return triangles_on(a, b) != 2; };
  // Common neighbours are exactly the corners opposite to the edge.
  std::size_t common = 0;
  std::size_t open_at_u = 0;
  std::size_t open_at_v = 0;
  bool shared_open = false;
  for (const auto e : edge_stars_.of(u)) {
    if (is_link(e)) continue;
    const std::uint32_t y = other_end(e, u);
    edge_to_[y] = e;
    open_at_u += open(u, y) ? 1U : 0U;
  }
  for (const auto e : edge_stars_.of(v)) {
    if (is_link(e)) continue;
    const std::uint32_t y = other_end(e, v);
    const bool open_here = open(v, y);
    open_at_v += open_here ? 1U : 0U;
    if (y == u || edge_to_[y] == kNoIndex) continue;
    ++common;
    shared_open = shared_open || (open_here && open(u, y));
  }
  // No triangle on one is a triangle on the other but for that corner.
  bool twins = false;
  for (const auto t : triangle_stars_.of(v)) {
    if (has_corner(t, u)) continue;
    const Triangle& c = triangles_[t];
    const std::size_t at = c[0] == v ? 0 : c[1] == v ? 1 : 2;
    const std::uint32_t y = c[(at + 1) % 3];
    const std::uint32_t z = c[(at + 2) % 3];
    if (edge_to_[y] == kNoIndex || edge_to_[z] == kNoIndex) continue;
    for (const auto s : triangle_stars_.of(u)) twins = twins || (has_corner(s, y) && has_corner(s, z));
  }
  for (const auto e : edge_stars_.of(u)) edge_to_[other_end(e, u)] = kNoIndex;
  if (common != triangles_on(u, v) || shared_open || twins) return false;
  // Both on the boundary (or on other edges without two sides): only along it, and never where it branches at both.
  const bool along = open(u, v);
  if (!along) return open_at_u == 0 || open_at_v == 0;
  return open_at_u == 2 || open_at_v == 2;
}

void CollapseComplex::Stars::allot(std::span<const std::uint32_t> sizes) {
  lists_.resize(sizes.size());
  std::uint32_t total = 0;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    lists_[k] = {.begin = total, .size = 0};
    total += sizes[k];
  }
  slack_ = total / kSlack;
  items_.reserve(total + slack_);
  items_.resize(total);
}

void CollapseComplex::Stars::remove(std::uint32_t slot, std::uint32_t item) noexcept {
  const auto first = items_.begin() + lists_[slot].begin;
  const auto last = first + lists_[slot].size;
  const auto found = std::find(first, last, item);
  assert(found != last);
  std::move(found + 1, last, found);
  --lists_[slot].size;
}

void CollapseComplex::Stars::merge(std::uint32_t kept, std::uint32_t gone, std::span<const std::uint32_t> list) {
  const auto size = static_cast<std::uint32_t>(list.size());
  if (size > lists_[kept].size) {
    if (size <= lists_[gone].size) {
      lists_[kept].begin = lists_[gone].begin;
    } else {
      lists_[kept].size = lists_[gone].size = 0;
      if (items_.size() + size > items_.capacity()) pack(size);
      lists_[kept].begin = static_cast<std::uint32_t>(items_.size());
      items_.resize(items_.size() + size);
    }
  }
  std::copy(list.begin(), list.end(), items_.begin() + lists_[kept].begin);
  lists_[kept].size = size;
  lists_[gone].size = 0;
}

void CollapseComplex::Stars::pack(std::uint32_t more) {
  std::size_t live = more;
  for (const List& list : lists_) live += list.size;
  std::vector<std::uint32_t> packed;
  packed.reserve(live + slack_);
  for (List& list : lists_) {
    const auto from = items_.begin() + list.begin;
    list.begin = static_cast<std::uint32_t>(packed.size());
    packed.insert(packed.end(), from, from + list.size);
  }
  items_ = std::move(packed);
}

}  // namespace armature::sdk
