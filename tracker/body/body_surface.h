#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/spheremesh/primitives.h>

#include "tracker/body/kinematics.h"

namespace armature {

enum class Material : std::uint8_t { Body, Hair, Carried, Floor, Wall, Furniture };

/// How a primitive is cut into parts: by planes across `along` into at most four bands, and by the plane through
/// `origin` across `left` into a left and a right half. `left` zero: all of it is the band's left part.
struct PartCut {
  struct Band {
    double until = 1e9;  ///< upper end, metres from the origin along `along`; the last band is open
    std::uint8_t left = kNoPart;
    std::uint8_t right = kNoPart;
  };
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d along = Eigen::Vector3d::UnitY();
  Eigen::Vector3d left = Eigen::Vector3d::Zero();
  std::array<Band, 4> bands{};
  int band_count = 1;
};

/// The PartLabel (or kNoPart) of a surface point of a primitive cut like this.
[[nodiscard]] std::uint8_t part_at(const PartCut& cut, const Eigen::Vector3d& point) noexcept;

/// One interpolated sphere edge of a body.
struct SurfaceEdge {
  sdk::SphereEdge edge;
  PartCut cut;
  Material material = Material::Body;
};

/// What somebody wears and carries. Lengths in metres.
struct Outfit {
  double cloth = 0.005;       ///< thickness over torso and upper limbs
  double trousers = 0.01;     ///< added to the shins
  double sleeves = 0.005;     ///< added to the forearms
  double skirt = 0;           ///< its length below the hips over that of the thigh; 0: none. A coat is a long skirt
  double skirt_flare = 0.04;  ///< how much wider it is at its hem
  double hair = 0.01;         ///< thickness on the skull; 0: bald
  double hair_length = 0;     ///< how far it falls below the centre of the head; 0: short
  double shoe = 0.006;        ///< added to the feet
  enum class Bag : std::uint8_t { None, Hand, Shoulder, Backpack, Mug, Phone } bag = Bag::None;
  Side bag_side = Side::Right;
  double bag_size = 1;
};

/// Appends the body's surface in the pose to `out` (which is cleared first): a sphere-mesh of about 60 edges, in the
/// body's own frame. Radii: what fitted real silhouettes (slim adult of 1.75 m), times the shape's bulk, plus cloth.
void body_surface(const BodyShape& shape, const PosedBody& body, const Outfit& outfit, std::vector<SurfaceEdge>& out);

/// The same surface after a rigid motion.
[[nodiscard]] SurfaceEdge moved(const SurfaceEdge& edge, const Eigen::Matrix3d& rotation,
                                const Eigen::Vector3d& translation) noexcept;

}  // namespace armature
