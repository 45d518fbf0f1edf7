#pragma once

namespace armature {

/// One person's lengths and girth, metres. The radii of the parts are those of a slim adult of 1.75 m
/// (body_surface.cpp) times `bulk`; head and hands have scales of their own because they grow less than the body does.
struct BodyShape {
  double stature = 1.75;  ///< crown above the floor, standing straight
  double thigh = 0;       ///< hip joint to knee
  double shin = 0;        ///< knee to ankle
  double ankle_height = 0;
  double foot = 0;       ///< ankle to the ball of the foot, along the floor
  double torso = 0;      ///< hip line to shoulder line
  double neck = 0;       ///< shoulder line to the centre of the cranium
  double upper_arm = 0;  ///< shoulder joint to elbow
  double forearm = 0;    ///< elbow to wrist
  double hand = 0;       ///< wrist to the knuckles
  double hip_half_width = 0;
  double shoulder_half_width = 0;
  double shoulder_drop = 0;  ///< shoulder joints below the shoulder line
  double bulk = 1;           ///< of torso and limbs, stature and girth together
  double head_scale = 1;
};

/// The average build of somebody this tall, from a child of 1.2 m (a larger head, shorter legs) to an adult of 2 m.
/// `girth` multiplies the radii of torso and limbs.
[[nodiscard]] BodyShape average_shape(double stature, double girth = 1) noexcept;

/// Hip joints above the floor with straight legs.
[[nodiscard]] double standing_hip_height(const BodyShape& shape) noexcept;

}  // namespace armature
