#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/deformation/skinning.h>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>

namespace armature::sdk {

/// What becomes of the volume of a closed mesh where turns blend.
enum class Volume : std::uint8_t {
  Free,
  KeptByTurns,  ///< kept where spheres only turn
  Kept,         ///< kept unless spheres scale or swell: for motions that are several turns, one after the other
};

class KeptVolume;

/// A level of spheres and the mesh that it moves.
class SkinnedLevel {
 public:
  /// `mesh` as it lies while no sphere has moved, with the spheres where they then are.
  SkinnedLevel(SkinWeights weights, SphereMesh shape, Mesh mesh);
  SkinnedLevel(SkinnedLevel&&) noexcept;
  SkinnedLevel& operator=(SkinnedLevel&&) noexcept;
  ~SkinnedLevel();

  [[nodiscard]] const SkinWeights& weights() const noexcept { return weights_; }  ///< of its spheres
  [[nodiscard]] const SphereMesh& shape() const noexcept { return shape_; }       ///< while nothing has moved
  [[nodiscard]] const Mesh& mesh() const noexcept { return mesh_; }               ///< while nothing has moved

  /// Where all vertices go, [V]. Where spheres swell, the surface goes away from the nearest point of the sphere-mesh
  /// by what they swell, less where it lies further in: a tube becomes thicker, not longer. Then comes `skin()`. The
  /// first time that a sphere swells, what it reaches is looked at. Not thread-safe.
  ///
  /// With dual quaternions and a volume to keep, a closed mesh has the volume afterwards that it had, as far as that
  /// goes: where turns blend, which bulges or thins it, the surface moves along its normals, by at most three
  /// quarters of the spheres' radius (after von Funck, Theisel, Seidel 2008). What turns as a whole stays.
  /// `Volume::KeptByTurns` does so where spheres `only_turn()`; what shifts, screws, stretches or swells means to
  /// change the volume.
  void move(std::span<const SphereMotion> motions, Blend blend, std::span<Eigen::Vector3d> out,
            Volume volume = Volume::Free);

  /// Another level of the same mesh.
  void set_level(SkinWeights weights, SphereMesh shape);
  /// Where mesh and spheres are from now on while nothing has moved: as many of them, elsewhere. What `positions` held
  /// is theirs to reuse.
  void set_rest(std::vector<Eigen::Vector3d>& positions, std::vector<Sphere> spheres);

 private:
  void find_outward(const WeightColumn& column);

  SkinWeights weights_;
  SphereMesh shape_;
  Mesh mesh_;
  std::vector<Eigen::Vector3d> outward_;  // by vertex: where it goes when its sphere swells by 1; empty or found
  std::vector<bool> found_;
  std::unique_ptr<KeptVolume> kept_;  // once a volume was to be kept
};

}  // namespace armature::sdk
