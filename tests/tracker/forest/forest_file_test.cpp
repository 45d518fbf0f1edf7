#include <cstring>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tracker/forest/checksum.h"
#include "tracker/forest/forest.h"

namespace armature {
namespace {

/// One tree of two splits and three leaves, one of a leaf alone.
std::vector<Tree> small_trees() {
  Tree tree;
  tree.nodes = {{.u_mm = {100, -200}, .v_mm = {0, 0}, .child = {1, ~0}, .threshold_mm = -35},
                {.u_mm = {-1000, 5}, .v_mm = {7, 900}, .child = {~1, ~2}, .threshold_mm = 250}};
  tree.leaves.resize(3);
  for (std::size_t i = 0; i < 3; ++i) {
    tree.leaves[i].probability[i] = 255;
    tree.leaves[i].votes[0] = {.offset = {static_cast<std::int8_t>(-3 * static_cast<int>(i)), 127, -127},
                               .joint = static_cast<std::uint8_t>(i),
                               .weight_code = 16};
  }
  Tree stump;
  stump.leaves.resize(1);
  stump.leaves[0].probability[30] = 255;
  return {tree, stump};
}

/// With a correction, narrow so that it is short.
Forest small_forest() {
  const auto layer = [](int inputs, int outputs) {
    PerceptronLayer out{.inputs = inputs, .outputs = outputs, .weights = {}, .bias = {}};
    out.weights.resize(static_cast<std::size_t>(inputs * outputs));
    for (int i = 0; i < outputs; ++i) out.bias.push_back(0.125F * static_cast<float>(i));
    return out;
  };
  return *Forest::create(small_trees(), "armature forest train x.forest")
              ->corrected_by(*Perceptron::create({layer(kCorrectionInputs, 1), layer(1, kCorrectionOutputs)}));
}

std::string error_of(std::span<const std::byte> bytes) {
  const auto forest = Forest::parse(bytes, "x.forest");
  return forest ? "no error" : forest.error().message;
}

/// Puts the right checksum back after the payload was altered.
void seal(std::vector<std::byte>& bytes) {
  const std::uint32_t checksum = crc32(std::span(bytes).subspan(24));
  for (std::size_t i = 0; i < 4; ++i) bytes[12 + i] = static_cast<std::byte>(checksum >> (8 * i) & 0xFFU);
}

TEST(ForestFile, AForestComesBackAsItWasWritten) {
  const auto path = std::filesystem::path(testing::TempDir()) / "round_trip.forest";
  const Forest forest = small_forest();
  ASSERT_TRUE(forest.save(path).has_value());
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".tmp"));
  const auto back = Forest::load(path);
  ASSERT_TRUE(back.has_value()) << back.error().message;
  EXPECT_EQ(back->serialize(), forest.serialize());
  EXPECT_EQ(back->command(), "armature forest train x.forest");
  EXPECT_EQ(back->checksum(), forest.checksum());
  EXPECT_EQ(back->depth(), 2);
  ASSERT_EQ(back->trees().size(), 2U);
  EXPECT_EQ(back->trees()[0].nodes[1].v_mm[1], 900);
  EXPECT_EQ(back->trees()[0].leaves[2].votes[0].offset[0], -6);
  EXPECT_EQ(back->trees()[1].leaves[0].probability[30], 255);
  ASSERT_NE(back->correction(), nullptr);
  EXPECT_EQ(back->correction()->layers()[1].bias[3], 0.375F);
  EXPECT_EQ(back->uncorrected().correction(), nullptr);
}

TEST(ForestFile, TheBytesAreThoseOfVersionTwo) {
  Tree stump;
  stump.leaves.resize(1);
  stump.leaves[0].probability[4] = 255;
  stump.leaves[0].votes[0] = {.offset = {1, -2, 3}, .joint = 2, .weight_code = 9};
  const auto bytes = Forest::create({stump}, "c")->serialize();
  std::string hex;
  for (const std::byte byte : bytes) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    hex += kDigits[std::to_integer<std::size_t>(byte >> 4U)];
    hex += kDigits[std::to_integer<std::size_t>(byte & std::byte{15})];
  }
  std::string expected = "41524d464f52535402000000";
  expected += hex.substr(24, 8);   // the checksum, tested below
  expected += "5c00000000000000";  // 92 bytes follow
  expected +=
      "0100000063"
      "01000000";                  // the command, one tree
  expected += "0000000001000000";  // no node, one leaf
  expected += "00000000ff" + std::string(52, '0');
  expected += "01fe030209";
  for (int i = 1; i < kVotesPerLeaf; ++i) expected += "000000ff00";
  expected += "00000000";  // no correction
  EXPECT_EQ(hex, expected);
  const std::string check = "123456789";
  EXPECT_EQ(crc32(std::as_bytes(std::span(check))), 0xCBF43926U);
}

TEST(ForestFile, EveryTruncatedPrefixIsRefused) {
  const auto bytes = small_forest().serialize();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(Forest::parse(std::span(bytes).first(size), "x").has_value()) << size << " bytes";
  }
  EXPECT_EQ(error_of(std::span(bytes).first(20)), "x.forest: truncated model: its header is incomplete");
  EXPECT_EQ(error_of(std::span(bytes).first(100)),
            "x.forest: truncated model: 76 bytes after the header, expected " + std::to_string(bytes.size() - 24));
}

TEST(ForestFile, EveryAlteredByteIsRefused) {
  const auto bytes = small_forest().serialize();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto altered = bytes;
    altered[i] ^= std::byte{0x10};
    EXPECT_FALSE(Forest::parse(altered, "x").has_value()) << "byte " << i;
  }
  auto altered = bytes;
  altered.back() ^= std::byte{1};
  EXPECT_EQ(error_of(altered),
            "x.forest: damaged model: its checksum does not match its contents; copy or train it again");
}

TEST(ForestFile, AnotherVersionAndAnotherKindOfFileAreNamed) {
  auto bytes = small_forest().serialize();
  bytes[8] = std::byte{7};
  EXPECT_EQ(error_of(bytes),
            "x.forest: model version 7, this program reads version 2; train it again with 'armature forest train'");
  bytes[0] = std::byte{'Z'};
  EXPECT_EQ(error_of(bytes),
            "x.forest: not a part forest (it does not begin with ARMFORST); make one with 'armature forest train'");
  EXPECT_EQ(Forest::load("/nowhere/x.forest").error().message,
            "/nowhere/x.forest: cannot read the model: No such file or directory");
}

TEST(ForestFile, IndicesThatLeadOutOfTheTreeAreRefusedEvenWithTheRightChecksum) {
  const auto bytes = small_forest().serialize();
  const std::size_t first_node = 24 + 4 + small_forest().command().size() + 4 + 8;
  const auto with = [&](std::size_t at, std::initializer_list<int> values) {
    auto altered = bytes;
    for (const int value : values) altered[at++] = static_cast<std::byte>(value);
    seal(altered);
    return error_of(altered);
  };
  EXPECT_EQ(with(first_node + 10, {2, 0, 0, 0}),
            "x.forest: damaged model: tree 0, node 0: child 2 is not behind it in the tree");
  EXPECT_EQ(with(first_node + 10, {0, 0, 0, 0}),
            "x.forest: damaged model: tree 0, node 0: child 0 is not behind it in the tree");
  EXPECT_EQ(with(first_node + 10, {0xFC, 0xFF, 0xFF, 0xFF}),
            "x.forest: damaged model: tree 0, node 0: child -4 is not behind it in the tree");
  EXPECT_EQ(with(first_node, {0xFF, 0x7F}),
            "x.forest: damaged model: tree 0, node 0: probe of 32767 mm, expected at most 2000");
  EXPECT_EQ(with(first_node + 36 + 31 + 3, {30}), "x.forest: damaged model: tree 0, leaf 0: vote for joint 30 of 30");
}

TEST(ForestFile, VoteWeightsHalveEverySixteenCodes) {
  EXPECT_FLOAT_EQ(vote_weight(0), 1.0F);
  EXPECT_NEAR(vote_weight(16), 0.5F, 1e-6);
  EXPECT_NEAR(vote_weight(64), 0.0625F, 1e-6);
  EXPECT_EQ(vote_weight_code(1.0F), 0);
  EXPECT_EQ(vote_weight_code(0.499F), 17);
  EXPECT_EQ(vote_weight_code(0.0F), 255);
}

}  // namespace
}  // namespace armature
