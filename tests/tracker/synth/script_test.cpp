#include "tracker/synth/script.h"

#include <set>

#include <gtest/gtest.h>

namespace armature {
namespace {

TEST(Script, AValueGoesSmoothlyFromKeyToKey) {
  const std::vector<Key> keys = {{1, 0}, {2, 4}, {3, 4}};
  EXPECT_EQ(value_at(keys, 0), 0);
  EXPECT_NEAR(value_at(keys, 1.5), 2, 1e-12);
  EXPECT_LT(value_at(keys, 1.1), 0.2) << "starts slowly";
  EXPECT_EQ(value_at(keys, 2.5), 4);
  EXPECT_EQ(value_at(keys, 99), 4);
}

TEST(Script, NamesAreUniqueAndEveryScriptIsFound) {
  std::set<std::string> names;
  for (const Script& script : scripts()) {
    EXPECT_TRUE(names.insert(script.name).second) << script.name;
    EXPECT_EQ(find_script(script.name), &script);
    EXPECT_FALSE(script.actors.empty());
  }
  EXPECT_EQ(find_script("nobody"), nullptr);
  EXPECT_EQ(names.size(), 7U + 9U + 6U);
}

TEST(Script, TheUserStandsStillForASecondAndAHalfBeforeSteering) {
  for (const Script& script : scripts()) {
    for (const MotionTrack& track : script.actors.front().motions) {
      EXPECT_GE(track.keys.front().time_s, script.rest_s + 1.5) << script.name;
    }
  }
}

TEST(Script, KeysAndWaypointsComeInOrder) {
  for (const Script& script : scripts()) {
    for (const ActorScript& actor : script.actors) {
      for (std::size_t i = 1; i < actor.path.size(); ++i) {
        EXPECT_GT(actor.path[i].time_s, actor.path[i - 1].time_s) << script.name;
      }
      for (const MotionTrack& track : actor.motions) {
        for (std::size_t i = 1; i < track.keys.size(); ++i) {
          EXPECT_GT(track.keys[i].time_s, track.keys[i - 1].time_s) << script.name;
        }
      }
    }
  }
}

}  // namespace
}  // namespace armature
