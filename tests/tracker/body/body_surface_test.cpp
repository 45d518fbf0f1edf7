#include "tracker/body/body_surface.h"

#include <set>

#include <gtest/gtest.h>

namespace armature {
namespace {

using Eigen::Vector3d;

std::vector<SurfaceEdge> standing_surface(const Outfit& outfit = {}) {
  const BodyShape shape = average_shape(1.75);
  std::vector<SurfaceEdge> edges;
  body_surface(shape, pose_body(shape, standing_pose(shape)), outfit, edges);
  return edges;
}

TEST(BodySurface, EveryPartIsSomewhere) {
  std::set<std::uint8_t> parts;
  for (const SurfaceEdge& edge : standing_surface()) {
    for (int band = 0; band < edge.cut.band_count; ++band) {
      parts.insert(edge.cut.bands[static_cast<std::size_t>(band)].left);
      parts.insert(edge.cut.bands[static_cast<std::size_t>(band)].right);
    }
  }
  parts.erase(kNoPart);
  EXPECT_EQ(parts.size(), static_cast<std::size_t>(kPartCount));
}

TEST(BodySurface, ACutTellsLeftFromRightAndOneBandFromTheNext) {
  PartCut cut;
  cut.along = Vector3d::UnitY();
  cut.left = Vector3d::UnitX();
  cut.band_count = 2;
  cut.bands[0] = {0.5, 1, 2};
  cut.bands[1] = {1e9, 3, 4};
  EXPECT_EQ(part_at(cut, {0.1, 0.4, 0}), 1);
  EXPECT_EQ(part_at(cut, {-0.1, 0.4, 0}), 2);
  EXPECT_EQ(part_at(cut, {0.1, 0.6, 0}), 3);
  EXPECT_EQ(part_at(cut, {-0.1, 0.6, 0}), 4);
}

TEST(BodySurface, EveryJointLiesInsideTheBodyOrOnItsSkin) {
  const BodyShape shape = average_shape(1.75);
  const PosedBody body = pose_body(shape, standing_pose(shape));
  const auto edges = standing_surface();
  for (int j = 0; j < kJointCount; ++j) {
    double nearest = 1e9;
    for (const SurfaceEdge& edge : edges) {
      nearest = std::min(nearest, sdk::signed_distance(edge.edge, body.joints[static_cast<std::size_t>(j)]));
    }
    EXPECT_LT(nearest, 0.005) << kJointNames[static_cast<std::size_t>(j)];
  }
}

TEST(BodySurface, ClothMakesThickerAndBagsAreNoPartOfTheBody) {
  const auto plain = standing_surface();
  const auto dressed = standing_surface({.cloth = 0.03, .bag = Outfit::Bag::Backpack});
  EXPECT_GT(dressed.front().edge.a.radius, plain.front().edge.a.radius + 0.02);
  int carried = 0;
  for (const SurfaceEdge& edge : dressed) {
    if (edge.material != Material::Carried) continue;
    ++carried;
    EXPECT_EQ(part_at(edge.cut, edge.edge.a.centre), kNoPart);
  }
  EXPECT_GT(carried, 0);
}

}  // namespace
}  // namespace armature
