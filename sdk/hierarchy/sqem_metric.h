#pragma once

#include <algorithm>
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
    double compactness;               ///< what Ward's distance of the two regions adds to the rank
    bool by_increase;                 ///< rank by what a collapse adds to the error, not by the error of the union
    double radius_per_width;          ///< bounds a radius by so many times the region's smallest extent
  };

  /// A fit seen from one of the two spheres.
  struct Fit : SphereFit {
    [[nodiscard]] Eigen::Vector3d& centre() noexcept { return sphere.centre; }
  };

  SqemMetric(const NormalisedShape& shape, const Options& options);

  /// Decides the sphere of a slot once and for all, before the first fit.
  void pin(std::uint32_t slot, const Sphere& sphere);

  /// The best sphere of the union, its centre relative to that of `a`; at infinite cost if both are pinned.
  [[nodiscard]] Fit fit(std::uint32_t a, std::uint32_t b) const noexcept {
    const Eigen::Vector3d offset = spheres_[b].centre - spheres_[a].centre;
    SphericalQuadric quadric = regions_[b].quadric.translated(offset);
    quadric += regions_[a].quadric;
    if (!pinned_.empty() && (pinned_[a] || pinned_[b])) return pinned_fit(quadric, a, b);
    if (!(weight(a) > 0 && weight(b) > 0)) return weightless_fit(a, b);
    return {minimum_of(quadric, Eigen::Vector3d::Zero(), offset, pivot_, [&] {
      return radius_per_width_ * static_cast<double>(smallest_extent(extents_[a], extents_[b]));
    })};
  }

  [[nodiscard]] double cost(std::uint32_t a, std::uint32_t b, const Fit& fit) const noexcept {
    const double planes = by_increase_ ? std::max(fit.cost - regions_[a].error - regions_[b].error, 0.0) : fit.cost;
    return means_.empty() ? planes : planes + compactness_ * apart(a, b);
  }

  /// What it costs to make all of them one.
  [[nodiscard]] double cost(std::span<const std::uint32_t> slots) const noexcept;

  void merge(std::uint32_t kept, std::uint32_t gone, const Fit& from_kept) noexcept {
    Region& region = regions_[kept];
    const Region& other = regions_[gone];
    Sphere& sphere = spheres_[kept];
    if (!means_.empty() && weight(gone) > 0)
      means_[kept] += weight(gone) / (weight(kept) + weight(gone)) * (means_[gone] - means_[kept]);
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

  [[nodiscard]] double weight(std::uint32_t slot) const noexcept { return regions_[slot].quadric.a[9]; }
  /// How far apart two regions are: what their second moments gain by being one (Ward 1963), times their area.
  [[nodiscard]] double apart(std::uint32_t a, std::uint32_t b) const noexcept {
    return 0.5 * weight(a) * weight(b) * (means_[a] - means_[b]).squaredNorm();
  }
  [[nodiscard]] Fit pinned_fit(const SphericalQuadric& quadric, std::uint32_t a, std::uint32_t b) const noexcept;
  /// A region without area joins another for nothing and changes nothing.
  [[nodiscard]] Fit weightless_fit(std::uint32_t a, std::uint32_t b) const noexcept;

  double radius_per_width_;
  double compactness_;
  double pivot_;  // 0 with a regulariser, which leaves no centre undetermined
  bool by_increase_;
  std::vector<Region> regions_;         // by slot
  std::vector<Sphere> spheres_;         // by slot; apart, as flips ask for centres alone
  std::vector<Extents> extents_;        // by slot; apart, as few fits ask for them
  std::vector<bool> pinned_;            // by slot; empty if none is
  std::vector<Eigen::Vector3d> means_;  // by slot: of the region's weighted area; empty without compactness
};

}  // namespace armature::sdk
