#include "firmware_host/recording/sidecar.h"

#include <gtest/gtest.h>

namespace armature {
namespace {

const RecordingFacts kFacts{{320, 240, 285.63, 285.7123456789012, 159.25, -0.1}, 29.97, "a \"name\"\nand 'more' \\ ü"};

std::string error_of(const std::string& text) {
  const auto facts = parse_sidecar(text, "a.oni.toml");
  return facts ? "" : facts.error().message;
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = format_sidecar(kFacts);
  return text.replace(text.find(from), from.size(), to);
}

TEST(Sidecar, ComesBackToTheLastBit) {
  const auto facts = parse_sidecar(format_sidecar(kFacts), "a.oni.toml");
  ASSERT_TRUE(facts) << facts.error().message;
  EXPECT_EQ(*facts, kFacts);
}

TEST(Sidecar, WritesNumbersAsPeopleDo) {
  const std::string text = format_sidecar({{320, 240, 285.63, 285.63, 160, 120}, 30, "synth:walk"});
  EXPECT_NE(text.find("width = 320\nheight = 240\nfocal_x_px = 285.63\nfocal_y_px = 285.63\ncentre_x_px = 160.0\n"
                      "centre_y_px = 120.0\nframes_per_second = 30.0\norigin = \"synth:walk\"\n"),
            std::string::npos)
      << text;
}

TEST(Sidecar, NamesLineAndKeyOfWhatIsWrong) {
  EXPECT_EQ(error_of(with("width = 320", "width = 0")), "a.oni.toml:4: width: expected a whole number from 1 to 4096");
  EXPECT_EQ(error_of(with("width = 320", "width = 'wide'")),
            "a.oni.toml:4: width: expected a whole number from 1 to 4096");
  EXPECT_EQ(error_of(with("height = 240", "")), "a.oni.toml: expected the key 'height'");
  EXPECT_NE(error_of(with("focal_x_px = 285.63", "focal_x_px = nan")).find("a.oni.toml:6: focal_x_px"),
            std::string::npos);
  EXPECT_NE(error_of(with("focal_x_px = 285.63", "focal_x_px = -1")).find("a.oni.toml:6: focal_x_px"),
            std::string::npos);
  EXPECT_NE(error_of(with("frames_per_second = 29.97", "frames_per_second = 0")).find("frames_per_second"),
            std::string::npos);
  EXPECT_EQ(error_of(with("version = 1", "version = 2")), "a.oni.toml:3: version: expected a whole number from 1 to 1");
  EXPECT_EQ(error_of(with("width = 320", "width = 320\nwidht = 320")), "a.oni.toml:5: unknown key 'widht'");
  EXPECT_NE(error_of(with("width = 320", "width = = 320")).find("a.oni.toml:4: "), std::string::npos);
  EXPECT_EQ(error_of("").find("a.oni.toml: expected the key 'version'"), 0U);
}

TEST(Sidecar, RefusesEveryTruncatedPrefix) {
  const std::string text = format_sidecar(kFacts);
  // Without its last newline it is still whole.
  for (std::size_t length = 0; length + 1 < text.size(); ++length) {
    const std::string error = error_of(text.substr(0, length));
    EXPECT_NE(error, "") << length;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace armature
