#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "sdk/hierarchy/extents.h"
#include "sdk/mesh/normalised_shape.h"
#include "sdk/spheremesh/quadric_minimum.h"

namespace armature::sdk {

/// What a collapse costs by the spherical quadrics of the two regions, and the sphere that stands for their union.
/// Every quadric is kept in coordinates about its own sphere's centre, where its terms are small: about the model's
/// centre rounding would decide between collapses of fine meshes, and the answer would change with the model's place.
class SqemMetric {
 public:
  struct Options {
    std::span<const double> weights;  ///< the importance by vertex, or empty: 1
    double regularise;                ///< eps
    double compactness;               ///< what distances of points from spheres add to the rank
    bool by_increase;                 ///< rank by what a collapse adds to the error, not by the error of the union
    double radius_per_width;          ///< bounds a radius by so many times the region's smallest extent
  };

  /// A fit seen from one of the two spheres.
  struct Fit : SphereFit {
    [[nodiscard]] Eigen::Vector3d& centre() noexcept { return sphere.centre; }
  };

  /// Regions are at first the cells of a mesh's vertices, or points as flat discs of their areas.
  SqemMetric(const NormalisedShape& shape, const Options& options);

  /// Decides the sphere of a slot once and for all, before the first fit.
  void pin(std::uint32_t slot, const Sphere& sphere);

  /// The best sphere of the union, its centre relative to that of `a`; at infinite cost if both are pinned.
  [[nodiscard]] Fit fit(std::uint32_t a, std::uint32_t b) const noexcept {
    return best_of(a, b, [&] { return width(a, b); });
  }
  /// The same as if the union were so wide.
  [[nodiscard]] Fit fit(std::uint32_t a, std::uint32_t b, float width) const noexcept {
    return best_of(a, b, [&] { return width; });
  }
  /// The smallest extent of the union, which bounds the radius.
  [[nodiscard]] float width(std::uint32_t a, std::uint32_t b) const noexcept {
    return smallest_extent(extents_[a], extents_[b]);
  }

  [[nodiscard]] double cost(std::uint32_t a, std::uint32_t b, const Fit& fit) const noexcept {
    const double planes = by_increase_ ? std::max(fit.cost - regions_[a].error - regions_[b].error, 0.0) : fit.cost;
    if (clouds_.empty()) return planes;
    const double points = misfit(united(a, b), weight(a) + weight(b), seen(fit, a));
    return planes + compactness_ * std::max(points - clouds_[a].misfit - clouds_[b].misfit, 0.0);
  }

  /// What it costs to make all of them one.
  [[nodiscard]] double cost(std::span<const std::uint32_t> slots) const noexcept;

  void merge(std::uint32_t kept, std::uint32_t gone, const Fit& from_kept) noexcept {
    Region& region = regions_[kept];
    const Region& other = regions_[gone];
    Sphere& sphere = spheres_[kept];
    if (!clouds_.empty()) {
      clouds_[kept] = united(kept, gone);
      clouds_[kept].misfit = misfit(clouds_[kept], weight(kept) + weight(gone), seen(from_kept, kept));
    }
    SphericalQuadric quadric = other.quadric.translated(spheres_[gone].centre - sphere.centre);
    quadric += region.quadric;
    region.quadric = quadric.translated(-from_kept.sphere.centre);
    sphere = {sphere.centre + from_kept.sphere.centre, from_kept.sphere.radius};
    region.error = from_kept.cost;
    extents_[kept] |= extents_[gone];
    if (!pinned_.empty() && pinned_[gone]) pinned_[kept] = true;
  }

  [[nodiscard]] const Sphere& sphere(std::uint32_t slot) const noexcept { return spheres_[slot]; }
  [[nodiscard]] const Eigen::Vector3d& position(std::uint32_t slot) const noexcept { return spheres_[slot].centre; }

 private:
  /// What stands in a slot beside its sphere: two lines of the cache.
  struct alignas(64) Region {
    SphericalQuadric quadric;  ///< about the sphere's centre
    double error = 0;          ///< of the sphere
  };

  /// The points of a region.
  struct Cloud {
    Eigen::Vector3d mean;
    double spread = 0;  ///< the integral of |x - mean|^2
    double misfit = 0;  ///< of the sphere
  };

  [[nodiscard]] double weight(std::uint32_t slot) const noexcept { return regions_[slot].quadric.a[9] / 2; }
  [[nodiscard]] Sphere seen(const Fit& fit, std::uint32_t from) const noexcept {
    return {spheres_[from].centre + fit.sphere.centre, fit.sphere.radius};
  }
  [[nodiscard]] Cloud united(std::uint32_t a, std::uint32_t b) const noexcept {
    return united(clouds_[a], weight(a), clouds_[b], weight(b));
  }
  [[nodiscard]] static Cloud united(const Cloud& a, double area, const Cloud& b, double other) noexcept {
    if (!(area + other > 0)) return a;
    const double part = other / (area + other);
    const Eigen::Vector3d offset = b.mean - a.mean;
    return {a.mean + part * offset, a.spread + b.spread + area * part * offset.squaredNorm()};
  }
  /// How far points lie from a sphere beyond it, squared, times their area; as if all lay equally far from its centre.
  /// Planes know nothing of it: those of a cylinder, however long, touch one sphere within.
  [[nodiscard]] static double misfit(const Cloud& cloud, double area, const Sphere& sphere) noexcept {
    if (!(area > 0)) return 0;
    const double squared = cloud.spread / area + (sphere.centre - cloud.mean).squaredNorm();
    const double beyond = std::max(std::sqrt(squared) - sphere.radius, 0.0);
    return area * beyond * beyond;
  }
  template <class Width>
  [[nodiscard]] Fit best_of(std::uint32_t a, std::uint32_t b, Width&& width) const noexcept {
    const Eigen::Vector3d offset = spheres_[b].centre - spheres_[a].centre;
    SphericalQuadric quadric = regions_[b].quadric.translated(offset);
    quadric += regions_[a].quadric;
    if (!pinned_.empty() && (pinned_[a] || pinned_[b])) return pinned_fit(quadric, a, b);
    if (!(weight(a) > 0 && weight(b) > 0)) return weightless_fit(a, b);
    return {minimum_of(quadric, Eigen::Vector3d::Zero(), offset, pivot_,
                       [&] { return radius_per_width_ * static_cast<double>(width()); })};
  }
  void add_cells(const NormalisedShape& shape, const Options& options);
  void add_discs(const NormalisedShape& shape, const Options& options);
  [[nodiscard]] Fit pinned_fit(const SphericalQuadric& quadric, std::uint32_t a, std::uint32_t b) const noexcept;
  /// A region without area joins another for nothing and changes nothing.
  [[nodiscard]] Fit weightless_fit(std::uint32_t a, std::uint32_t b) const noexcept;

  double radius_per_width_;
  double compactness_;
  double pivot_;  // 0 with a regulariser, which leaves no centre undetermined
  bool by_increase_;
  std::vector<Region> regions_;   // by slot
  std::vector<Sphere> spheres_;   // by slot; apart, as flips ask for centres alone
  std::vector<Extents> extents_;  // by slot; apart, as few fits ask for them
  std::vector<bool> pinned_;      // by slot; empty if none is
  std::vector<Cloud> clouds_;     // by slot; empty without compactness
};

}  // namespace armature::sdk
