#pragma once

#include <cstdint>

#include "tracker/motions/motion.h"
#include "tracker/synth/person.h"
#include "tracker/synth/scene.h"
#include "tracker/synth/script.h"

namespace armature {

/// From a wanted normalised value of a motion to the amount to perform (motion_poses.h) and back: what a person has to
/// do differs with her build, so it is measured on her. Linear between nine points.
struct MotionCalibration {
  std::array<double, 9> amounts{};
  std::array<double, 9> values{};  ///< increasing

  [[nodiscard]] double amount_for(double value) const noexcept;
};

/// Somebody who plays a part of a script: her pose and place at any time.
class Actor {
 public:
  /// `where`: the world place of the script's origin. Habits (stance, sway, which foot steps) come from the seed.
  Actor(const Person& person, const ActorScript& script, const RigidTransform& where, std::uint64_t seed);

  [[nodiscard]] const Person& person() const noexcept { return person_; }
  [[nodiscard]] bool present(double time_s) const noexcept {
    return time_s >= script_->appears_s && time_s < script_->leaves_s;
  }

  /// The pose in which she stands when she does nothing, without sway.
  [[nodiscard]] const Pose& resting() const noexcept { return resting_; }
  /// That pose with one motion added.
  [[nodiscard]] Pose performing(MotionId motion, double amount) const;

  [[nodiscard]] Pose pose_at(double time_s) const;
  [[nodiscard]] RigidTransform world_from_body_at(double time_s) const;

  void set_calibration(MotionId motion, const MotionCalibration& calibration) {
    calibrations_[index(motion)] = calibration;
  }

 private:
  struct Travel;
  [[nodiscard]] Travel travel_at(double time_s) const;
  void add_arms(double time_s, Pose& pose) const;
  void add_sway(double time_s, Pose& pose) const;

  Person person_;
  const ActorScript* script_;
  RigidTransform where_;
  Pose resting_;
  Side stepping_foot_;
  std::array<double, 4> sway_phase_{};
  double stride_;
  PerMotion<MotionCalibration> calibrations_{};
};

}  // namespace armature
