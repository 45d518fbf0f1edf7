#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "tracker/body/pose.h"
#include "tracker/motions/motion.h"
#include "tracker/synth/random_poses.h"

namespace armature {

/// A value at a time; between two keys it goes smoothly from one to the other, before the first and after the last it
/// rests.
struct Key {
  double time_s = 0;
  double value = 0;
};
[[nodiscard]] double value_at(std::span<const Key> keys, double time_s) noexcept;

/// How much of a motion is performed, in its normalised unit (1 = its full range).
struct MotionTrack {
  MotionId motion = MotionId::LeanBust;
  std::vector<Key> keys;
};

/// Where somebody is on the floor, relative to the place where the user of the script stands: `x` to the camera's right
/// and `nearer` to the camera, metres; heading to her left from facing the camera.
struct Waypoint {
  double time_s = 0;
  double x = 0;
  double nearer = 0;
  double heading = 0;
};

/// Both arms at a time, as ArmPose has them; `right` and `left` where they differ from hanging.
struct ArmKey {
  double time_s = 0;
  std::optional<ArmPose> left;
  std::optional<ArmPose> right;
};

/// A pose drawn from an activity at a time, or the resting one; smoothly from one to the other. Of Stand only the arms
/// are drawn; of Lunge and Squat the deepest of three.
struct PoseKey {
  double time_s = 0;
  std::optional<Activity> activity;
};

/// Walking or jogging on the spot for a while.
struct Gait {
  double from_s = 0;
  double until_s = 0;
  double turns_per_s = 1;  ///< one turn is two steps
  double stride = 0;       ///< metres, as for walk() (random_poses.h)
  double lift = 0.1;
  double arm_swing = 0.2;
  bool elbows_bent = false;
};

/// How somebody rests.
enum class Posture : std::uint8_t { Standing, LegsTogether, Chair, Wheelchair };

/// An arm that does something, moving with the chest for the most part: the wrist as in ArmPose.
[[nodiscard]] ArmPose busy_arm(double out, double up, double forward, double swivel = 0.1, double flex = 0);

struct ActorScript {
  Posture posture = Posture::Standing;
  std::vector<Waypoint> path = {Waypoint{}};
  double appears_s = -1e9;  ///< is in the room from then
  double leaves_s = 1e9;    ///< until then
  std::vector<MotionTrack> motions;
  std::vector<ArmKey> arms;
  std::vector<PoseKey> poses;
  std::optional<Gait> gait;
};

/// What happens before the camera, for named synthetic sources.
struct Script {
  std::string name;
  std::string description;  ///< one line for --help
  double duration_s = 0;
  double rest_s =
      0;  ///< from then on the user stands still for at least 1.5 s, in the pose that motions are held against
  std::vector<ActorScript> actors;  ///< the first one is the user
  /// The pair of motions that the script steers with, where it does.
  struct Steering {
    MotionId turn = MotionId::LeanBust;
    MotionId walk = MotionId::BendKnees;
  };
  std::optional<Steering> steering;
};

/// Every script: each motion alone, pair_a to pair_i of section 3.5.3, arms, stand, walk_in, leave, second_person,
/// demo.
[[nodiscard]] const std::vector<Script>& scripts();

/// Null where there is none of this name.
[[nodiscard]] const Script* find_script(std::string_view name);

}  // namespace armature
