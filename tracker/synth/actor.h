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

  /// Of the chair under somebody who sits, metres; 0 for whoever stands.
  [[nodiscard]] double seat_height() const noexcept { return seat_height_; }

  [[nodiscard]] Pose pose_at(double time_s) const;
  [[nodiscard]] RigidTransform world_from_body_at(double time_s) const;

  void set_calibration(MotionId motion, const MotionCalibration& calibration) {
    calibrations_[index(motion)] = calibration;
  }

 private:
  struct Travel;
  void rest_otherwise(std::uint64_t seed);
  void draw_poses(std::uint64_t seed);
  [[nodiscard]] Travel travel_at(double time_s) const;
  void add_poses(double time_s, Pose& pose) const;
  void add_gait(double time_s, Pose& pose) const;
  void keep_busy_arm(const Pose& from, Pose& pose) const;
  void add_arms(double time_s, Pose& pose) const;
  void add_sway(double time_s, Pose& pose) const;

  Person person_;
  const ActorScript* script_;
  RigidTransform where_;
  Pose resting_;
  double seat_height_ = 0;
  std::vector<Pose> drawn_;  // one a pose key; the resting one where it has no activity
  Side stepping_foot_;
  std::array<double, 4> sway_phase_{};
  double stride_;
  PerMotion<MotionCalibration> calibrations_{};
};

}  // namespace armature
