#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Geometry>
#include <armature/sdk/descriptors/gls.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include "sdk/descriptors/cluster_grid.h"
#include "sdk/descriptors/gls_fit.h"

namespace armature::sdk {
namespace {

constexpr std::size_t kBlock = 4;                 // of weighted_sums()
constexpr std::size_t kWorthLooking = 8;          // so many points: which clusters are near them
constexpr double kSmallestScale = 1e-6;           // of the diagonal
constexpr double kSmallest = 2, kLargest = 0.25;  // of `gls_scales()`

Eigen::AlignedBox3d box_of(const PointSet& points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : points.positions) box.extend(p);
  return box;
}

/// Calls `work` with groups of points of a cell of side t, each within a small cube of it; as many in each, about, as
/// make up for looking which clusters are near.
template <class Points, class Place, class Work>
void for_groups(Points points, const Place& place, double t, const Work& work) {
  constexpr double kTogether = 16;
  constexpr int kMostCubes = 5;  // along a side
  const auto n = static_cast<double>(points.size());
  const int cubes = std::clamp(static_cast<int>(std::sqrt(n / kTogether)), 1, kMostCubes);
  if (cubes > 1) {
    const double side = t / cubes;
    // Sorted by cubes through the key, which all of them share.
    for (auto& [key, point] : points) {
      const Eigen::Array3d cube = (place(point) / side).array().floor();
      const Eigen::Array3d wrapped = cube - cubes * (cube / cubes).floor();
      key = static_cast<std::uint64_t>(wrapped[0] + cubes * (wrapped[1] + cubes * wrapped[2]));
    }
    std::ranges::sort(points);
  }
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin + 1;
    while (end < points.size() && points[end].first == points[begin].first) ++end;
    work(points.subspan(begin, end - begin));
    begin = end;
  }
}

}  // namespace

std::vector<double> gls_scales(const PointSet& points, std::size_t count) {
  const double apart = spacing(points);
  if (!(apart > 0)) return {};
  const double diagonal = box_of(points).diagonal().norm();
  // Far outliers make the spacing of all others small beside the box.
  const double first = std::max(kSmallest * apart, 2 * kSmallestScale * diagonal);
  const double last = kLargest * diagonal;
  if (!(last > first) || count < 2) return {first};
  std::vector<double> scales(count);
  for (std::size_t k = 0; k < count; ++k)
    scales[k] = first * std::pow(last / first, static_cast<double>(k) / static_cast<double>(count - 1));
  return scales;
}

struct GrowingLeastSquares::State {
  PointSet points;
  std::vector<double> scales;
  Eigen::Vector3d origin;
  std::vector<ClusterGrid> grids;  // by scale

  [[nodiscard]] ClusterColumns around(const Eigen::Vector3d& place, std::size_t scale) const {
    ClusterColumns found;
    grids[scale].gather(grids[scale].cell_of(place), found);
    found.pad(kBlock);
    return found;
  }
};

GrowingLeastSquares::GrowingLeastSquares(std::unique_ptr<const State> state) : state_(std::move(state)) {}
GrowingLeastSquares::~GrowingLeastSquares() = default;
GrowingLeastSquares::GrowingLeastSquares(GrowingLeastSquares&&) noexcept = default;
GrowingLeastSquares& GrowingLeastSquares::operator=(GrowingLeastSquares&&) noexcept = default;

const PointSet& GrowingLeastSquares::points() const noexcept {
  return state_->points;
}
std::span<const double> GrowingLeastSquares::scales() const noexcept {
  return state_->scales;
}

Expected<GrowingLeastSquares> GrowingLeastSquares::build(PointSet points, GlsOptions options, const Task& task) {
  if (auto checked = validate(points); !checked) return tl::unexpected(checked.error());
  if (points.positions.empty()) return fail("expected points to look at, found none");
  if (!(options.merged >= 0 && options.merged <= 1)) return fail("merged: expected a part of the scale in [0, 1]");
  const Eigen::AlignedBox3d box = box_of(points);
  const double diagonal = box.diagonal().norm();
  if (options.scales.empty()) options.scales = gls_scales(points);
  if (options.scales.empty()) return fail("all points are at one place; expected some that spread, or scales");
  for (std::size_t k = 0; k < options.scales.size(); ++k) {
    const double t = options.scales[k];
    if (!(t > 0) || !std::isfinite(t) || t < kSmallestScale * diagonal)
      return fail("scale " + std::to_string(k) + ": expected at least a millionth of the points' bounding box, found " +
                  std::to_string(t));
  }
  auto state = std::make_unique<State>();
  state->origin = box.min() + 0.5 * (box.max() - box.min());
  state->points = std::move(points);
  state->scales = std::move(options.scales);
  const double apart = options.merged > 0 ? spacing(state->points) : 0;
  task.report("sorting points", 0);
  std::vector<std::unique_ptr<ClusterGrid>> grids(state->scales.size());
  tbb::parallel_for(std::size_t{0}, grids.size(), [&](std::size_t k) {
    const double side = options.merged * state->scales[k];
    if (!task.stopped())
      grids[k] = std::make_unique<ClusterGrid>(state->points, state->origin, state->scales[k], side > apart ? side : 0);
  });
  if (task.stopped()) return cancelled();
  for (auto& grid : grids) state->grids.push_back(std::move(*grid));
  return GrowingLeastSquares(std::move(state));
}

GlsSums neighbourhood_sums(const GrowingLeastSquares& gls, const Eigen::Vector3d& place, std::size_t scale) {
  const Eigen::Vector3d relative = place - gls.state_->origin;
  return weighted_sums(gls.state_->around(relative, scale), relative, gls.state_->scales[scale]);
}

Gls GrowingLeastSquares::at(const Eigen::Vector3d& place, std::size_t scale) const {
  return gls_of(fit_sphere(neighbourhood_sums(*this, place, scale)));
}

GlsDerivatives GrowingLeastSquares::derivatives_at(const Eigen::Vector3d& place, std::size_t scale) const {
  const Eigen::Vector3d relative = place - state_->origin;
  const ClusterColumns around = state_->around(relative, scale);
  const double t = state_->scales[scale];
  const GlsSums sums = weighted_sums(around, relative, t);
  const AlgebraicSphere u = fit_sphere(sums);
  GlsDerivatives d;
  const double phi = u.norm2();
  if (gls_of(u).phi == 0) return d;
  const double norm = std::sqrt(phi);
  const auto rates = weighted_sum_rates(around, relative, t);
  for (Eigen::Index k = 0; k < 4; ++k) {
    AlgebraicSphere du = fit_sphere_rate(sums, rates[static_cast<std::size_t>(k)]);
    const double dphi = 2 * u.l.dot(du.l) - 4 * (du.c * u.q + u.c * du.q);  // of the sphere, wherever it is seen from
    // Seen from a place that moves as well.
    if (k < 3) {
      du.c += u.l[k];
      du.l[k] += 2 * u.q;
    }
    d.phi[k] = dphi;
    d.tau[k] = du.c / norm - u.c * dphi / (2 * norm * phi);
    d.kappa[k] = 2 * du.q / norm - u.q * dphi / (norm * phi);
    const double length = u.l.norm();
    const Eigen::Vector3d eta = u.l / length;
    d.eta.col(k) = (du.l - eta * eta.dot(du.l)) / length;
  }
  return d;
}

Expected<std::vector<Gls>> GrowingLeastSquares::at_points(std::size_t scale, const Task& task) const {
  const ClusterGrid& grid = state_->grids[scale];
  const auto place = [&](std::uint32_t point) {
    return Eigen::Vector3d(state_->points.positions[point] - state_->origin);
  };
  const double t = state_->scales[scale];
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order(state_->points.positions.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = {ClusterGrid::key(grid.cell_of(place(i))), i};
  tbb::parallel_sort(order);
  std::vector<std::size_t> starts;  // of cells, and the end
  for (std::size_t i = 0; i < order.size(); ++i)
    if (i == 0 || order[i].first != order[i - 1].first) starts.push_back(i);
  starts.push_back(order.size());
  std::vector<Gls> result(order.size());
  task.report("fitting spheres", 0);
  tbb::parallel_for(std::size_t{0}, starts.size() - 1, [&](std::size_t cell) {
    if (task.stopped()) return;
    thread_local ClusterColumns around;
    thread_local ClusterColumns near;
    around.clear();
    grid.gather(grid.cell_of(place(order[starts[cell]].second)), around);
    around.pad(kBlock);
    const auto points = std::span(order).subspan(starts[cell], starts[cell + 1] - starts[cell]);
    for_groups(points, place, t, [&](auto group) {
      const bool looks = group.size() >= kWorthLooking;
      if (looks) {
        Eigen::AlignedBox3d box;
        for (const auto& [key, point] : group) box.extend(place(point));
        near.clear();
        near.append_near(around, box, t);
        near.pad(kBlock);
      }
      const ClusterColumns& clusters = looks ? near : around;
      for (const auto& [key, point] : group)
        result[point] = gls_of(fit_sphere(weighted_sums(clusters, place(point), t)));
    });
  });
  if (task.stopped()) return cancelled();
  return result;
}

}  // namespace armature::sdk
