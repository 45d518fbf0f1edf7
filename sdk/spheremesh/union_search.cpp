#include "sdk/spheremesh/union_search.h"

#include <algorithm>

#include "sdk/spheremesh/union_moves.h"

namespace armature::sdk {
namespace {

/// The same shape with some more spheres, then as many fewer.
SphereMesh exchanged(const UnionFit& fit, SphereMesh shape, std::size_t count, int steps,
                     const std::vector<bool>& fixed, const Task& task) {
  const std::size_t wanted = shape.spheres.size();
  const OuterSpace outer{UnionGauge(shape)};
  std::vector<Eigen::Vector3d> taken;
  for (std::size_t k = 0; k < count && !task.stopped(); ++k) {
    auto more = UnionMoves(fit, shape, outer, fixed).with_another_sphere(taken);
    if (!more) break;
    shape = std::move(*more);
  }
  std::vector<bool> fixed_now = fixed;
  fixed_now.resize(shape.spheres.size(), false);
  {
    SphereMesh repaired;
    static_cast<void>(UnionMoves(fit, shape, outer, fixed_now).repair(repaired));
    shape = std::move(repaired);
  }
  fit.improve(shape, 3, fixed_now, task);
  while (shape.spheres.size() > wanted && !task.stopped()) {
    const std::size_t excess = shape.spheres.size() - wanted;
    const OuterSpace now{UnionGauge(shape)};
    fixed_now.resize(shape.spheres.size());
    SphereMesh fewer = UnionMoves(fit, shape, now, fixed_now).with_fewer_spheres((2 * excess + 2) / 3);
    if (fewer.spheres.size() == shape.spheres.size()) break;
    shape = std::move(fewer);
  }
  fixed_now.resize(shape.spheres.size());
  fit.improve(shape, steps, fixed_now, task);
  return shape;
}

}  // namespace

void search(UnionFit& fit, SphereMesh& shape, const SearchEffort& effort, const std::vector<bool>& fixed,
            const Task& task) {
  if (effort.rounds == 0) {
    fit.improve(shape, 4 * effort.steps, fixed, task);
    return;
  }
  fit.improve(shape, 2 * effort.steps, fixed, task);
  const std::size_t spheres = shape.spheres.size();
  std::size_t count = std::max<std::size_t>(1, spheres / 10);
  for (int round = 0; round < effort.rounds && count > 0 && !task.stopped(); ++round) {
    task.report("refine", static_cast<double>(round) / effort.rounds);
    fit.watch_far_vertices(UnionGauge(shape));
    const double before = fit.error(shape).loss;
    SphereMesh tried = exchanged(fit, shape, count, effort.steps, fixed, task);
    const double after = fit.error(tried).loss;
    if (tried.spheres.size() == spheres && after < before * (1 - 5e-4))
      shape = std::move(tried);
    else
      count = 2 * count / 3;
  }
  fit.watch_far_vertices(UnionGauge(shape));
  fit.improve(shape, 2 * effort.steps, fixed, task);
}

}  // namespace armature::sdk
