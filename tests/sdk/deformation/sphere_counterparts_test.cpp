#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <armature/sdk/decimation/similar_decimation.h>
#include <armature/sdk/deformation/deform.h>
#include <armature/sdk/deformation/sphere_counterparts.h>
#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>

#include "tests/sdk/hierarchy/shapes.h"
#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

const Eigen::Matrix3d mirror = Vector3d(1, 1, -1).asDiagonal();

/// A body on four equal legs, mirrored in z, with a head where x is positive.
Mesh four_legged() {
  Mesh mesh = ball(4);
  for (Vector3d& p : mesh.positions) {
    const Vector3d q(std::abs(p.x()), p.y(), std::abs(p.z()));
    const auto bump = [](const Vector3d& at, const Vector3d& from, double width) {
      return std::exp(-(from - at.normalized()).squaredNorm() / (width * width));
    };
    p *= 1 + 1.5 * bump({1, -1.4, 0.9}, q, 0.25) + 0.8 * bump({1, 0.4, 0}, p, 0.5);
  }
  return mesh;
}

struct Creature {
  static constexpr std::size_t kLevel = 24;
  Mesh mesh = four_legged();
  Hierarchy hierarchy = build_similar_hierarchy(mesh).value().build.hierarchy;
  std::vector<Sphere> spheres = hierarchy.level(kLevel).value().spheres;

  /// The sphere farthest along a direction.
  [[nodiscard]] SphereId towards(const Vector3d& direction) const {
    const auto found = std::ranges::max_element(spheres, {}, [&](const Sphere& s) { return s.centre.dot(direction); });
    return SphereId(static_cast<std::size_t>(found - spheres.begin()));
  }
  [[nodiscard]] SphereId foot(double x, double z) const { return towards({x, -1.4, 0.9 * z}); }
};

TEST(SphereCounterparts, OfAFootAreTheOtherFeet) {
  const Creature creature;
  const std::vector<SphereId> reference = {creature.foot(1, 1)};
  const auto found = sphere_counterparts(creature.mesh, creature.hierarchy, Creature::kLevel, reference);
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 3U);
  // The other side is the mirror image.
  EXPECT_EQ((*found)[0].spheres, std::vector{creature.foot(1, -1)});
  EXPECT_LT(((*found)[0].from_reference.linear() - mirror).norm(), 0.01);
  for (const auto& there : {creature.foot(-1, 1), creature.foot(-1, -1)})
    EXPECT_TRUE(std::ranges::any_of(*found, [&](const auto& one) { return one.spheres == std::vector{there}; }));
}

TEST(SphereCounterparts, OfSeveralAreAlikeEachOne) {
  // The other has a rough head.
  Mesh other = four_legged();
  double roughness = 0.06;
  for (Vector3d& p : other.positions)
    if (p.normalized().dot(Vector3d(1, 0.4, 0).normalized()) > 0.9) p *= 1 + (roughness = -roughness);
  const Mesh both = surfaces::together(four_legged(), surfaces::moved(other, {9, 0, 0}));
  const Hierarchy hierarchy = build_similar_hierarchy(both).value().build.hierarchy;
  const auto spheres = hierarchy.level(48).value().spheres;
  const auto towards = [&](const Vector3d& direction) {
    const auto found = std::ranges::max_element(
        spheres, {}, [&](const Sphere& s) { return s.centre.x() < 4 ? s.centre.dot(direction) : -99; });
    return SphereId(static_cast<std::size_t>(found - spheres.begin()));
  };
  const std::vector<SphereId> foot = {towards({1, -1.4, 0.9})};
  const std::vector<SphereId> foot_and_back = {foot[0], towards({-1, 1, 0})};
  EXPECT_EQ(sphere_counterparts(both, hierarchy, 48, foot).value().size(), 7U);
  // There is a foot of either side of the other where a sphere is near the back's place as well, but one alone is like
  // it.
  EXPECT_EQ(sphere_counterparts(both, hierarchy, 48, foot_and_back).value().size(), 1U);
}

TEST(SphereCounterparts, MoveInTheirOwnFrames) {
  const Creature creature;
  const std::vector<SphereMove> moves = {
      {.spheres = {creature.foot(1, 1)}, .translate = {0.2, 0.1, 0.3}, .rotate = {0.3, 0.2, 0.1}}};
  const auto all = with_counterparts(creature.mesh, creature.hierarchy, Creature::kLevel, moves);
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->size(), 4U);
  EXPECT_LT(((*all)[1].translate - Vector3d(0.2, 0.1, -0.3)).norm(), 0.01);
  EXPECT_LT(((*all)[1].rotate - Vector3d(-0.3, -0.2, 0.1)).norm(), 0.01);
  // The feet stay mirror images of one another.
  const auto deformed = deform(creature.mesh, creature.hierarchy, Creature::kLevel, *all);
  const auto alone = deform(creature.mesh, creature.hierarchy, Creature::kLevel, moves);
  ASSERT_TRUE(deformed && alone);
  const auto tip = [](const Mesh& mesh, double z) {
    return *std::ranges::max_element(mesh.positions, {},
                                     [&](const Vector3d& p) { return p.dot(Vector3d(1, -1.4, 0.9 * z)); });
  };
  const auto apart = [&](const Mesh& mesh) {
    return (tip(mesh, 1) - mirror * tip(mesh, -1)).norm() / bounding_box_diagonal(mesh);
  };
  EXPECT_LT(apart(*deformed), 0.01);
  EXPECT_GT(apart(*alone), 0.05);
}

TEST(SphereCounterparts, SwingWithTheirPhases) {
  const Creature creature;
  const std::vector<SphereMove> moves = {{.spheres = {creature.foot(1, 1)}, .translate = {0.2, 0, 0}}};
  const auto all = with_counterparts(creature.mesh, creature.hierarchy, Creature::kLevel, moves,
                                     {.time = 1.25, .phases = {0.5, 0.25}});
  ASSERT_TRUE(all);
  ASSERT_EQ(all->size(), 4U);
  EXPECT_LT(((*all)[0].translate - Vector3d(0.2, 0, 0)).norm(), 1e-12);
  EXPECT_LT(((*all)[1].translate - Vector3d(-0.2, 0, 0)).norm(), 0.01);
  EXPECT_LT((*all)[2].translate.norm(), 1e-12);
  EXPECT_NEAR((*all)[3].translate.norm(), 0.2, 1e-9);
}

TEST(SphereCounterparts, AreThoseOfCopiesHoweverTheyLie) {
  Mesh one = four_legged();
  Mesh other = surfaces::inside_out(one);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2, Vector3d(3, -1, 2).normalized()).toRotationMatrix() * Vector3d(-1, 1, 1).asDiagonal();
  for (Vector3d& p : other.positions) p = turn * p + Vector3d(9, 2, 1);
  const Mesh both = surfaces::together(one, other);
  const Hierarchy hierarchy = build_similar_hierarchy(both).value().build.hierarchy;
  // Copies are even where a step ends.
  const std::size_t level = hierarchy.spheres_after(hierarchy.steps_to(48));
  const auto spheres = hierarchy.level(level).value().spheres;
  const auto head = std::ranges::max_element(
      spheres, {}, [](const Sphere& s) { return s.centre.x() < 4 ? s.centre.dot(Vector3d(1, 0.4, 0)) : -9; });
  const std::vector<SphereId> reference = {SphereId(static_cast<std::size_t>(head - spheres.begin()))};
  const auto found = sphere_counterparts(both, hierarchy, level, reference);
  ASSERT_TRUE(found);
  ASSERT_FALSE(found->empty());
  EXPECT_LT((found->front().from_reference * head->centre - spheres[found->front().spheres[0].index()].centre).norm(),
            0.01);
  // Mirrored or not: the head is symmetric itself.
  EXPECT_LT(
      (found->front().from_reference * Vector3d(1, 0.4, 0) - (turn * Vector3d(1, 0.4, 0) + Vector3d(9, 2, 1))).norm(),
      0.02);
}

TEST(SphereCounterparts, RefusesWhatIsNotThere) {
  const Creature creature;
  const std::vector<SphereId> reference = {SphereId(0)};
  const auto fails = [&](std::size_t level, std::vector<SphereId> of, double misfit = 0.1) {
    return !sphere_counterparts(creature.mesh, creature.hierarchy, level, of, {.most_misfit = misfit});
  };
  EXPECT_TRUE(fails(0, reference));
  EXPECT_TRUE(fails(24, {}));
  EXPECT_TRUE(fails(24, {SphereId(24)}));
  EXPECT_TRUE(fails(24, reference, 0));
  EXPECT_FALSE(sphere_counterparts(ball(2), creature.hierarchy, 24, reference));
  const std::vector<SphereMove> moves = {{.spheres = reference}};
  EXPECT_FALSE(with_counterparts(creature.mesh, creature.hierarchy, 24, moves,
                                 {.time = std::numeric_limits<double>::infinity()}));
  // Where there are no others there is no counterpart.
  const auto whole =
      sphere_counterparts(creature.mesh, creature.hierarchy, creature.hierarchy.min_spheres(), reference);
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->empty());
}

}  // namespace
}  // namespace armature::sdk
