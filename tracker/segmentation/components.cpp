#include "tracker/segmentation/components.h"

#include <algorithm>
#include <cmath>

namespace armature {
namespace {

constexpr int kMinCells = 6;
constexpr int kHoleCells = 3;       ///< drop-outs up to this wide do not cut a surface
constexpr float kEdgeSteps = 1.6F;  ///< continuity tolerances over two cells that make the middle one an edge
constexpr int kContactCells = 5;    ///< the projector's shadow beside something near is about this wide

std::size_t at(int i) noexcept {
  return static_cast<std::size_t>(i);
}

}  // namespace

ComponentFinder::ComponentFinder(int cells)
    : edges_(at(cells)), parent_(at(cells)), cells_of_root_(at(cells)), label_of_root_(at(cells)), labels_(at(cells)) {
  sizes_.reserve(at(cells));
}

int ComponentFinder::root(int cell) noexcept {
  while (parent_[at(cell)] != cell) {
    parent_[at(cell)] = parent_[at(parent_[at(cell)])];
    cell = parent_[at(cell)];
  }
  return cell;
}

void ComponentFinder::join(int a, int b) noexcept {
  a = root(a);
  b = root(b);
  // The smaller index wins, so that the result does not depend on the order of joins.
  if (a < b)
    parent_[at(b)] = a;
  else
    parent_[at(a)] = b;
}

void ComponentFinder::find(const DepthGrid& grid, std::span<const std::uint8_t> kind,
                           const Eigen::Vector3f& up) noexcept {
  link(grid, kind);
  rank(grid, kind);
  measure(grid, kind, up);
  touch(grid);
  look_below(grid);
}

ComponentFinder::Edge ComponentFinder::edge(const DepthGrid& grid, int x, int i) noexcept {
  const auto& z = grid.depth;
  if (x == 0 || x + 1 == grid.width || z[at(i)] <= 0 || z[at(i - 1)] <= 0 || z[at(i + 1)] <= 0) return Edge::None;
  const float to_right = z[at(i + 1)] - z[at(i)];
  const float to_left = z[at(i)] - z[at(i - 1)];
  const float tolerance = continuity_tolerance(z[at(i)]);
  if (std::abs(to_right + to_left) < kEdgeSteps * tolerance) return Edge::None;
  if (std::max(to_right, to_left) < 0) return Edge::FarLeft;
  if (std::min(to_right, to_left) > 0) return Edge::FarRight;
  return Edge::None;
}

void ComponentFinder::link(const DepthGrid& grid, std::span<const std::uint8_t> kind) noexcept {
  const auto& z = grid.depth;
  const auto same_surface = [&](int a, int b) {
    return std::abs(z[at(a)] - z[at(b)]) < continuity_tolerance(std::min(z[at(a)], z[at(b)]));
  };
  const int w = grid.width;
  for_each_marked(grid, kind, [&](int x, int y, std::size_t cell) {
    const int i = static_cast<int>(cell);
    parent_[cell] = i;
    cells_of_root_[cell] = 0;
    edges_[cell] = edge(grid, x, i);
    // Neighbours across a hole count as neighbours.
    for (int step = 1; step <= std::min(x, kHoleCells + 1); ++step) {
      if (kind[at(i - step)] != 0) {
        const bool leaves = edges_[at(i)] == Edge::FarLeft || edges_[at(i - step)] == Edge::FarRight;
        if (!leaves && same_surface(i, i - step)) join(i, i - step);
        break;
      }
      if (z[at(i - step)] > 0) break;
    }
    for (int step = 1; step <= std::min(y, kHoleCells + 1); ++step) {
      if (kind[at(i - step * w)] != 0) {
        if (edges_[at(i)] == edges_[at(i - step * w)] && same_surface(i, i - step * w)) join(i, i - step * w);
        break;
      }
      if (z[at(i - step * w)] > 0) break;
    }
    if (y == 0 || edges_[at(i)] != Edge::None) return;
    const auto diagonal = [&](int j) {
      if (kind[at(j)] != 0 && edges_[at(j)] == Edge::None && same_surface(i, j)) join(i, j);
    };
    if (x > 0) diagonal(i - w - 1);
    if (x + 1 < w) diagonal(i - w + 1);
  });
  for_each_marked(grid, kind, [&](int, int, std::size_t cell) { ++cells_of_root_[at(root(static_cast<int>(cell)))]; });
}

void ComponentFinder::rank(const DepthGrid& grid, std::span<const std::uint8_t> kind) noexcept {
  sizes_.clear();
  for_each_marked(grid, kind, [&](int, int, std::size_t cell) {
    label_of_root_[cell] = 0;
    if (cells_of_root_[cell] >= kMinCells) sizes_.push_back({static_cast<int>(cell), cells_of_root_[cell]});
  });
  count_ = std::min(sizes_.size(), kMaxComponents);
  const auto kept = sizes_.begin() + static_cast<std::ptrdiff_t>(count_);
  std::partial_sort(sizes_.begin(), kept, sizes_.end(), [](const Size& a, const Size& b) {
    return a.cells != b.cells ? a.cells > b.cells : a.root < b.root;
  });
  for (std::size_t c = 0; c < count_; ++c) label_of_root_[at(sizes_[c].root)] = static_cast<std::uint8_t>(c + 1);
}

void ComponentFinder::measure(const DepthGrid& grid, std::span<const std::uint8_t> kind,
                              const Eigen::Vector3f& up) noexcept {
  constexpr float kFar = 1e9F;
  for (std::size_t c = 0; c < count_; ++c) {
    found_[c] = {};
    found_[c].left = found_[c].near = found_[c].lowest = kFar;
    found_[c].right = found_[c].far = found_[c].highest = -kFar;
  }
  std::ranges::fill(labels_, std::uint8_t{0});
  for_each_marked(grid, kind, [&](int x, int y, std::size_t cell) {
    labels_[cell] = label_of_root_[at(root(static_cast<int>(cell)))];
    if (labels_[cell] == 0) return;
    Component& c = found_[labels_[cell] - std::size_t{1}];
    const float z = grid.depth[cell];
    const Eigen::Vector3f p(grid.ray_x[at(x)] * z, grid.ray_y[at(y)] * z, z);
    const float height = up.dot(p);
    ++c.cells;
    c.foreground_cells += kind[cell] == 2;
    c.area += grid.area(z);
    c.centre += p;
    c.left = std::min(c.left, p.x());
    c.right = std::max(c.right, p.x());
    c.near = std::min(c.near, z);
    c.far = std::max(c.far, z);
    c.lowest = std::min(c.lowest, height);
    c.highest = std::max(c.highest, height);
    c.cut_above |= y == 0;
    c.cut_below |= y == grid.height - 1;
    c.cut_aside |= x == 0 || x == grid.width - 1;
  });
  for (std::size_t c = 0; c < count_; ++c) found_[c].centre /= static_cast<float>(found_[c].cells);
}

void ComponentFinder::touch(const DepthGrid& grid) noexcept {
  for (std::size_t a = 0; a < count_; ++a)
    for (std::size_t b = 0; b < count_; ++b) contacts_[a * kMaxComponents + b] = {};
  const auto meet = [&](int i, int j) {
    const std::size_t a = labels_[at(i)] - std::size_t{1};
    const std::size_t b = labels_[at(j)] - std::size_t{1};
    if (a == b) return;
    for (Contact* contact : {&contacts_[a * kMaxComponents + b], &contacts_[b * kMaxComponents + a]}) {
      ++contact->cells;
      contact->smallest_step = std::min(contact->smallest_step, std::abs(grid.depth[at(i)] - grid.depth[at(j)]));
    }
  };
  const int w = grid.width;
  for_each_marked(grid, labels_, [&](int x, int y, std::size_t cell) {
    const int i = static_cast<int>(cell);
    for (int step = 1; step <= std::min(x, kContactCells); ++step) {
      if (labels_[at(i - step)] != 0) {
        meet(i, i - step);
        break;
      }
    }
    for (int step = 1; step <= std::min(y, kContactCells); ++step) {
      if (labels_[at(i - step * w)] != 0) {
        meet(i, i - step * w);
        break;
      }
    }
  });
}

void ComponentFinder::look_below(const DepthGrid& grid) noexcept {
  const int w = grid.width;
  for_each_marked(grid, labels_, [&](int, int y, std::size_t cell) {
    const float z = grid.depth[cell];
    for (int step = 1; step <= std::min(grid.height - 1 - y, kHoleCells + 1); ++step) {
      const std::size_t below = cell + at(step * w);
      if (grid.depth[below] <= 0) continue;
      if (z - grid.depth[below] > kEdgeSteps * continuity_tolerance(z) && labels_[below] != labels_[cell]) {
        found_[labels_[cell] - std::size_t{1}].hidden_below += grid.cell_width_rad * z;
      }
      return;
    }
  });
}

}  // namespace armature
