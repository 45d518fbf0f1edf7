#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/spheremesh/primitives.h>

namespace armature::sdk {

/// How a sphere has moved: what moves with it goes from x to after.centre + turn (scale (x - before.centre)).
struct SphereMotion {
  Sphere before = {};                                        ///< where it was
  Sphere after = {};                                         ///< where it is now
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();  ///< of unit length
  double scale = 1;                                          ///< positive

  /// Where a point goes that moves with the sphere.
  [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& x) const noexcept {
    return after.centre + turn * (scale * (x - before.centre));
  }
  /// Whether nothing moves with it; its radius may have changed.
  [[nodiscard]] bool moves_nothing() const noexcept {
    return before.centre == after.centre && scale == 1 && turn.vec().isZero(0);
  }
  /// Whether it has turned about some axis, no farther than `reach` away, if anything: a shift across the axis moves
  /// the axis only, but one that would need it far away is a pull.
  [[nodiscard]] bool only_turns(double reach) const noexcept {
    const Eigen::Vector3d shift = after.centre - before.centre;
    const double rounding = 1e-6 * (shift.norm() + before.radius);
    const double sine = turn.vec().norm();  // of half the angle
    const double along = sine > 0 ? std::abs(shift.dot(turn.vec())) / sine : shift.norm();
    return scale == 1 && after.radius == before.radius && along <= rounding &&
           shift.norm() <= 2 * sine * reach + rounding;
  }
  /// How much its radius has grown beyond what was scaled, in lengths before the scaling.
  [[nodiscard]] double swelling() const noexcept {
    return after.radius == scale * before.radius ? 0 : after.radius / scale - before.radius;
  }
};

/// Whether each sphere stays or turns about some axis no farther away than all of them are long.
[[nodiscard]] bool only_turn(std::span<const SphereMotion> motions);

/// How the motions of several spheres become the one of a vertex.
enum class Blend : std::uint8_t {
  DualQuaternions,  ///< scales are blended linearly, then turns and shifts as dual quaternions (Kavan et al. 2008)
  Linear,           ///< the matrices are blended: thins bends and twists
};

/// Moves every vertex by the spheres that weigh on it, whatever their radii: out[v] is where rest[v] goes; the two may
/// be the same array. Of unmoved spheres nothing is read, vertices that no moved sphere reaches keep their bits, and
/// where all spheres move alike so do the vertices, to rounding. Uses all cores; the same bits on any number of them.
void skin(const SkinWeights& weights, std::span<const SphereMotion> motions, Blend blend,
          std::span<const Eigen::Vector3d> rest, std::span<Eigen::Vector3d> out);

}  // namespace armature::sdk
