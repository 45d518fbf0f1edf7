#include "sdk/spheremesh/union_search.h"

#include <algorithm>

#include "sdk/spheremesh/union_moves.h"

namespace armature::sdk {
namespace {

/// The same shape with some more spheres, then as many fewer. Of no use where the task was stopped.
SphereMesh exchanged(const UnionFit& fit, SphereMesh shape, OuterSpace& outer, std::size_t count, int steps,
                     const std::vector<bool>& fixed, const Task& task) {
  const std::size_t wanted = shape.spheres.size();
  outer.follow(UnionGauge(shape));
  std::vector<Eigen::Vector3d> taken;
  for (std::size_t k = 0; k < count && !task.stopped(); ++k) {
    auto more = UnionMoves(fit, shape, outer, fixed).with_another_sphere(taken);
    if (!more) break;
    shape = std::move(*more);
  }
  if (task.stopped()) return shape;
  std::vector<bool> fixed_now = fixed;
  fixed_now.resize(shape.spheres.size(), false);
  {
    SphereMesh repaired;
    static_cast<void>(UnionMoves(fit, shape, outer, fixed_now).repair(repaired));
    shape = std::move(repaired);
  }
  fit.improve(shape, outer, 3, fixed_now, task);
  while (shape.spheres.size() > wanted && !task.stopped()) {
    const std::size_t excess = shape.spheres.size() - wanted;
    outer.follow(UnionGauge(shape));
    fixed_now.resize(shape.spheres.size());
    SphereMesh fewer = UnionMoves(fit, shape, outer, fixed_now).with_fewer_spheres((2 * excess + 2) / 3);
    if (fewer.spheres.size() == shape.spheres.size()) break;
    shape = std::move(fewer);
  }
  fixed_now.resize(shape.spheres.size());
  fit.improve(shape, outer, steps, fixed_now, task);
  return shape;
}

}  // namespace

void search(UnionFit& fit, SphereMesh& shape, const SearchEffort& effort, const std::vector<bool>& fixed,
            const Task& task) {
  OuterSpace outer{UnionGauge(shape)};
  if (effort.rounds == 0) {
    fit.improve(shape, outer, 4 * effort.steps, fixed, task);
    return;
  }
  fit.improve(shape, outer, effort.first_steps, fixed, task);
  constexpr double kLittle = 0.01;  // a round that gains less is the last one
  const std::size_t spheres = shape.spheres.size();
  std::size_t count = std::max<std::size_t>(1, spheres / 10);
  for (int round = 0; round < effort.rounds && count > 0 && !task.stopped(); ++round) {
    task.report("refine", static_cast<double>(round) / effort.rounds);
    const UnionGauge gauge(shape);
    fit.watch_far_vertices(gauge);
    if (task.stopped()) return;
    outer.follow(gauge);
    const double before = fit.error(gauge, outer).loss;
    OuterSpace outer_there = outer;
    SphereMesh tried = exchanged(fit, shape, outer_there, count, effort.steps, fixed, task);
    if (task.stopped()) return;
    const UnionGauge gauge_there(tried);
    outer_there.follow(gauge_there);
    const double after = fit.error(gauge_there, outer_there).loss;
    if (tried.spheres.size() == spheres && after < before * (1 - 5e-4)) {
      shape = std::move(tried);
      outer = std::move(outer_there);
      if (after > before * (1 - kLittle)) break;
    } else {
      count = 2 * count / 3;
    }
  }
  if (task.stopped()) return;
  fit.watch_far_vertices(UnionGauge(shape));
  fit.improve(shape, outer, 2 * effort.steps, fixed, task);
}

}  // namespace armature::sdk
