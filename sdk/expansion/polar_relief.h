#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>

#include "sdk/expansion/surface_samples.h"

namespace armature::sdk {

/// How a surface rises around an axis: mean heights and areas in rings and sectors, the rings of equal width.
struct PolarRelief {
  static constexpr std::size_t kRings = 5;
  static constexpr std::size_t kSectors = 48;
  using Cells = Eigen::Array<float, kSectors, kRings>;  ///< one ring a column

  Eigen::Matrix3d frame = Eigen::Matrix3d::Identity();  ///< columns: where angles begin, across, and the mean normal
  Cells height = Cells::Zero();                         ///< over the centre, of the radius
  Cells area = Cells::Zero();                           ///< of the radius squared
};

/// The relief of samples within a radius of a centre.
[[nodiscard]] PolarRelief relief_of(std::span<const SurfaceSample> samples, const Eigen::Vector3d& centre,
                                    double radius);

/// The mean squares of what two reliefs differ by, by how many sectors the reference is turned; mirrored before that if
/// it is to be.
[[nodiscard]] std::array<float, PolarRelief::kSectors> differences(const PolarRelief& reference,
                                                                   const PolarRelief& target, bool mirrored);

/// The turn that takes a relief's frame to another's, by a shift.
[[nodiscard]] Eigen::Matrix3d turn_by(const PolarRelief& reference, const PolarRelief& target, std::size_t shift,
                                      bool mirrored);

}  // namespace armature::sdk
