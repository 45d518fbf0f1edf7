#include <algorithm>
#include <functional>
#include <map>
#include <numbers>

#include "tools/evaluation/scenes.h"

namespace armature::tools {
namespace {

constexpr double kEnd = Scene::kDuration_s;

/// To one end of a motion, to the other, and back.
MotionTrack to_and_fro(MotionId motion, double amount) {
  return {motion, {{1.0, 0}, {1.5, amount}, {1.75, amount}, {2.35, -amount}, {2.6, -amount}, {kEnd, 0}}};
}

std::vector<ArmKey> both_arms(const ArmPose& pose) {
  return {{1.0, {}, {}}, {1.6, pose, pose}, {2.4, pose, pose}, {kEnd, {}, {}}};
}

std::vector<ArmKey> wave() {
  const ArmPose out = busy_arm(0.55, 0.45, 0.25, 0.5), in = busy_arm(0.15, 0.60, 0.30, 0.5);
  return {{1.0, {}, {}}, {1.5, {}, out}, {1.8, {}, in}, {2.1, {}, out}, {2.4, {}, in}, {kEnd, {}, {}}};
}

std::vector<PoseKey> twice(Activity activity) {
  return {{1.0, {}}, {1.6, activity}, {1.9, activity}, {2.5, activity}, {2.7, activity}, {kEnd + 0.6, {}}};
}

/// One of both sides, by the scene's number.
double side_of(const Scene& scene) {
  return (scene.number & 1) != 0 ? 1 : -1;
}

/// The heading that takes back how far the user of a scene is turned.
double facing_the_camera(const Scene& scene) {
  return -scene.synth.turned_deg * std::numbers::pi / 180;
}

/// Turns to the camera while setting out from one place on the line to it, and walks to another.
std::vector<Waypoint> along(const Scene& scene, double from, double to) {
  const double heading = facing_the_camera(scene);
  return {{1.0, 0, from, 0}, {1.5, 0, from + 0.12 * (to - from), heading}, {kEnd, 0, to, heading}};
}

std::vector<Waypoint> across(const Scene& scene) {
  const double side = side_of(scene), heading = facing_the_camera(scene) + side * std::numbers::pi / 3;
  return {{1.0, -0.6 * side, -0.3, 0}, {1.5, -0.6 * side, -0.3, heading}, {kEnd, 0.6 * side, 0.2, heading}};
}

using Perform = std::function<void(const Scene&, ActorScript&)>;

std::map<std::string, Perform> make_activities() {
  std::map<std::string, Perform> all;
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    const auto motion = static_cast<MotionId>(m);
    if (motion == MotionId::RotateBust) continue;
    all[std::string(kMotionNames[m])] = [motion](const Scene& scene, ActorScript& user) {
      user.motions = {to_and_fro(motion, side_of(scene))};
    };
  }
  all["still"] = [](const Scene&, ActorScript&) {};
  all["steer"] = [](const Scene& scene, ActorScript& user) {
    user.motions = {to_and_fro(MotionId::LeanBust, side_of(scene)), to_and_fro(MotionId::BendKnees, 1)};
  };
  all["wave"] = [](const Scene&, ActorScript& user) { user.arms = wave(); };
  all["before_face"] = [](const Scene&, ActorScript& user) { user.arms = both_arms(busy_arm(-0.18, 0.22, 0.38)); };
  all["cross_arms"] = [](const Scene&, ActorScript& user) {
    user.arms = both_arms(busy_arm(-0.40, -0.36, 0.31, 0.3, 0.3));
  };
  all["raise_arms"] = [](const Scene&, ActorScript& user) {
    const ArmPose sideways = busy_arm(0.95, 0.0, 0.10), up = busy_arm(0.15, 0.95, 0.12);
    user.arms = {{1.0, {}, {}}, {1.5, sideways, sideways}, {1.9, up, up}, {2.3, up, up}, {kEnd, {}, {}}};
  };
  all["reach_ahead"] = [](const Scene&, ActorScript& user) { user.arms = both_arms(busy_arm(0.0, 0.0, 0.95)); };
  all["any_arms"] = [](const Scene&, ActorScript& user) { user.poses = twice(Activity::Stand); };
  all["reach"] = [](const Scene&, ActorScript& user) { user.poses = twice(Activity::Reach); };
  all["lunge"] = [](const Scene&, ActorScript& user) { user.poses = twice(Activity::Lunge); };
  all["squat"] = [](const Scene&, ActorScript& user) { user.poses = twice(Activity::Squat); };
  all["walk_in_place"] = [](const Scene&, ActorScript& user) {
    user.gait = Gait{.from_s = 1, .until_s = 5, .turns_per_s = 0.9, .lift = 0.15};
  };
  all["walk_nearer"] = [](const Scene& scene, ActorScript& user) { user.path = along(scene, -0.7, 0.4); };
  all["walk_backward"] = [](const Scene& scene, ActorScript& user) { user.path = along(scene, 0.0, -0.7); };
  all["walk_across"] = [](const Scene& scene, ActorScript& user) { user.path = across(scene); };
  all["jog"] = [](const Scene&, ActorScript& user) {
    user.gait =
        Gait{.from_s = 1, .until_s = 5, .turns_per_s = 1.35, .lift = 0.28, .arm_swing = 0.35, .elbows_bent = true};
  };
  return all;
}

const std::map<std::string, Perform>& activities() {
  static const std::map<std::string, Perform> kActivities = make_activities();
  return kActivities;
}

/// Where company stands and when it comes, for somebody at the origin. Shoulder to shoulder is half a metre; who stands
/// before the user hides half of her.
ActorScript accompany(const Scene& scene) {
  const double side = side_of(scene), towards = -side * std::numbers::pi / 2;
  const double distance = scene.synth.distance_m;
  const double nearer = std::min(0.65, distance - 1.1), hiding = 0.28 * (distance - nearer) / distance + 0.06;
  ActorScript other;
  switch (scene.company) {
    case Company::None: break;
    case Company::Beside: other.path = {{0, 0.52 * side, -0.10, 0}}; break;
    case Company::Joins:
      other.path = {{0.6, 2.2 * side, -0.1, towards}, {1.8, 0.50 * side, -0.05, towards}, {2.2, 0.50 * side, -0.05, 0}};
      break;
    case Company::Before:
      other.path = {
          {0.6, 1.8 * side, nearer, towards}, {1.7, hiding * side, nearer, towards}, {2.1, hiding * side, nearer, 0}};
      break;
    case Company::Behind: other.path = {{0.6, 1.9 * side, -0.7, towards}, {kEnd, -1.2 * side, -0.6, towards}}; break;
  }
  return other;
}

}  // namespace

const std::vector<std::string>& activity_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const auto& [name, perform] : activities()) names.push_back(name);
    return names;
  }();
  return kNames;
}

Script scene_script(const Scene& scene) {
  Script script;
  script.name = scene.category + "/" + scene.activity;
  script.duration_s = Scene::kDuration_s;
  ActorScript user;
  user.posture = scene.posture;
  activities().at(scene.activity)(scene, user);
  script.actors.push_back(user);
  if (scene.company != Company::None) script.actors.push_back(accompany(scene));
  return script;
}

}  // namespace armature::tools
