// Recorded people (UTD-MHAD), where the recordings are there: nothing of them is in this project.
#include <cstdio>
#include <filesystem>

#include <gtest/gtest.h>

#include "tools/evaluation/utd_sequence.h"
#include "tracker/installation.h"
#include "tracker/pipeline.h"

namespace armature {
namespace {

const std::filesystem::path kFolder = "../shared/data/depth/utd";
constexpr int kRestFrames = 10;

struct Played {
  int frames = 0, tracked = 0, after_rest = 0, standing = 0;
  float knees = 0, step = 0;  // largest normalised value
};

Played play(const tools::UtdSequence& sequence, const std::shared_ptr<const Forest>& forest) {
  TrackerOptions options;
  options.rest.mode = RestMode::Auto;
  Pipeline pipeline(forest, options);
  Played out;
  for (std::size_t i = 0; i < sequence.frame_count(); ++i) {
    const Timestamp time{std::chrono::nanoseconds(33'333'333) * static_cast<long>(i), ClockId::Recording};
    const TrackerOutput& output = pipeline.process({sequence.frame(i), sequence.intrinsics, i, time, time});
    ++out.frames;
    out.tracked += output.tracking;
    if (out.tracked <= kRestFrames) continue;
    const Navigation& navigation = output.navigation;
    ++out.after_rest;
    out.standing += navigation.velocity.linear_m_s == 0 && navigation.velocity.angular_rad_s == 0;
    out.knees = std::max(out.knees, std::abs(navigation.motions[index(MotionId::BendKnees)].normalized));
    out.step = std::max(out.step, std::abs(navigation.motions[index(MotionId::Step)].normalized));
  }
  return out;
}

TEST(RealPeople, AreTrackedSteerWithTheirLegsAndDoNotWithTheirArms) {
  if (!std::filesystem::exists(kFolder)) GTEST_SKIP() << "no recordings at " << kFolder;
  auto model = Forest::load(installed_model());
  ASSERT_TRUE(model) << model.error().message;
  const auto forest = std::make_shared<const Forest>(std::move(*model));
  const auto names = tools::list_utd_sequences(kFolder);
  ASSERT_TRUE(names) << names.error().message;

  int frames = 0, tracked = 0, arms_after_rest = 0, arms_standing = 0;
  for (const std::string& name : *names) {
    const auto sequence = tools::read_utd_sequence(kFolder, name);
    ASSERT_TRUE(sequence) << sequence.error().message;
    const Played played = play(*sequence, forest);
    frames += played.frames;
    tracked += played.tracked;
    const int action = sequence->action;
    if ((action >= 1 && action <= 4) || action == 18 || action == 19) {
      arms_after_rest += played.after_rest;
      arms_standing += played.standing;
    }
    if (action == 22 || action == 23 || action == 26) {  // jog, walk in place, lunge
      EXPECT_GT(std::max(played.knees, played.step), 0.4F) << name;
    }
  }
  std::printf("%zu sequences, %d frames: %.2f %% tracked; arms only: both velocities zero in %.2f %% of %d frames\n",
              names->size(), frames, 100.0 * tracked / frames, 100.0 * arms_standing / arms_after_rest,
              arms_after_rest);
  EXPECT_GE(tracked, 0.95 * frames);
  EXPECT_GE(arms_standing, 0.95 * arms_after_rest);
}

}  // namespace
}  // namespace armature
