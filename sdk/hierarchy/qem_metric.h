#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/mesh/normalised_shape.h"

namespace armature::sdk {

/// What a collapse costs by the quadrics of planes of the two regions, and the point that stands for their union
/// (Garland and Heckbert 1997): squared distances to the planes of the triangles, weighted by area, and, where an edge
/// is not between two triangles, to the plane through it that is upright on its triangle. Kept about each slot's point.
class QemMetric {
 public:
  struct Fit {
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< from the slot that it is seen from
    double cost = 0;
    [[nodiscard]] Eigen::Vector3d& centre() noexcept { return offset; }
  };

  /// `boundary_weight`: of those upright planes, times the square of the edge's length.
  QemMetric(const NormalisedShape& shape, double boundary_weight);

  [[nodiscard]] Fit fit(std::uint32_t a, std::uint32_t b) const noexcept;
  /// Nothing bounds a point.
  [[nodiscard]] Fit fit(std::uint32_t a, std::uint32_t b, float) const noexcept { return fit(a, b); }
  [[nodiscard]] float width(std::uint32_t, std::uint32_t) const noexcept { return 0; }
  [[nodiscard]] double cost(std::uint32_t, std::uint32_t, const Fit& fit) const noexcept { return fit.cost; }
  /// What it costs to make all of them one.
  [[nodiscard]] double cost(std::span<const std::uint32_t> slots) const noexcept;
  void merge(std::uint32_t kept, std::uint32_t gone, const Fit& from_kept) noexcept;
  [[nodiscard]] const Eigen::Vector3d& position(std::uint32_t slot) const noexcept { return points_[slot]; }

 private:
  /// x'Ax - 2 b'x + c; A symmetric.
  struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, bx = 0, by = 0, bz = 0, c = 0;

    void add_plane(const Eigen::Vector3d& normal, double offset, double weight) noexcept;
    void add(const Quadric& other, const Eigen::Vector3d& moved_by) noexcept;
    [[nodiscard]] double at(const Eigen::Vector3d& x) const noexcept;
    [[nodiscard]] Eigen::Vector3d times(const Eigen::Vector3d& x) const noexcept;
  };

  /// The point that a quadric is least at; between 0 and `offset` where it does not tell.
  [[nodiscard]] static Fit least_of(const Quadric& q, const Eigen::Vector3d& offset) noexcept;

  std::vector<Quadric> quadrics_;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace armature::sdk
