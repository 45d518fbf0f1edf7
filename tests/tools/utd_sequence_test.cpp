#include "tools/evaluation/utd_sequence.h"

#include <gtest/gtest.h>

namespace armature::tools {
namespace {

const std::filesystem::path kFolder = "../shared/data/depth/utd";

TEST(UtdSequence, ARecordingComesWithAPersonAndHerJointsWhereTheDepthShowsHer) {
  if (!std::filesystem::exists(kFolder)) GTEST_SKIP() << kFolder << " is absent";
  const auto sequence = read_utd_sequence(kFolder, "a1_s1_t1");
  ASSERT_TRUE(sequence.has_value()) << sequence.error().message;
  EXPECT_EQ(sequence->action, 1);
  EXPECT_EQ(sequence->person, 1);
  ASSERT_GT(sequence->frame_count(), 30U);
  const Eigen::Vector3f spine = sequence->joints[10][static_cast<std::size_t>(SdkJoint::Spine)];
  const Intrinsics& k = sequence->intrinsics;
  const auto u = static_cast<std::size_t>(k.centre_x_px + k.focal_x_px * spine.x() / spine.z());
  const auto v = static_cast<std::size_t>(k.centre_y_px + k.focal_y_px * spine.y() / spine.z());
  EXPECT_NEAR(sequence->frame(10)[v * 320 + u] * 0.001, spine.z(), 0.25);
}

TEST(UtdSequence, AFolderOrARecordingThatIsNotThereIsNamed) {
  EXPECT_EQ(list_utd_sequences("/nowhere").error().message, "/nowhere: cannot be listed: No such file or directory");
  EXPECT_EQ(read_utd_sequence("/nowhere", "a1_s1_t1").error().message, "/nowhere/a1_s1_t1.u16.zst: cannot be read");
}

}  // namespace
}  // namespace armature::tools
