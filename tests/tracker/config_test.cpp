#include "tracker/config.h"

#include <gtest/gtest.h>

namespace armature {
namespace {

std::string refusal(std::string_view text) {
  const auto config = parse_config(text, "kiosk.toml");
  return config ? "accepted" : config.error().message;
}

TEST(Config, AnEmptyFileMeansTheDefaults) {
  const auto config = parse_config("", "kiosk.toml");
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->tracker.navigation.pair, (SteeringPair{MotionId::LeanBust, MotionId::BendKnees}));
}

TEST(Config, WhatIsPrintedReadsBackToTheSameAndPrintsTheSame) {
  Config config;
  config.source = "oni:a \"quoted\" name.oni";
  config.tracker.navigation.transfer[0].alpha = 0.3F;
  config.tracker.navigation.motions.range_rad[3] = radians(17.5F);
  const std::string text = print_config(config);
  const auto back = parse_config(text, "kiosk.toml");
  ASSERT_TRUE(back) << back.error().message << "\n" << text;
  EXPECT_EQ(print_config(*back), text);
  EXPECT_EQ(back->source, config.source);
  EXPECT_NEAR(back->tracker.navigation.motions.range_rad[3], radians(17.5F), 1e-6F);
}

TEST(Config, EveryLineOfTheDefaultsIsDocumented) {
  std::istringstream lines(print_config({}));
  for (std::string line; std::getline(lines, line);) {
    if (line.find(" = ") == std::string::npos) continue;
    EXPECT_NE(line.find(" # "), std::string::npos) << line;
  }
}

TEST(Config, SeatedSetsTheDefaultPairWhichTheFileMayOverride) {
  EXPECT_EQ(parse_config("[navigation]\nprofile = 'seated'", "f")->tracker.navigation.pair,
            (SteeringPair{MotionId::RotateShoulders, MotionId::BendBust}));
  EXPECT_EQ(parse_config("[navigation]\nprofile = 'seated'\nwalk = 'step'", "f")->tracker.navigation.pair,
            (SteeringPair{MotionId::RotateShoulders, MotionId::Step}));
}

TEST(Config, AnUnknownKeyIsNamedWithFileAndLine) {
  EXPECT_EQ(refusal("[navigation]\n\nwlak = 'step'\n"),
            "kiosk.toml:3: navigation.wlak: unknown key; `armatured --print-config` lists them all");
  EXPECT_EQ(refusal("[motions.fly]\nalpha = 0.2\n"),
            "kiosk.toml:1: motions.fly: unknown key; `armatured --print-config` lists them all");
}

TEST(Config, AWrongTypeOrAValueOutOfRangeIsNamedWithWhatWasExpected) {
  EXPECT_EQ(refusal("[motions.step]\nalpha = 'much'"),
            "kiosk.toml:2: motions.step.alpha = 'much': expected a number from 0 to 0.9");
  EXPECT_EQ(refusal("[motions.step]\nalpha = 2"),
            "kiosk.toml:2: motions.step.alpha = 2: expected a number from 0 to 0.9");
  EXPECT_EQ(refusal("[segmentation]\nfar_m = nan"),
            "kiosk.toml:2: segmentation.far_m = nan: expected a number from 0.5 to 10");
  EXPECT_EQ(refusal("source = 3"), "kiosk.toml:1: source = 3: expected a table [source]");
  EXPECT_EQ(refusal("[skeleton]\nstride = 1.5"),
            "kiosk.toml:2: skeleton.stride = 1.5: expected a whole number from 0 to 16");
  EXPECT_NE(refusal("[navigation]\nturn = 'fly'").find("expected one of rotate_shoulders"), std::string::npos);
}

TEST(Config, TheFirstOfSeveralMistakesIsReported) {
  EXPECT_EQ(refusal("[motions.step]\nbeta = 0\n[navigation]\nwlak = 'step'\n").substr(0, 13), "kiosk.toml:2:");
}

TEST(Config, CorrelatedPairsNeedPermission) {
  EXPECT_EQ(refusal("[navigation]\nturn = 'lean_bust'\nwalk = 'bend_bust'\n").substr(0, 13), "kiosk.toml:2:");
  EXPECT_EQ(refusal("[navigation]\nturn = 'lean_bust'\nwalk = 'bend_bust'\nallow_correlated = true\n"), "accepted");
}

TEST(Config, WhatIsNotTomlSaysWhere) {
  EXPECT_EQ(refusal("[navigation\nx").substr(0, 23), "kiosk.toml:1: not TOML:");
  EXPECT_NE(load_config("no/such.toml").error().message.find("no/such.toml: no such file"), std::string::npos);
}

}  // namespace
}  // namespace armature
