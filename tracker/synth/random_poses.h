#pragma once

#include <string_view>

#include "tracker/body/pose.h"
#include "tracker/synth/person.h"
#include "tracker/synth/random.h"

namespace armature {

/// What somebody in front of the sensor may be doing.
enum class Activity : std::uint8_t { Stand, Steer, Walk, Jog, Lunge, Squat, Sit, Reach };
inline constexpr std::array<std::string_view, 8> kActivityNames = {"stand", "steer", "walk", "jog",
                                                                   "lunge", "squat", "sit",  "reach"};

struct RandomPose {
  Activity activity = Activity::Stand;
  Pose pose;
  double seat_height = 0;  ///< of the chair under somebody who sits
};

/// A pose from all that people do: legs by activity, arms independently of them (hanging flush with the body, carrying
/// a mug or a phone, hands on hips, crossed, before the face, raised, anywhere within reach), the head looking around.
[[nodiscard]] RandomPose random_pose(const Person& person, Random& random);
[[nodiscard]] RandomPose random_pose(const Person& person, Activity activity, Random& random);

/// Both arms of a pose; `together` of them do the same thing in a third of all cases.
void random_arms(const Person& person, Random& random, Pose& pose);

/// Legs and arms of somebody who walks: `phase` in turns, 0 = right foot lands; `stride` metres from one foot to the
/// other; the raised foot passes `lift` above the floor, its knee bending. stride 0 is walking in place.
void walk(double phase, double stride, double lift, double arm_swing, Pose& pose);
/// Somebody who sits, moved from a chair into a wheelchair: higher, her feet on the rests.
void raise_onto_footrests(RandomPose& sitting);

/// The arms of somebody who jogs, out of those that walk() gave her.
void bend_elbows(Pose& pose);

}  // namespace armature
