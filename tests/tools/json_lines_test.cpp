#include "tools/json_lines.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

namespace armature::tools {
namespace {

TEST(JsonNumber, IsAlwaysFiniteAndHasSixDecimals) {
  EXPECT_EQ(Json(number(0.1F)).dump(), "0.1");
  EXPECT_EQ(Json(number(-1e-9)).dump(), "0.0");
  EXPECT_EQ(Json(number(std::numeric_limits<double>::quiet_NaN())).dump(), "0.0");
  EXPECT_EQ(Json(number(-std::numeric_limits<double>::infinity())).dump(), "0.0");
  EXPECT_EQ(number(std::numeric_limits<double>::max()), std::numeric_limits<double>::max());
}

TEST(JsonLine, IsOneLineInTheOrderItsKeysWereSet) {
  std::FILE* file = std::tmpfile();
  ASSERT_TRUE(write_json_line(file, {{"walk", 1}, {"angle", "a\nb\xff"}}));
  std::rewind(file);
  std::array<char, 256> line{};
  const auto count = std::fread(line.data(), 1, line.size(), file);
  std::fclose(file);
  EXPECT_EQ(std::string(line.data(), count), "{\"walk\":1,\"angle\":\"a\\nb\xEF\xBF\xBD\"}\n");
}

TEST(JsonLine, AFullDiskIsAnError) {
  std::FILE* full = std::fopen("/dev/full", "w");
  ASSERT_NE(full, nullptr);
  EXPECT_FALSE(write_json_line(full, {{"walk", 1}}));
  std::fclose(full);
}

}  // namespace
}  // namespace armature::tools
