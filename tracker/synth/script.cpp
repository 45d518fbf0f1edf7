#include "tracker/synth/script.h"

#include <algorithm>
#include <array>
#include <numbers>

namespace armature {
namespace {

constexpr double kSideways = std::numbers::pi / 2;

MotionTrack track(MotionId motion, std::vector<Key> keys) {
  return {motion, std::move(keys)};
}

/// Still, to both ends and a little beyond, then half of it to both sides; each time back to zero for a while.
Script alone(MotionId motion) {
  constexpr double kFull = 1.15, kHalf = 0.5;
  Script script;
  script.name = kMotionNames[index(motion)];
  script.description = "stands still for 2 s, then performs this motion alone, both ways, full and half";
  script.duration_s = 15.5;
  script.actors = {ActorScript{}};
  script.actors[0].motions = {track(motion, {{2.0, 0},
                                             {3.0, kFull},
                                             {3.8, kFull},
                                             {4.8, 0},
                                             {5.6, 0},
                                             {6.6, -kFull},
                                             {7.4, -kFull},
                                             {8.4, 0},
                                             {9.2, 0},
                                             {10.0, kHalf},
                                             {10.8, kHalf},
                                             {11.6, 0},
                                             {12.2, 0},
                                             {13.0, -kHalf},
                                             {13.8, -kHalf},
                                             {14.6, 0}})};
  return script;
}

/// One path for all pairs: forward; a bend to the left while walking; forward; stop; a turn to the right on the spot;
/// a bend to the right while walking; a little backwards; stop.
Script pair(char letter, MotionId turn, MotionId walk) {
  Script script;
  script.name = std::string("pair_") + letter;
  script.description = "walks a path: turns with " + std::string(kMotionNames[index(turn)]) + ", walks with " +
                       std::string(kMotionNames[index(walk)]);
  script.duration_s = 21;
  script.steering = Script::Steering{turn, walk};
  script.actors = {ActorScript{}};
  script.actors[0].motions = {track(turn, {{4.0, 0},
                                           {4.7, 0.8},
                                           {6.7, 0.8},
                                           {7.4, 0},
                                           {10.6, 0},
                                           {11.3, -0.9},
                                           {12.6, -0.9},
                                           {13.3, 0},
                                           {14.8, 0},
                                           {15.5, -0.7},
                                           {16.4, -0.7},
                                           {17.1, 0}}),
                              track(walk, {{2.0, 0},
                                           {2.8, 0.9},
                                           {8.4, 0.9},
                                           {9.2, 0},
                                           {13.7, 0},
                                           {14.5, 1.0},
                                           {17.3, 1.0},
                                           {18.1, 0},
                                           {18.4, 0},
                                           {19.0, -0.8},
                                           {19.7, -0.8},
                                           {20.3, 0}})};
  return script;
}

Script arms() {
  const ArmPose wave_out = busy_arm(0.55, 0.45, 0.25, 0.5), wave_in = busy_arm(0.15, 0.60, 0.30, 0.5);
  const ArmPose crossed = busy_arm(-0.40, -0.36, 0.32, 0.3, 0.3), ahead = busy_arm(0.0, 0.0, 0.95);
  const ArmPose sideways = busy_arm(0.95, 0.0, 0.10), phone = busy_arm(-0.02, 0.26, 0.20, 0.3, 0.4);
  const ArmPose hip = busy_arm(0.05, -0.66, 0.08, 0.9, 0.6), up = busy_arm(0.15, 0.95, 0.12);
  Script script;
  script.name = "arms";
  script.description = "stands; waves, reaches, crosses the arms, phones; no motion that navigates";
  script.duration_s = 22;
  script.actors = {ActorScript{}};
  script.actors[0].arms = {{2.0, {}, {}},
                           {2.8, {}, wave_out},
                           {3.2, {}, wave_in},
                           {3.6, {}, wave_out},
                           {4.0, {}, wave_in},
                           {4.4, {}, wave_out},
                           {5.2, {}, {}},
                           {5.8, {}, {}},
                           {6.8, ahead, {}},
                           {7.6, ahead, {}},
                           {8.6, {}, {}},
                           {9.4, crossed, crossed},
                           {11.0, crossed, crossed},
                           {12.0, {}, {}},
                           {12.9, {}, phone},
                           {15.0, {}, phone},
                           {15.9, {}, {}},
                           {16.7, sideways, sideways},
                           {17.4, up, up},
                           {18.1, sideways, sideways},
                           {18.9, {}, {}},
                           {19.8, hip, hip},
                           {20.8, hip, hip},
                           {21.6, {}, {}}};
  return script;
}

std::vector<Waypoint> entering(double from_s) {
  return {{from_s, -2.4, -0.2, kSideways}, {from_s + 2.6, 0, 0, kSideways}, {from_s + 3.4, 0, 0, 0}};
}

void leaving(double from_s, std::vector<Waypoint>& path) {
  path.push_back({from_s, 0, 0, 0});
  path.push_back({from_s + 0.8, 0, 0, kSideways});
  path.push_back({from_s + 3.4, 2.4, -0.2, kSideways});
}

Script walk_in() {
  Script script;
  script.name = "walk_in";
  script.description = "an empty room; somebody walks in, stands still, steers with lean_bust and bend_knees";
  script.duration_s = 16;
  script.rest_s = 6;
  script.steering = Script::Steering{};
  ActorScript user;
  user.path = entering(2);
  user.appears_s = 2;
  user.motions = {track(MotionId::LeanBust, {{10.5, 0}, {11.2, 1}, {12.6, 1}, {13.3, 0}}),
                  track(MotionId::BendKnees, {{8.5, 0}, {9.2, 1}, {14.3, 1}, {15.0, 0}})};
  script.actors = {user};
  return script;
}

Script leave() {
  Script script;
  script.name = "leave";
  script.description = "stands still, steers, then walks out while the room stays empty";
  script.duration_s = 13;
  script.steering = Script::Steering{};
  ActorScript user;
  user.path = {Waypoint{}};
  leaving(7.0, user.path);
  user.leaves_s = 10.4;
  user.motions = {track(MotionId::LeanBust, {{3.0, 0}, {3.7, 1}, {5.0, 1}, {5.7, 0}}),
                  track(MotionId::BendKnees, {{2.5, 0}, {3.2, 1}, {5.6, 1}, {6.4, 0}})};
  script.actors = {user};
  return script;
}

Script second_person() {
  Script script;
  script.name = "second_person";
  script.description = "the user steers while somebody else passes behind her, then stands beside her and goes";
  script.duration_s = 18;
  script.steering = Script::Steering{};
  ActorScript user;
  user.motions = {
      track(MotionId::LeanBust, {{5.0, 0}, {5.7, 1}, {7.5, 1}, {8.2, 0}, {12.5, 0}, {13.2, -1}, {14.5, -1}, {15.2, 0}}),
      track(MotionId::BendKnees, {{2.5, 0}, {3.2, 1}, {9.0, 1}, {9.8, 0}})};
  ActorScript other;
  other.path = {{3.0, -2.6, -0.75, kSideways},   {8.0, 2.4, -0.75, kSideways}, {9.0, 2.4, -0.75, -kSideways},
                {10.8, 0.95, -0.35, -kSideways}, {11.6, 0.95, -0.35, 0},       {14.0, 0.95, -0.35, 0},
                {14.8, 0.95, -0.35, kSideways},  {16.6, 2.6, -0.6, kSideways}};
  other.appears_s = 3.0;
  other.leaves_s = 16.6;
  script.actors = {user, other};
  return script;
}

Script stand() {
  Script script;
  script.name = "stand";
  script.description = "stands still, breathing and swaying a little";
  script.duration_s = 30;
  script.actors = {ActorScript{}};
  return script;
}

Script demo() {
  Script script;
  script.name = "demo";
  script.description = "walks in, stands still, steers with lean_bust and bend_knees, leaves";
  script.duration_s = 21;
  script.rest_s = 4.8;
  script.steering = Script::Steering{};
  ActorScript user;
  user.path = entering(1.0);
  leaving(17.0, user.path);
  user.appears_s = 1.0;
  user.leaves_s = 20.4;
  user.motions = {track(MotionId::LeanBust,
                        {{8.4, 0}, {9.1, 1}, {10.6, 1}, {11.3, 0}, {12.2, 0}, {12.9, -1}, {14.4, -1}, {15.1, 0}}),
                  track(MotionId::BendKnees, {{7.0, 0}, {7.8, 1}, {15.2, 1}, {16.0, 0}})};
  script.actors = {user};
  return script;
}

std::vector<Script> make_scripts() {
  std::vector<Script> all;
  for (const MotionId motion : {MotionId::RotateShoulders, MotionId::RotateHips, MotionId::LeanBust, MotionId::BendBust,
                                MotionId::TranslateHips, MotionId::BendKnees, MotionId::Step}) {
    all.push_back(alone(motion));
  }
  char letter = 'a';
  for (const MotionId turn : {MotionId::RotateShoulders, MotionId::RotateHips, MotionId::LeanBust}) {
    for (const MotionId walk : {MotionId::BendBust, MotionId::BendKnees, MotionId::Step}) {
      all.push_back(pair(letter++, turn, walk));
    }
  }
  for (const auto make : {arms, stand, walk_in, leave, second_person, demo}) all.push_back(make());
  return all;
}

}  // namespace

ArmPose busy_arm(double out, double up, double forward, double swivel, double flex) {
  ArmPose pose;
  pose.wrist = {out, up, forward};
  pose.elbow_swivel = swivel;
  pose.hangs = 0.2;
  pose.wrist_flex = flex;
  return pose;
}

double value_at(std::span<const Key> keys, double time_s) noexcept {
  if (keys.empty()) return 0;
  if (time_s <= keys.front().time_s) return keys.front().value;
  for (std::size_t i = 1; i < keys.size(); ++i) {
    if (time_s >= keys[i].time_s) continue;
    const double share = (time_s - keys[i - 1].time_s) / (keys[i].time_s - keys[i - 1].time_s);
    return keys[i - 1].value + (keys[i].value - keys[i - 1].value) * share * share * (3 - 2 * share);
  }
  return keys.back().value;
}

const std::vector<Script>& scripts() {
  static const std::vector<Script> kScripts = make_scripts();
  return kScripts;
}

const Script* find_script(std::string_view name) {
  for (const Script& script : scripts()) {
    if (script.name == name) return &script;
  }
  return nullptr;
}

}  // namespace armature
