#include "sdk/spheremesh/union_fit.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SparseCholesky>
#include <armature/sdk/mesh/measures.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "sdk/spheremesh/point_blocks.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;
using Eigen::VectorXd;

constexpr int kOuterLasts = 5;  // iterations: cavities change slowly
constexpr double kLongestStep = 0.03;
constexpr double kCleft = 1.5;  // times what is far: the walls of a narrow cleft are pulled no farther at once

/// Whether a straight way is free of the union. So a narrow cleft is told from a cavity: it is open to the input's
/// surface.
bool is_free(const UnionGauge& gauge, const NearbyPieces& all, const Vector3d& from, const Vector3d& to) {
  constexpr double kTouching = 1e-7;
  for (const double along : {0.15, 0.4, 0.7, 1.0})
    if (gauge.distance(all, from + along * (to - from), 0, -kTouching) < -kTouching) return false;
  return true;
}

}  // namespace

double FitLoss::cost(double distance, double share) const noexcept {
  const double d = std::abs(distance);
  return share * (std::sqrt(d * d + round * round) - round) + tail * far * std::pow(d / far, power);
}

double FitLoss::weight(double distance, double share) const noexcept {
  const double d = std::abs(distance);
  return share / std::sqrt(d * d + round * round) + tail * power / far * std::pow(d / far, power - 2);
}

/// The matrix of all centres and radii: a 4x4 block for every sphere and every pair of an edge.
class UnionFit::NormalEquations {
 public:
  explicit NormalEquations(const UnionGauge& gauge) : count_(gauge.spheres().size()) {
    // By the larger corner, then the smaller: the lower half, columns by the smaller one.
    for (std::uint32_t k = 0; k < count_; ++k) pairs_.push_back({k, k});
    for (std::size_t e = 0; e < gauge.edge_count(); ++e) {
      const auto [a, b] = gauge.edge_corners(e);
      if (a != b) pairs_.push_back({std::min(a, b), std::max(a, b)});
    }
    std::sort(pairs_.begin(), pairs_.end());
    first_.assign(count_ + 1, 0);
    for (const auto& pair : pairs_) ++first_[pair[0] + 1];
    for (std::size_t k = 0; k < count_; ++k) first_[k + 1] += first_[k];
    blocks_.resize(pairs_.size());
  }

  void assemble(const std::vector<Row>& rows) {
    std::fill(blocks_.begin(), blocks_.end(), Matrix4d::Zero());
    right_ = VectorXd::Zero(static_cast<Eigen::Index>(4 * count_));
    for (const Row& row : rows) {
      if (!(row.weight > 0)) continue;
      const Vector4d weighted = row.weight * row.gradient;
      const Matrix4d outer = weighted * row.gradient.transpose();
      for (std::size_t i = 0; i < 3; ++i) {
        if (!(row.weights[i] > 0)) continue;
        right_.segment<4>(4 * row.corners[i]) += row.weights[i] * row.residual * weighted;
        for (std::size_t j = 0; j < 3; ++j)
          if (row.weights[j] > 0 && row.corners[i] <= row.corners[j] && (i <= j || row.corners[i] != row.corners[j]))
            block(row.corners[i], row.corners[j]) += (row.weights[i] * row.weights[j]) * outer;
      }
    }
  }

  /// (A + damping diag A) x = b, where fixed spheres stay; empty if it cannot be factored.
  [[nodiscard]] std::optional<VectorXd> solve(double damping, const std::vector<bool>& fixed) const {
    const auto is_fixed = [&](std::uint32_t k) { return !fixed.empty() && fixed[k]; };
    double trace = 0;
    for (std::uint32_t k = 0; k < count_; ++k) trace += blocks_[first_[k]].trace();
    const double least = 1e-6 * trace / static_cast<double>(4 * count_) + 1e-300;

    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(16 * pairs_.size());
    for (std::size_t p = 0; p < pairs_.size(); ++p) {
      const auto [i, j] = pairs_[p];
      if (i != j && (is_fixed(i) || is_fixed(j))) continue;
      for (Eigen::Index r = 0; r < 4; ++r)
        for (Eigen::Index c = 0; c < (i == j ? r + 1 : 4); ++c) {
          // The block is of rows i and columns j: of the lower half, rows j and columns i.
          double value = i == j ? blocks_[p](r, c) : blocks_[p](c, r);
          if (i == j && r == c) value += damping * value + least;
          if (i == j && is_fixed(i)) value = r == c ? 1 : 0;
          entries.emplace_back(static_cast<int>(4 * j + r), static_cast<int>(4 * i + c), value);
        }
    }
    VectorXd b = right_;
    for (std::uint32_t k = 0; k < count_; ++k)
      if (is_fixed(k)) b.segment<4>(4 * k).setZero();
    const auto size = static_cast<Eigen::Index>(4 * count_);
    Eigen::SparseMatrix<double> A(size, size);
    A.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(A);
    if (factor.info() != Eigen::Success) return std::nullopt;
    VectorXd x = factor.solve(b);
    if (!x.allFinite()) return std::nullopt;
    return x;
  }

 private:
  [[nodiscard]] Matrix4d& block(std::uint32_t i, std::uint32_t j) {
    const auto begin = pairs_.begin() + first_[i];
    const auto end = pairs_.begin() + first_[i + 1];
    const auto found = i == j ? begin : std::lower_bound(begin, end, std::array{i, j});
    return blocks_[static_cast<std::size_t>(found - pairs_.begin())];
  }

  std::size_t count_;
  std::vector<std::array<std::uint32_t, 2>> pairs_;
  std::vector<std::uint32_t> first_;  // by sphere, in pairs_
  std::vector<Matrix4d> blocks_;
  VectorXd right_;
};

UnionFit::UnionFit(const Mesh& mesh, std::size_t samples)
    : samples_(sample_input(mesh, samples)), tree_(mesh), face_normals_(face_normals(mesh)) {
  const double area = surface_area(mesh);
  if (area > 0) density_ = static_cast<double>(samples) / area;
  plain_.assign(samples_.points.size(), 1);
  sample_count_ = static_cast<double>(std::max<std::size_t>(1, samples_.points.size()));

  std::vector<std::array<std::uint32_t, 2>> order(mesh.positions.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = {place_on_curve(mesh.positions[k]), k};
  std::sort(order.begin(), order.end());
  const std::vector<Vector3d> normals = vertex_normals(mesh);
  for (const auto& [place, k] : order) {
    if (normals[k].isZero()) continue;  // on no face
    vertices_.push_back(mesh.positions[k]);
    vertex_normals_.push_back(normals[k]);
  }
}

double UnionFit::watch_far_vertices(const UnionGauge& gauge) {
  constexpr std::size_t kMost = 96;
  constexpr double kApart = 0.01;
  const auto samples = static_cast<std::size_t>(sample_count_);
  samples_.points.resize(samples), samples_.normals.resize(samples), plain_.resize(samples);
  if (vertices_.empty()) return 0;

  std::vector<UnionTouch> touches(vertices_.size());
  touch_all(gauge, vertices_, touches);
  std::vector<std::uint32_t> order(vertices_.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  const auto distance = [&](std::uint32_t k) { return std::abs(touches[k].distance); };
  const std::size_t head = std::min<std::size_t>(order.size(), 40 * kMost);
  std::partial_sort(
      order.begin(), order.begin() + static_cast<std::ptrdiff_t>(head), order.end(),
      [&](std::uint32_t a, std::uint32_t b) { return std::pair(-distance(a), a) < std::pair(-distance(b), b); });
  for (std::size_t i = 0; i < head && samples_.points.size() < samples + kMost; ++i) {
    const Vector3d& p = vertices_[order[i]];
    const auto watched = std::span(samples_.points).subspan(samples);
    if (distance(order[i]) < 0.5 * loss.far) break;
    if (std::any_of(watched.begin(), watched.end(),
                    [&](const Vector3d& q) { return (p - q).squaredNorm() < kApart * kApart; }))
      continue;
    samples_.points.push_back(p);
    samples_.normals.push_back(vertex_normals_[order[i]]);
    plain_.push_back(0);
  }
  return distance(order[0]);
}

void UnionFit::forward_rows(const UnionGauge& gauge, std::vector<Row>& rows) const {
  const std::size_t count = samples_.points.size();
  rows.resize(count);
  std::vector<UnionTouch> touches(count);
  touch_all(gauge, samples_.points, touches);
  for (std::size_t k = 0; k < count; ++k) {
    const UnionTouch& touch = touches[k];
    const Vector3d away = samples_.points[k] - blend(gauge.spheres(), touch.corners, touch.weights).centre;
    const double length = away.norm();
    const Vector3d d = length > 1e-12 ? Vector3d(away / length) : samples_.normals[k];
    rows[k] = {
        touch.distance, forward_weight(k, touch.distance), forward_cost(k, touch.distance), plain_[k], touch.corners,
        touch.weights,  Vector4d(d[0], d[1], d[2], 1)};
  }
}

UnionFit::Row UnionFit::back_row(const UnionSample& y, const OuterSpace& outer, FaceId& hint,
                                 const Whole* whole) const {
  const SurfacePoint q = tree_.closest(y.point, {.hint = hint});
  hint = q.face;
  const Vector3d& normal = face_normals_[q.face.index()];
  const Vector3d to_input = q.point - y.point;
  const bool within = to_input.dot(normal) > 0;
  // The wall of a cavity lies within the input and, near its surface, looks the other way.
  const double shallow = y.normal.dot(normal) < 0.3 ? 2e-3 : 2 * outer.cell_size();
  double residual = q.distance;
  if (within && q.distance > shallow && !outer.sees(y.point, y.normal)) {
    if (whole == nullptr || !is_free(whole->gauge, whole->pieces, y.point, q.point))
      return {0, 0, 0, 0, y.corners, y.weights, Vector4d::Zero()};
    residual = std::min(residual, kCleft * loss.far);
  }
  Vector3d direction = q.distance > 1e-9 ? Vector3d(to_input / q.distance) : normal;
  const double along = direction.dot(y.normal);
  const double sign = along < 0 ? -1 : 1;
  direction *= sign, residual *= sign;
  const double side = loss.side(within ? 1 : -1);
  return {residual,
          side * loss.weight(residual, y.share),
          side * loss.cost(residual, y.share),
          y.share,
          y.corners,
          y.weights,
          Vector4d(direction[0], direction[1], direction[2], std::abs(along))};
}

void UnionFit::back_rows(const UnionGauge& gauge, const OuterSpace& outer, std::vector<Row>& rows) const {
  const std::vector<UnionSample> boundary = sample_union(gauge, density_);
  const Whole whole{gauge, gauge.all()};
  rows.resize(boundary.size());
  constexpr std::size_t kGrain = 64;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boundary.size(), kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      FaceId hint;
                      for (std::size_t k = range.begin(); k < range.end(); ++k)
                        rows[k] = back_row(boundary[k], outer, hint, &whole);
                    });
  std::erase_if(rows, [](const Row& row) { return row.weight == 0; });
  double area = 0;
  for (const Row& row : rows) area += row.share;
  for (Row& row : rows) row.weight /= std::max(1.0, area), row.cost /= std::max(1.0, area);
}

double UnionFit::back_cost(const UnionGauge& gauge, const OuterSpace& outer, const PieceFilter& pieces,
                           double thin) const {
  double sum = 0;
  FaceId hint;
  for (const UnionSample& y : sample_union(gauge, density_ / thin, pieces)) sum += back_row(y, outer, hint).cost;
  return sum * thin / sample_count_;
}

std::vector<double> UnionFit::back_costs(const UnionGauge& gauge, const OuterSpace& outer) const {
  const std::vector<UnionSample> boundary = sample_union(gauge, density_);
  std::vector<double> costs(boundary.size());
  constexpr std::size_t kGrain = 64;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boundary.size(), kGrain),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      FaceId hint;
                      for (std::size_t k = range.begin(); k < range.end(); ++k)
                        costs[k] = back_row(boundary[k], outer, hint).cost;
                    });
  std::vector<double> sums(gauge.edge_count() + gauge.facets().size(), 0);
  for (std::size_t k = 0; k < boundary.size(); ++k)
    if (boundary[k].piece != UnionSample::kSphere) sums[boundary[k].piece] += costs[k] / sample_count_;
  return sums;
}

std::vector<UnionFit::Row> UnionFit::rows(const UnionGauge& gauge, const OuterSpace& outer, FitError& error) const {
  std::vector<Row> forward;
  std::vector<Row> back;
  forward_rows(gauge, forward);
  back_rows(gauge, outer, back);
  error = {};
  const auto sum = [&](const std::vector<Row>& rows, double& mean) {
    double area = 0;
    for (const Row& row : rows) {
      error.loss += row.cost;
      mean += row.share * std::abs(row.residual);
      area += row.share;
    }
    if (area > 0) mean /= area;
  };
  sum(forward, error.forward);
  sum(back, error.back);
  forward.insert(forward.end(), back.begin(), back.end());
  return forward;
}

FitError UnionFit::error(const UnionGauge& gauge, const OuterSpace& outer) const {
  FitError error;
  static_cast<void>(rows(gauge, outer, error));
  return error;
}

void UnionFit::improve(SphereMesh& shape, OuterSpace& outer, int iterations, const std::vector<bool>& fixed,
                       const Task& task) const {
  if (task.stopped()) return;
  UnionGauge gauge(shape);
  NormalEquations equations(gauge);
  outer.follow(gauge);
  FitError error;
  if (task.stopped()) return;
  equations.assemble(rows(gauge, outer, error));
  double damping = 0.02;
  int refused = 0;
  for (int k = 0; k < iterations && !task.stopped(); ++k) {
    if (k > 0 && k % kOuterLasts == 0) {
      outer.follow(gauge);
      equations.assemble(rows(gauge, outer, error));
    }
    const std::optional<VectorXd> step = equations.solve(damping, fixed);
    if (!step) break;
    std::vector<Sphere> moved = gauge.spheres();
    for (std::size_t i = 0; i < moved.size(); ++i) {
      Vector4d s = step->segment<4>(static_cast<Eigen::Index>(4 * i));
      const double length = std::max(s.head<3>().norm(), std::abs(s[3]));
      if (length > kLongestStep) s *= kLongestStep / length;
      moved[i].centre += s.head<3>();
      moved[i].radius = std::max(0.0, moved[i].radius + s[3]);
    }
    UnionGauge tried = gauge;
    tried.move_to(moved);
    FitError error_there;
    const std::vector<Row> there = rows(tried, outer, error_there);
    if (error_there.loss < error.loss) {
      const double gain = 1 - error_there.loss / error.loss;
      gauge = std::move(tried);
      error = error_there;
      equations.assemble(there);
      damping = std::max(1e-3, 0.4 * damping);
      refused = 0;
      constexpr double kNoGain = 5e-4;
      if (gain < kNoGain && k > 5) break;
    } else {
      damping *= 4;
      constexpr int kPatience = 4;
      if (++refused > kPatience) break;
    }
  }
  shape.spheres = gauge.spheres();
}

}  // namespace armature::sdk
