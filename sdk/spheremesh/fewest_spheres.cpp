#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include <Eigen/Geometry>
#include <armature/sdk/distance/measure.h>
#include <armature/sdk/distance/outer_surface.h>
#include <armature/sdk/spheremesh/fewest_spheres.h>

namespace armature::sdk {
namespace {

/// Two digits of a mean distance; three are not needed to choose a count.
constexpr std::size_t kSamples = 20'000;

std::string text_of(double percent) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", percent);
  return text;
}

}  // namespace

Expected<SphereMesh> fewest_spheres(const Mesh& mesh, const ErrorBound& bound, const Approximate& approximate,
                                    const Task& task) {
  if (!(bound.percent > 0)) return fail("an error bound of " + text_of(bound.percent) + " %: it must be positive");
  if (bound.least == 0 || bound.least > bound.most) return fail("no number of spheres to choose from");
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : mesh.positions) box.extend(p);
  const double diagonal = box.isEmpty() ? 0 : box.diagonal().norm();
  const std::vector<Eigen::Vector3d> samples = sample_surface(mesh, kSamples);
  if (samples.empty() || !(diagonal > 0)) return fail("a mesh without extent has no error to keep");

  double error = 0;  // of the approximation that was made last
  const auto within = [&](std::size_t spheres) -> Expected<std::optional<SphereMesh>> {
    if (task.stopped()) return cancelled();
    auto shape = approximate(spheres);
    if (!shape) return tl::unexpected(std::move(shape.error()));
    const auto surface = OuterSurface::build(*shape, {}, task);
    if (!surface) return tl::unexpected(surface.error());
    double sum = 0;
    for (const Eigen::Vector3d& p : samples) sum += std::abs(surface->signed_distance(p));
    error = 100 * sum / (static_cast<double>(samples.size()) * diagonal);
    return error <= bound.percent ? std::optional(std::move(*shape)) : std::nullopt;
  };

  std::optional<SphereMesh> best;
  std::size_t too_few = bound.least - 1;
  std::size_t enough = bound.least;
  for (;; enough = std::min(2 * enough, bound.most)) {
    auto shape = within(enough);
    if (!shape) return tl::unexpected(std::move(shape.error()));
    if (*shape) {
      best = std::move(**shape);
      break;
    }
    if (enough == bound.most) {
      return fail("even " + std::to_string(enough) + " spheres leave a mean distance of " + text_of(error) +
                  " %, above " + text_of(bound.percent) + " %");
    }
    too_few = enough;
  }
  while (enough - too_few > 1) {
    const std::size_t middle = too_few + (enough - too_few) / 2;
    auto shape = within(middle);
    if (!shape) return tl::unexpected(std::move(shape.error()));
    if (*shape) best = std::move(**shape);
    (*shape ? enough : too_few) = middle;
  }
  return std::move(*best);
}

}  // namespace armature::sdk
