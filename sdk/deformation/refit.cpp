#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <armature/sdk/deformation/refit.h>
#include <armature/sdk/hierarchy/build.h>

#include "sdk/deformation/best_turn.h"
#include "sdk/deformation/plane_sums.h"
#include "sdk/hierarchy/extents.h"
#include "sdk/mesh/four.h"
#include "sdk/mesh/normalised_shape.h"
#include "sdk/spheremesh/quadric_minimum.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

using Eight = float __attribute__((vector_size(32)));

struct EightPoints {
  Eight x, y, z;
  void set(std::size_t lane, const Eigen::Vector3f& p) { x[lane] = p.x(), y[lane] = p.y(), z[lane] = p.z(); }
};

/// How far points reach along a direction.
ARMATURE_LANES float extent(const std::vector<EightPoints>& points, const Eigen::Vector3f& along) {
  Eight low = Eight{} + std::numeric_limits<float>::infinity();
  Eight high = -low;
  const float ax = along.x(), ay = along.y(), az = along.z();
  for (const EightPoints& p : points) {
    const Eight at = ax * p.x + ay * p.y + az * p.z;
    low = at < low ? at : low;
    high = at > high ? at : high;
  }
  float lowest = low[0];
  float highest = high[0];
  for (std::size_t lane = 1; lane < 8; ++lane) {
    lowest = std::min(lowest, low[lane]);
    highest = std::max(highest, high[lane]);
  }
  return highest - lowest;
}

std::vector<Vector3d> by_place(const Hierarchy& hierarchy, std::span<const Vector3d> positions) {
  std::vector<Vector3d> placed(positions.size());
  for (std::size_t v = 0; v < positions.size(); ++v) placed[hierarchy.place(VertexId(v))] = positions[v];
  return placed;
}

}  // namespace

struct Refit::Region {
  RegionFrame frame;
  Matrix3d spread = Matrix3d::Zero();  ///< covariance of its vertices now
  bool wanted = true;
  bool moved = false;
  PlaneSums sums;                     ///< of its faces now, about frame.now
  std::vector<std::uint32_t> border;  ///< where its cells end between it and others: 3 times a triangle and a corner
};

Refit::Refit(const Mesh& mesh, const Hierarchy& hierarchy)
    : hierarchy_(&hierarchy), rest_(by_place(hierarchy, mesh.positions)) {
  const NormalisedShape shape = NormalisedShape::of(mesh, ShapeFrame::Own);
  shape_from_model_ = shape.turn;
  order_.resize(hierarchy.node_count());
  std::uint32_t next = 0;
  for (std::size_t i = order_.size(); i-- > 0;) {
    const NodeId node(i);
    if (!hierarchy.parent(node).valid()) {
      order_[i] = next;
      next += subtree_size(node);
    }
    if (hierarchy.is_leaf(node)) continue;
    const auto [a, b] = hierarchy.children(node);
    order_[a.index()] = order_[i] + 1;
    order_[b.index()] = order_[a.index()] + subtree_size(a);
  }
  // Behind all nodes come triangles that no node holds.
  std::vector<std::uint32_t> keys;
  keys.reserve(shape.triangles.size());
  for (const auto& corners : shape.triangles) {
    const std::uint32_t a = hierarchy.place(VertexId(corners[0]));
    const std::uint32_t b = hierarchy.place(VertexId(corners[1]));
    const std::uint32_t c = hierarchy.place(VertexId(corners[2]));
    const auto [low, high] = std::minmax({a, b, c});
    NodeId node(corners[0]);
    while (node.valid() && !(hierarchy.range(node)[0] <= low && high < hierarchy.range(node)[1]))
      node = hierarchy.parent(node);
    keys.push_back(node.valid() ? order_[node.index()] : next);
  }
  triangles_from_.assign(next + 2, 0);
  for (const std::uint32_t key : keys) ++triangles_from_[key + 1];
  std::partial_sum(triangles_from_.begin(), triangles_from_.end(), triangles_from_.begin());
  triangles_.resize(keys.size());
  std::vector<std::uint32_t> ends(triangles_from_.begin(), triangles_from_.end() - 1);
  for (std::size_t t = 0; t < keys.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      triangles_[ends[keys[t]]][k] = hierarchy.place(VertexId(shape.triangles[t][k]));
      if (k == 2) ++ends[keys[t]];
    }
  for (const auto& pin : hierarchy.parts().pinned) pinned_.push_back(hierarchy.place(VertexId(pin.vertex)));
  std::ranges::sort(pinned_);
}

std::uint32_t Refit::subtree_size(NodeId node) const {
  const auto [begin, end] = hierarchy_->range(node);
  return 2 * (end - begin) - 1;
}

bool Refit::holds_pinned(NodeId node) const {
  const auto [begin, end] = hierarchy_->range(node);
  const auto first = std::ranges::lower_bound(pinned_, begin);
  return first != pinned_.end() && *first < end;
}

Refit::Region Refit::measure(NodeId node, const std::vector<Vector3d>& now) const {
  const auto [begin, end] = hierarchy_->range(node);
  Region region;
  Vector3d before = Vector3d::Zero();
  Vector3d after = Vector3d::Zero();
  for (std::uint32_t i = begin; i < end; ++i) {
    before += rest_[i];
    after += now[i];
    region.moved = region.moved || rest_[i] != now[i];
  }
  const double count = end - begin;
  region.frame.before = before / count;
  region.frame.now = after / count;
  if (!region.moved) return region;
  Matrix3d S = Matrix3d::Zero();
  double size_before = 0;
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vector3d x = rest_[i] - region.frame.before;
    const Vector3d y = now[i] - region.frame.now;
    S.noalias() += y * x.transpose();
    region.spread.noalias() += y * y.transpose();
    size_before += x.squaredNorm();
  }
  const double size_now = region.spread.trace();
  region.spread /= count;
  region.frame.turn = best_turn(S);
  if (size_before > 0 && size_now > 0) region.frame.scale = std::sqrt(size_now / size_before);
  return region;
}

RegionFrame Refit::frame(NodeId node, std::span<const Vector3d> positions) const {
  return measure(node, by_place(*hierarchy_, positions)).frame;
}

void Refit::add_triangles(std::span<const NodeId> cut, const std::vector<Vector3d>& now,
                          std::vector<Region>& regions) const {
  std::vector<std::uint32_t> region_at(now.size());
  for (std::uint32_t r = 0; r < cut.size(); ++r) {
    const auto [begin, end] = hierarchy_->range(cut[r]);
    std::fill(region_at.begin() + begin, region_at.begin() + end, r);
  }
  const auto is_wanted = [](const Region& region) { return region.wanted && region.moved; };
  const auto add_border = [&](std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t t = from; t < to; ++t) {
      const auto& corners = triangles_[t];
      if (std::ranges::none_of(corners, [&](std::uint32_t p) { return is_wanted(regions[region_at[p]]); })) continue;
      const auto& [a, b, c] = corners;
      const CellPlane plane = CellPlane::of(now[a], now[b], now[c]);
      const Vector3d sum = now[a] + now[b] + now[c];
      for (std::uint32_t k = 0; k < 3; ++k) {
        Region& own = regions[region_at[corners[k]]];
        if (!is_wanted(own)) continue;
        own.sums.add_cell(plane, now[corners[k]] - own.frame.now, sum - 3 * own.frame.now);
        own.border.push_back(3 * t + k);
      }
    }
  };
  // What lies within a region is one piece; what lies between these pieces are borders.
  std::uint32_t done = 0;
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const std::uint32_t from = triangles_from_[order_[cut[i].index()]];
    const std::uint32_t to = triangles_from_[order_[cut[i].index()] + subtree_size(cut[i])];
    add_border(done, from);
    if (is_wanted(regions[i]))
      regions[i].sums += sum_of(std::span(triangles_).subspan(from, to - from), now, regions[i].frame.now);
    done = to;
  }
  add_border(done, static_cast<std::uint32_t>(triangles_.size()));
}

double Refit::smallest_extent(NodeId node, const Region& region, const std::vector<Vector3d>& now) const {
  const auto [begin, end] = hierarchy_->range(node);
  std::vector<EightPoints> points((end - begin + 3 * region.border.size() + 7) / 8);
  std::size_t count = 0;
  const auto add = [&](const Vector3d& p) {
    points[count / 8].set(count % 8, (p - region.frame.now).cast<float>());
    ++count;
  };
  for (std::uint32_t i = begin; i < end; ++i) add(now[i]);
  for (const std::uint32_t cell : region.border) {
    const auto& corners = triangles_[cell / 3];
    const Vector3d& p = now[corners[cell % 3]];
    const Vector3d& q = now[corners[(cell + 1) % 3]];
    const Vector3d& r = now[corners[(cell + 2) % 3]];
    for (const Vector3d& end_of_cell : {Vector3d((p + q) / 2), Vector3d((p + r) / 2), Vector3d((p + q + r) / 3)})
      add(end_of_cell);
  }
  while (count < 8 * points.size()) add(now[end - 1]);  // is repeated
  const Matrix3d model_from_shape = region.frame.turn * shape_from_model_.transpose();
  float smallest = std::numeric_limits<float>::infinity();
  for (const Eigen::Vector3f& direction : half_sphere_directions())
    smallest = std::min(smallest, extent(points, (model_from_shape * direction.cast<double>()).cast<float>()));
  return static_cast<double>(smallest);
}

Sphere Refit::best_sphere(NodeId node, const Region& region, const std::vector<Vector3d>& now) const {
  const Sphere was = hierarchy_->sphere(node);
  const RegionFrame& frame = region.frame;
  if (!region.moved) return was;
  const Sphere carried{frame(was.centre), frame.scale * was.radius};
  if (hierarchy_->is_leaf(node) || holds_pinned(node) || !(region.sums.weight() > 0)) return carried;
  const HierarchyOptions options;
  const auto bound = [&] {
    return std::max(carried.radius, options.radius_per_width * smallest_extent(node, region, now));
  };
  // No width is less than twice the standard deviation along it, and most radii are far from their bound.
  const double least_variance =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(region.spread, Eigen::EigenvaluesOnly).eigenvalues()[0];
  const double surely_allowed =
      std::max(carried.radius, options.radius_per_width * 2 * std::sqrt(std::max(0.0, least_variance)));
  const SphericalQuadric quadric = region.sums.quadric(options.regularise);
  SphereFit fit = minimum_of(quadric, Vector3d::Zero(), Vector3d::Zero(), 0,
                             [] { return std::numeric_limits<double>::infinity(); });
  if (fit.sphere.radius > surely_allowed) fit = minimum_of(quadric, Vector3d::Zero(), Vector3d::Zero(), 0, bound);
  return {frame.now + fit.sphere.centre, fit.sphere.radius};
}

std::vector<FittedSphere> Refit::fit(std::span<const NodeId> cut, std::span<const Vector3d> positions,
                                     const std::vector<bool>& wanted) const {
  const std::vector<Vector3d> now = by_place(*hierarchy_, positions);
  std::vector<Region> regions(cut.size());
  for (std::size_t r = 0; r < cut.size(); ++r) {
    if (wanted.empty() || wanted[r])
      regions[r] = measure(cut[r], now);
    else
      regions[r].wanted = false;
  }
  add_triangles(cut, now, regions);
  std::vector<FittedSphere> spheres(cut.size());
  for (std::size_t r = 0; r < cut.size(); ++r)
    if (regions[r].wanted) spheres[r] = {best_sphere(cut[r], regions[r], now), regions[r].frame};
  return spheres;
}

}  // namespace armature::sdk
