#include "sdk/hierarchy/sqem_metric.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include <Eigen/Geometry>

namespace armature::sdk {

SqemMetric::SqemMetric(const NormalisedShape& shape, const Options& options)
    : radius_per_width_(options.radius_per_width),
      compactness_(options.compactness),
      pivot_(options.regularise > 0 ? 0 : SphereDomain{}.pivot),
      by_increase_(options.by_increase),
      regions_(shape.positions.size()),
      spheres_(shape.positions.size()),
      extents_(shape.normals.empty() ? Extents::of_cells(shape.positions, shape.triangles)
                                     : Extents::of_discs(shape.positions, shape.normals, shape.areas)) {
  for (std::size_t v = 0; v < spheres_.size(); ++v) spheres_[v].centre = shape.positions[v];
  if (shape.normals.empty())
    add_cells(shape, options);
  else
    add_discs(shape, options);
  if (compactness_ > 0)
    for (const Eigen::Vector3d& position : shape.positions) clouds_.push_back({position});
  for (Region& region : regions_) region.error = region.quadric.c;
}

void SqemMetric::add_cells(const NormalisedShape& shape, const Options& options) {
  for (const auto& triangle : shape.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = triangle[k];
      // About the vertex, so that every plane of its cell passes through the origin.
      const Eigen::Vector3d p = shape.positions[triangle[(k + 1) % 3]] - shape.positions[v];
      const Eigen::Vector3d q = shape.positions[triangle[(k + 2) % 3]] - shape.positions[v];
      const Eigen::Vector3d cross = p.cross(q);
      const double length = cross.norm();
      if (!(length > 0)) continue;
      const double weight = options.weights.empty() ? 1 : options.weights[v];
      regions_[v].quadric += SphericalQuadric::of_plane(Eigen::Vector3d::Zero(), cross / length, weight * length / 6);
      if (!(options.regularise > 0)) continue;
      const Eigen::Vector3d centroid = (p + q) / 3;
      for (const Eigen::Vector3d& middle : {Eigen::Vector3d(p / 2), Eigen::Vector3d(q / 2)})
        regions_[v].quadric += SphericalQuadric::of_triangle_spread({Eigen::Vector3d::Zero(), middle, centroid},
                                                                    weight * options.regularise);
    }
  }
}

void SqemMetric::add_discs(const NormalisedShape& shape, const Options& options) {
  // Two thirds of a disc count at its neighbours, as those of a face do at its other corners.
  constexpr double kShared = 2.0 / 3;
  const auto for_neighbours = [&](const auto& look) {
    for (const auto& triangle : shape.triangles)
      for (const std::uint32_t v : triangle)
        for (const std::uint32_t other : triangle)
          if (v != other) look(v, other);
  };
  std::vector<std::uint32_t> neighbours(regions_.size(), 0);
  for_neighbours([&](std::uint32_t v, std::uint32_t) { ++neighbours[v]; });
  const auto weight = [&](std::size_t v) {
    return (options.weights.empty() ? 1 : options.weights[v]) * shape.areas[v];
  };
  for (std::size_t v = 0; v < regions_.size(); ++v) {
    if (!(weight(v) > 0)) continue;
    SphericalQuadric& quadric = regions_[v].quadric;
    quadric += SphericalQuadric::of_plane(Eigen::Vector3d::Zero(), shape.normals[v],
                                          (neighbours[v] > 0 ? 1 - kShared : 1) * weight(v));
    if (!(options.regularise > 0)) continue;
    // The integral of |q - x|^2 over a disc about the origin: area (|q|^2 + radius^2 / 2).
    quadric += SphericalQuadric::of_point(Eigen::Vector3d::Zero(), options.regularise * weight(v));
    quadric.c += options.regularise * weight(v) * shape.areas[v] / (2 * std::numbers::pi);
  }
  for_neighbours([&](std::uint32_t v, std::uint32_t other) {
    if (weight(v) > 0)
      regions_[other].quadric += SphericalQuadric::of_plane(shape.positions[v] - shape.positions[other],
                                                            shape.normals[v], kShared / neighbours[v] * weight(v));
  });
}

void SqemMetric::pin(std::uint32_t slot, const Sphere& sphere) {
  pinned_.resize(regions_.size(), false);
  pinned_[slot] = true;
  Region& region = regions_[slot];
  region.quadric = region.quadric.translated(spheres_[slot].centre - sphere.centre);
  spheres_[slot] = sphere;
  region.error = std::max(region.quadric({Eigen::Vector3d::Zero(), sphere.radius}), 0.0);
}

double SqemMetric::cost(std::span<const std::uint32_t> slots) const noexcept {
  const auto is_pinned = [&](std::uint32_t slot) { return bool{pinned_[slot]}; };
  const auto pins = pinned_.empty() ? 0 : std::ranges::count_if(slots, is_pinned);
  if (pins > 1) return std::numeric_limits<double>::infinity();
  const std::uint32_t a = slots.front();
  SphericalQuadric quadric = regions_[a].quadric;
  Extents extents = extents_[a];
  double errors = regions_[a].error;
  double area = weight(a);
  Cloud cloud = clouds_.empty() ? Cloud{spheres_[a].centre} : clouds_[a];
  double misfits = cloud.misfit;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  for (const std::uint32_t b : slots.subspan(1)) {
    offset = spheres_[b].centre - spheres_[a].centre;
    quadric += regions_[b].quadric.translated(offset);
    extents |= extents_[b];
    errors += regions_[b].error;
    if (!clouds_.empty()) {
      cloud = united(cloud, area, clouds_[b], weight(b));
      area += weight(b);
      misfits += clouds_[b].misfit;
    }
  }
  Fit fit;
  if (pins == 1) {
    const Sphere& sphere = spheres_[*std::ranges::find_if(slots, is_pinned)];
    fit.sphere = {sphere.centre - spheres_[a].centre, sphere.radius};
    fit.cost = std::max(quadric(fit.sphere), 0.0);
  } else {
    fit = {minimum_of(quadric, Eigen::Vector3d::Zero(), offset, pivot_,
                      [&] { return radius_per_width_ * static_cast<double>(smallest_extent(extents, extents)); })};
  }
  const double planes = by_increase_ ? std::max(fit.cost - errors, 0.0) : fit.cost;
  if (clouds_.empty()) return planes;
  return planes + compactness_ * std::max(misfit(cloud, area, seen(fit, a)) - misfits, 0.0);
}

SqemMetric::Fit SqemMetric::pinned_fit(const SphericalQuadric& quadric, std::uint32_t a,
                                       std::uint32_t b) const noexcept {
  const Sphere& sphere = spheres_[pinned_[a] ? a : b];
  const Sphere seen_from_a{sphere.centre - spheres_[a].centre, sphere.radius};
  const double cost =
      pinned_[a] && pinned_[b] ? std::numeric_limits<double>::infinity() : std::max(quadric(seen_from_a), 0.0);
  return {{seen_from_a, cost, FitCase::Interior}};
}

SqemMetric::Fit SqemMetric::weightless_fit(std::uint32_t a, std::uint32_t b) const noexcept {
  const Eigen::Vector3d offset = spheres_[b].centre - spheres_[a].centre;
  if (weight(a) > 0) return {{{Eigen::Vector3d::Zero(), spheres_[a].radius}, 0, FitCase::AtRadius}};
  if (weight(b) > 0) return {{{offset, spheres_[b].radius}, 0, FitCase::AtRadius}};
  return {{{0.5 * offset, 0}, 0, FitCase::AtMidpoint}};
}

}  // namespace armature::sdk
