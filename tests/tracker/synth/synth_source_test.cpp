#include "tracker/synth/synth_source.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tracker/synth/open_source.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

std::unique_ptr<SynthSource> opened(const std::string& name) {
  auto source = SynthSource::open(name);
  EXPECT_TRUE(source) << (source ? "" : source.error().message);
  return source ? std::move(*source) : nullptr;
}

/// What the truth says over a whole script.
struct Spans {
  PerMotion<float> least{}, most{};
  float feet_moved = 0;  ///< the farthest that an ankle goes from where it rests, metres
};

Spans spans_of(const std::string& name) {
  auto source = opened(name);
  Spans spans;
  DepthFrame frame;
  const MotionOptions options;
  while (*source->read(frame, 0ms) == ReadStatus::Frame) {
    const FrameTruth& truth = source->truth();
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      const float value = truth.motions.angle_rad[m] / options.range_rad[m];
      spans.least[m] = std::min(spans.least[m], value);
      spans.most[m] = std::max(spans.most[m], value);
    }
    for (const JointId ankle : {JointId::LeftAnkle, JointId::RightAnkle}) {
      const float moved = (truth.skeleton[ankle].position - source->rest().skeleton[ankle].position).norm();
      spans.feet_moved = std::max(spans.feet_moved, moved);
    }
  }
  return spans;
}

/// Motions that come with one another by what bodies are: knees for a step, the head behind the knees' midpoint.
bool comes_along(MotionId motion, MotionId other) {
  const auto legs = [](MotionId m) { return m == MotionId::BendKnees || m == MotionId::Step; };
  const auto turns = [](MotionId m) { return m == MotionId::RotateShoulders || m == MotionId::RotateHips; };
  return (legs(motion) && (legs(other) || other == MotionId::BendBust)) ||
         (turns(motion) && other == MotionId::RotateBust);
}

class Alone : public testing::TestWithParam<MotionId> {};

TEST_P(Alone, MovesItsOwnMotionOverItsRangeAndTheOthersLittle) {
  const MotionId motion = GetParam();
  for (const char* seed : {"1", "2", "5"}) {
    const std::string name = std::string(kMotionNames[index(motion)]) + "?size=64x48&noise=0&fps=15&seed=" + seed;
    const Spans spans = spans_of(name);
    EXPECT_GE(spans.most[index(motion)], 1.0F) << name;
    EXPECT_LE(spans.least[index(motion)], -1.0F) << name;
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      const auto other = static_cast<MotionId>(m);
      if (other == motion) continue;
      const float most = std::max(spans.most[m], -spans.least[m]);
      // A dead zone is at least 0.2 of the range.
      if (!comes_along(motion, other)) {
        EXPECT_LT(most, 0.2F) << name << ": " << kMotionNames[m];
      } else if (other == MotionId::BendBust) {
        EXPECT_LT(most, 0.5F) << name;
      }
    }
    if (motion != MotionId::Step && motion != MotionId::BendKnees) {
      EXPECT_LT(spans.feet_moved, 0.002F) << name;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(SevenMotions, Alone,
                         testing::Values(MotionId::RotateShoulders, MotionId::RotateHips, MotionId::LeanBust,
                                         MotionId::BendBust, MotionId::TranslateHips, MotionId::BendKnees,
                                         MotionId::Step),
                         [](const auto& parameter) { return std::string(kMotionNames[index(parameter.param)]); });

TEST(SynthSource, ArmsAloneMoveNoMotion) {
  const Spans spans = spans_of("arms?size=64x48&noise=0&fps=15&seed=3");
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    EXPECT_LT(std::max(spans.most[m], -spans.least[m]), 0.1F) << kMotionNames[m];
  }
}

TEST(SynthSource, EveryPairReachesItsPlannedValues) {
  for (const Script& script : scripts()) {
    if (!script.name.starts_with("pair_")) continue;
    const Spans spans = spans_of(script.name + "?size=64x48&noise=0&fps=10&seed=4");
    const auto turn = index(script.steering->turn), walk = index(script.steering->walk);
    EXPECT_NEAR(spans.most[turn], 0.8F, 0.15F) << script.name;
    EXPECT_NEAR(spans.least[turn], -0.9F, 0.15F) << script.name;
    EXPECT_GT(spans.most[walk], 0.85F) << script.name;
    EXPECT_LT(spans.least[walk], -0.65F) << script.name;
  }
}

TEST(SynthSource, TheSameSeedGivesTheSameBytes) {
  auto a = opened("demo?size=80x60&seed=9"), b = opened("demo?size=80x60&seed=9"), c = opened("demo?size=80x60&seed=8");
  DepthFrame x, y, z;
  bool differs = false;
  for (int i = 0; i < 150; ++i) {
    ASSERT_TRUE(a->read(x, 0ms) && b->read(y, 0ms) && c->read(z, 0ms));
    ASSERT_EQ(x.depth_mm, y.depth_mm) << "frame " << i;
    differs = differs || x.depth_mm != z.depth_mm;
  }
  EXPECT_TRUE(differs);
}

TEST(SynthSource, NobodyIsThereBeforeTheUserWalksInAndAfterSheLeft) {
  auto source = opened("demo?size=80x60&fps=10");
  DepthFrame frame;
  std::vector<int> pixels;
  while (*source->read(frame, 0ms) == ReadStatus::Frame) {
    int count = 0;
    for (const std::uint8_t owner : source->truth().owner) count += owner == 1;
    pixels.push_back(count);
    if (!source->truth().present) {
      EXPECT_EQ(count, 0);
      EXPECT_EQ(source->truth().skeleton[JointId::Head].state, JointState::Lost);
    }
  }
  EXPECT_EQ(pixels.front(), 0);
  EXPECT_GT(pixels[60], 200);
  EXPECT_EQ(pixels.back(), 0);
}

TEST(SynthSource, ASecondPersonHasPixelsOfHerOwn) {
  auto source = opened("second_person?size=80x60&fps=5");
  DepthFrame frame;
  int both = 0;
  while (*source->read(frame, 0ms) == ReadStatus::Frame) {
    int first = 0, second = 0;
    for (const std::uint8_t owner : source->truth().owner) {
      first += owner == 1;
      second += owner == 2;
    }
    both += first > 100 && second > 50;
  }
  EXPECT_GT(both, 15);
}

TEST(SynthSource, JointsProjectOntoThePixelsOfTheirParts) {
  auto source = opened("stand?size=320x240&seed=2");
  DepthFrame frame;
  ASSERT_TRUE(source->read(frame, 0ms));
  const Intrinsics& k = frame.intrinsics;
  const auto part_at_joint = [&](JointId joint) {
    const Eigen::Vector3f p = source->truth().skeleton[joint].position;
    const auto u = std::lround(k.centre_x_px + k.focal_x_px * static_cast<double>(p.x() / p.z()));
    const auto v = std::lround(k.centre_y_px + k.focal_y_px * static_cast<double>(p.y() / p.z()));
    return source->truth().part[static_cast<std::size_t>(v * k.width + u)];
  };
  EXPECT_EQ(part_at_joint(JointId::LeftThigh), static_cast<std::uint8_t>(PartLabel::LeftThigh));
  EXPECT_EQ(part_at_joint(JointId::RightKnee), static_cast<std::uint8_t>(PartLabel::RightKnee));
  EXPECT_EQ(part_at_joint(JointId::LeftElbow), static_cast<std::uint8_t>(PartLabel::LeftElbow));
}

TEST(SynthSource, TheUserPositionLiesOnTheFrontOfTheTorso) {
  auto source = opened("stand?size=160x120");
  DepthFrame frame;
  ASSERT_TRUE(source->read(frame, 0ms));
  const Skeleton& skeleton = source->truth().skeleton;
  const Eigen::Vector3f offset = skeleton.user_position - skeleton[JointId::Torso].position;
  EXPECT_LT(std::abs(offset.x()), 0.05F);
  EXPECT_LT(offset.z(), -0.05F);
  EXPECT_GT(offset.z(), -0.20F);
}

/// The user's pixels in the first frame.
int pixels_of_user(const SynthOptions& options) {
  auto source = SynthSource::open(*find_script("stand"), options);
  EXPECT_TRUE(source);
  DepthFrame frame;
  EXPECT_TRUE((*source)->read(frame, 0ms));
  int count = 0;
  for (const std::uint8_t owner : (*source)->truth().owner) count += owner == 1;
  return count;
}

TEST(SynthSource, FurnitureHidesAboutTheShareThatIsAskedFor) {
  SynthOptions open{.seed = 3, .width = 160, .height = 120, .distance_m = 2.8, .wish = {}};
  const double whole = pixels_of_user(open);
  for (const double share : {0.2, 0.4}) {
    for (const bool below : {true, false}) {
      SynthOptions hidden = open;
      hidden.occluded = share;
      hidden.occluded_below = below;
      EXPECT_NEAR(pixels_of_user(hidden) / whole, 1 - share, 0.15) << share << (below ? " below" : " beside");
    }
  }
}

TEST(SynthSource, AWheelchairIsSeenAndNobodys) {
  Script script = *find_script("stand");
  script.actors[0].posture = Posture::Wheelchair;
  Script chair = script;
  chair.actors[0].posture = Posture::Chair;
  const SynthOptions options{.seed = 4, .width = 160, .height = 120, .distance_m = 2.5, .wish = {}, .furnished = false};
  DepthFrame with_wheels, with_legs;
  auto source = SynthSource::open(script, options), other = SynthSource::open(chair, options);
  ASSERT_TRUE(source && other);
  ASSERT_TRUE((*source)->read(with_wheels, 0ms) && (*other)->read(with_legs, 0ms));
  EXPECT_NE(with_wheels.depth_mm, with_legs.depth_mm);
  const auto hip_height = [](SynthSource& s) {
    const Eigen::Vector3f up = s.rest().frame.up;
    return up.dot(s.truth().skeleton[JointId::LeftHip].position - s.truth().skeleton[JointId::LeftFoot].position);
  };
  EXPECT_LT(hip_height(**source), 0.6F) << "sits";
  EXPECT_LT(hip_height(**other), 0.6F);
  for (std::size_t pixel = 0; pixel < with_wheels.depth_mm.size(); ++pixel) {
    EXPECT_TRUE((*source)->truth().owner[pixel] == 1 || (*source)->truth().part[pixel] == kNoPart);
  }
}

TEST(SynthSource, AWishedForPersonIsAsWished) {
  using Body = PersonWish::Body;
  using Clothes = PersonWish::Clothes;
  Random random(5);
  for (const Body body : {Body::Adult, Body::Child}) {
    for (const Clothes clothes : {Clothes::Plain, Clothes::Coat, Clothes::Skirt}) {
      const PersonWish wish{body, clothes, 1.1};
      const Person person = random_person(random, wish);
      EXPECT_TRUE(wish.fulfilled_by(person));
      EXPECT_EQ(person.outfit.bag, Outfit::Bag::None);
      EXPECT_EQ(person.outfit.skirt > 0, clothes != Clothes::Plain);
      EXPECT_EQ(person.shape.stature < 1.5, body == Body::Child);
    }
  }
}

TEST(SynthSource, FramesCarrySequenceAndTime) {
  auto source = opened("stand?size=32x24&fps=10");
  DepthFrame frame;
  for (std::uint64_t i = 0; i < 3; ++i) {
    ASSERT_TRUE(source->read(frame, 0ms));
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.sensor, (Timestamp{100ms * i, ClockId::Synthetic}));
  }
}

TEST(SynthSource, AfterItsLastFrameItSaysSoAgainAndAgain) {
  auto source = opened("walk_in?size=16x16&fps=1");
  DepthFrame frame;
  for (long i = 0; i < source->info().frame_count; ++i) EXPECT_EQ(*source->read(frame, 0ms), ReadStatus::Frame);
  EXPECT_EQ(*source->read(frame, 0ms), ReadStatus::EndOfStream);
  EXPECT_EQ(*source->read(frame, 0ms), ReadStatus::EndOfStream);
}

TEST(SynthSource, InRealTimeAFrameIsHandedOutWhenItIsDue) {
  OpenOptions options{.pacing = Pacing::RealTime, .clock = std::make_shared<ManualClock>()};
  auto source = SynthSource::open("stand?size=32x24&fps=10", options);
  ASSERT_TRUE(source);
  DepthFrame frame;
  EXPECT_EQ(*(*source)->read(frame, 1000ms), ReadStatus::Frame);
  EXPECT_EQ(*(*source)->read(frame, 20ms), ReadStatus::Timeout);
  EXPECT_EQ(*(*source)->read(frame, 1000ms), ReadStatus::Frame);
  EXPECT_EQ(options.clock->now(), 100ms);
}

TEST(SynthSource, WrongNamesAndOptionsAreNamedInOneLine) {
  for (const auto& [uri, said] :
       std::vector<std::pair<std::string, std::string>>{{"synth:nobody", "no script 'nobody'"},
                                                        {"synth:", "no script ''"},
                                                        {"synth:demo?colour=red", "unknown option 'colour'"},
                                                        {"synth:demo?size=0x0", "size '0x0': expected WIDTHxHEIGHT"},
                                                        {"synth:demo?size=99999x1", "size '99999x1'"},
                                                        {"synth:demo?fps=nan", "fps 'nan'"},
                                                        {"synth:demo?seed=-1", "seed '-1'"},
                                                        {"synth:demo?carry=piano", "carry 'piano'"}}) {
    const auto source = open_source(uri);
    ASSERT_FALSE(source) << uri;
    EXPECT_NE(source.error().message.find(said), std::string::npos) << source.error().message;
    EXPECT_EQ(source.error().message.find('\n'), std::string::npos);
  }
}

TEST(OpenSource, PassesOtherSchemesOn) {
  EXPECT_FALSE(open_source("oni:/nowhere/at/all.oni"));
  EXPECT_FALSE(open_source("teapot:1"));
}

}  // namespace
}  // namespace armature
