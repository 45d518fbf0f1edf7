#include <armature/sdk/expansion/expansion.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

/// A match of one face; all that counts is its share of the first of two bins.
Candidate candidate(int face, float share) {
  Match match{.faces = {FaceId(face)}};
  Histogram histogram = {share, 1 - share};
  match.score = 1 - chi_square(histogram, Histogram{1, 0});
  return {std::move(match), std::move(histogram)};
}

std::vector<std::size_t> order(const Expansion& expansion) {
  std::vector<std::size_t> faces;
  for (const Match& match : expansion.first(expansion.size())) faces.push_back(match.faces.front().index());
  return faces;
}

const Expansion kPool({FaceId(0)}, {candidate(1, 0.5F), candidate(2, 0.9F), candidate(3, 0.1F), candidate(4, 0.8F)},
                      {});

TEST(ChiSquare, LiesBetweenEqualAndDisjoint) {
  const Histogram half = {0.5F, 0.5F, 0};
  EXPECT_EQ(chi_square(half, half), 0);
  EXPECT_EQ(chi_square(Histogram{1, 0, 0}, Histogram{0, 0, 1}), 1);
  EXPECT_NEAR(chi_square(half, Histogram{1, 0, 0}), 0.5 * (0.25 / 1.5 + 0.5), 1e-12);
  EXPECT_EQ(chi_square(Histogram{0, 0}, Histogram{0, 0}), 0);
}

TEST(Expansion, RanksByScoreAndCutsAnywhere) {
  EXPECT_EQ(order(kPool), (std::vector<std::size_t>{2, 4, 1, 3}));
  EXPECT_EQ(kPool.first(2).size(), 2);
  EXPECT_EQ(kPool.first(99).size(), 4);
  // The slider copies nothing.
  EXPECT_EQ(kPool.first(3).data(), kPool.first(1).data());
}

TEST(Expansion, WhatIsLikeAnAcceptedMatchRises) {
  Expansion expansion = kPool;
  expansion.accept(3);  // face 3: 0.1
  EXPECT_EQ(order(expansion), (std::vector<std::size_t>{3, 2, 4, 1}));
  EXPECT_GT(expansion.first(4)[3].score, kPool.first(3)[2].score);
  EXPECT_TRUE(expansion.undo());
  EXPECT_EQ(order(expansion), order(kPool));
  EXPECT_FALSE(expansion.undo());
}

TEST(Expansion, WhatIsLikeARejectedMatchFalls) {
  Expansion expansion = kPool;
  expansion.reject(1);  // face 4: 0.8, which is near that of face 2
  EXPECT_EQ(order(expansion), (std::vector<std::size_t>{2, 1, 3}));
  EXPECT_LT(expansion.first(1)[0].score, kPool.first(1)[0].score);
  ASSERT_EQ(expansion.rejected().size(), 1);
  EXPECT_EQ(expansion.rejected()[0].face, FaceId(4));
  EXPECT_TRUE(expansion.undo());
  EXPECT_TRUE(expansion.rejected().empty());
  EXPECT_EQ(order(expansion), order(kPool));
}

TEST(Expansion, ASecondThoughtReplacesTheFirst) {
  Expansion expansion = kPool;
  expansion.accept(0);
  expansion.accept(1);
  expansion.reject(0);
  EXPECT_EQ(order(expansion).front(), 4);
  EXPECT_EQ(expansion.size(), 3);
  EXPECT_TRUE(expansion.undo());
  EXPECT_TRUE(expansion.undo());
  EXPECT_FALSE(expansion.undo());
  EXPECT_EQ(order(expansion), order(kPool));
}

}  // namespace
}  // namespace armature::sdk
