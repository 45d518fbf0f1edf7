#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

#include <armature/sdk/deformation/deform.h>
#include <armature/sdk/deformation/refit.h>
#include <armature/sdk/deformation/skinned_level.h>
#include <armature/sdk/deformation/sphere_move.h>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/hierarchy/build.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/sdk/deformation/tubes.h"
#include "tests/sdk/hierarchy/shapes.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using tubes::farthest_apart;

struct Shape {
  explicit Shape(Mesh of, const HierarchyOptions& options = {})
      : mesh(std::move(of)), hierarchy(build_hierarchy(mesh, options).value().hierarchy) {}
  [[nodiscard]] std::vector<SphereId> spheres_where(std::size_t level, auto&& is) const {
    std::vector<SphereId> found;
    const auto spheres = hierarchy.level(level).value().spheres;
    for (std::size_t s = 0; s < spheres.size(); ++s)
      if (is(spheres[s])) found.emplace_back(s);
    return found;
  }
  [[nodiscard]] std::vector<SphereId> all(std::size_t level) const {
    return spheres_where(level, [](const Sphere&) { return true; });
  }
  Mesh mesh;
  Hierarchy hierarchy;
};

Mesh moved(const Mesh& mesh, const Eigen::Affine3d& by) {
  Mesh result = mesh;
  for (Vector3d& p : result.positions) p = by * p;
  return result;
}

constexpr std::array kBlends = {Blend::DualQuaternions, Blend::Linear};
constexpr std::array kSources = {WeightSource::Clusters, WeightSource::ClosestPrimitive};

TEST(Deform, WithoutMovesKeepsEveryBit) {
  const Shape shape(tubes::tube(6, 1, 0.05));
  const SphereMove nothing{.spheres = shape.all(9)};
  for (const auto& moves : {std::vector<SphereMove>{}, {nothing}, {nothing, nothing}, {SphereMove{}}})
    EXPECT_EQ(deform(shape.mesh, shape.hierarchy, 9, moves)->positions, shape.mesh.positions);
}

TEST(Deform, MovesTheMeshRigidlyWhereAllSpheresDo) {
  const Shape shape(tubes::tube(6, 1, 0.05));
  for (const double angle : {0.3, 2.0, 3.1, 6.0})
    for (const Blend blend : kBlends)
      for (const WeightSource source : kSources) {
        const Vector3d axis = Vector3d(1, 2, -1).normalized();
        const SphereMove move{
            .spheres = shape.all(9), .translate = {1, -2, 3}, .rotate = angle * axis, .about = Vector3d(1, 1, 0)};
        const auto deformed =
            deform(shape.mesh, shape.hierarchy, 9, std::vector{move}, {.weights = source, .blend = blend});
        Eigen::Affine3d rigid = Eigen::Affine3d::Identity();
        rigid.translate(Vector3d(1, -2, 3) + Vector3d(1, 1, 0)).rotate(Eigen::AngleAxisd(angle, axis));
        rigid.translate(-Vector3d(1, 1, 0));
        EXPECT_LT(farthest_apart(*deformed, moved(shape.mesh, rigid)), 1e-12);
      }
}

TEST(Deform, ScalesTheMeshWhereAllSpheresDo) {
  const Shape shape(tubes::tube(6, 1, 0.05));
  for (const Blend blend : kBlends) {
    const SphereMove move{.spheres = shape.all(9), .rotate = {0, 0, 0.5}, .about = Vector3d(1, 0, 0), .scale = 1.7};
    const auto deformed = deform(shape.mesh, shape.hierarchy, 9, std::vector{move}, {.blend = blend});
    Eigen::Affine3d similar = Eigen::Affine3d::Identity();
    similar.translate(Vector3d(1, 0, 0)).rotate(Eigen::AngleAxisd(0.5, Vector3d::UnitZ())).scale(1.7);
    similar.translate(Vector3d(-1, 0, 0));
    EXPECT_LT(farthest_apart(*deformed, moved(shape.mesh, similar)), 1e-12);
  }
}

TEST(Deform, BendsATubeWithoutLosingVolume) {
  const Shape tube(tubes::tube(8, 1, 0.03, 48, 160));
  const double before = tubes::volume(tube.mesh);
  for (const std::size_t level : {6, 10})
    for (const WeightSource source : kSources)
      for (const double angle : {0.5, 1.0, 1.5}) {
        const SphereMove bend{.spheres = tube.spheres_where(level, [](const Sphere& s) { return s.centre.x() > 0.01; }),
                              .rotate = {0, 0, angle},
                              .about = Vector3d::Zero()};
        const auto bent =
            deform(tube.mesh, tube.hierarchy, level, std::vector{bend}, {.weights = source, .keep_volume = false});
        EXPECT_NEAR(tubes::volume(*bent) / before, 1, 0.02) << level << ' ' << angle;
        EXPECT_GT(bounding_box(*bent).sizes().y(), bounding_box(tube.mesh).sizes().y() + angle);
      }
}

TEST(Deform, BendsAStraightCylinderWithoutLosingVolume) {
  // Nothing tells the sides of a perfect cylinder apart. Its axis becomes an arc, then it bends in its middle third.
  constexpr double kLength = 8;
  for (const int around : {32, 48}) {
    const Shape tube(tubes::tube(kLength, 1, 0, around, 160));
    const double before = tubes::volume(tube.mesh);
    for (const std::size_t level : {6, 10, 20}) {
      const auto spheres = tube.hierarchy.level(level)->spheres;
      for (const double angle : {0.5, 1.0, 1.5})
        for (const double part : {1.0, 1.0 / 3}) {
          const double radius = part * kLength / angle;
          std::vector<SphereMove> bend;
          for (const Sphere& sphere : spheres) {
            const double x = sphere.centre.x();
            const double on_arc = std::clamp(x, -part * kLength / 2, part * kLength / 2);
            const double turn = on_arc / radius;
            const Vector3d to(radius * std::sin(turn) + (x - on_arc) * std::cos(turn),
                              radius * (1 - std::cos(turn)) + (x - on_arc) * std::sin(turn), 0);
            bend.push_back({.spheres = {SphereId(bend.size())},
                            .translate = to - Vector3d(x, 0, 0),
                            .rotate = {0, 0, turn},
                            .about = Vector3d(x, 0, 0)});
          }
          const auto bent = deform(tube.mesh, tube.hierarchy, level, bend);
          EXPECT_NEAR(tubes::volume(*bent) / before, 1, 1e-9) << around << ' ' << level << ' ' << angle << ' ' << part;
        }
    }
  }
}

/// What lies beyond x turns about (x, 0, 0).
SphereMove hinge(const Shape& shape, std::size_t level, double x, double angle) {
  return {.spheres = shape.spheres_where(level, [&](const Sphere& s) { return s.centre.x() > x; }),
          .rotate = {0, 0, angle},
          .about = Vector3d(x, 0, 0)};
}

TEST(Deform, KeepsTheVolumeWhereASharpBendWouldNot) {
  for (const auto& [length, around, along] : {std::tuple{8.0, 96, 160}, {6.0 / 0.7, 32, 80}, {6.0, 48, 70}, {24.0, 32, 200}}) {
    const Shape tube(tubes::tube(length, 1, 0, around, along));
    const double before = tubes::volume(tube.mesh);
    for (const std::size_t level : {6, 10, 20})
      for (const double x : {0.01, 0.15, -0.2})
        for (const double angle : {0.5, 1.0, 1.5}) {
          const std::vector move{hinge(tube, level, x * length, angle)};
          if (move[0].spheres.empty()) continue;
          const auto bent = deform(tube.mesh, tube.hierarchy, level, move);
          EXPECT_NEAR(tubes::volume(*bent) / before, 1, 1e-9) << length << ' ' << level << ' ' << x << ' ' << angle;
        }
  }
}

TEST(Deform, KeepsTheVolumeOfSeveralTurnsOneAfterTheOther) {
  // A shoulder and an elbow: beyond both, no turn about one axis is left.
  const Shape tube(tubes::tube(8, 1, 0, 48, 160));
  const double before = tubes::volume(tube.mesh);
  const SphereMove elbow{
      .spheres = hinge(tube, 10, 1.5, 0).spheres, .rotate = {0.3, 0.9, 0}, .about = Vector3d(1.5, 0, 0)};
  const std::vector moves{hinge(tube, 10, -1, 1), elbow};
  const auto plain = deform(tube.mesh, tube.hierarchy, 10, moves, {.keep_volume = false});
  const auto kept = deform(tube.mesh, tube.hierarchy, 10, moves);
  EXPECT_GT(std::abs(tubes::volume(*plain) / before - 1), 1e-5);
  EXPECT_NEAR(tubes::volume(*kept) / before, 1, 1e-9);
}

TEST(Deform, KeepsNoVolumeOfWhatIsScaled) {
  const Shape tube(tubes::tube(8, 1, 0.03, 32, 80));
  const auto diffusion = HeatDiffusion::of(tube.mesh);
  ASSERT_TRUE(diffusion);
  const SphereMesh shape = *tube.hierarchy.level(8);
  SkinnedLevel level(SphereWeights(*diffusion, tube.hierarchy).of(tube.hierarchy.nodes_of_level(8)), shape, tube.mesh);
  auto motions = at_rest(shape.spheres);
  move_spheres({.spheres = tube.all(8), .rotate = {0, 0, 0.3}, .about = Vector3d::Zero(), .scale = 2}, motions);
  std::vector<Vector3d> out = tube.mesh.positions;
  level.move(motions, Blend::DualQuaternions, out, Volume::Kept);
  for (std::size_t v = 0; v < out.size(); ++v)
    ASSERT_LT((out[v] - motions[0](tube.mesh.positions[v])).norm(), 1e-12 * bounding_box_diagonal(tube.mesh)) << v;
}

TEST(Deform, KeepsTheVolumeWhereManyFacesShareAnEdge) {
  Mesh mesh = tubes::tube(8, 1, 0, 48, 160);
  const Triangle face = mesh.triangles[1000];
  for (std::size_t v = 2000; v < 3000; ++v)
    for (const bool around : {false, true})
      mesh.triangles.push_back({face[around ? 1 : 0], face[around ? 0 : 1], VertexId(v)});
  const Shape tube(std::move(mesh));
  const std::vector move{hinge(tube, 10, 0.1, 1)};
  const auto plain = deform(tube.mesh, tube.hierarchy, 10, move, {.keep_volume = false});
  const auto kept = deform(tube.mesh, tube.hierarchy, 10, move);
  ASSERT_TRUE(plain && kept);
  const double before = tubes::volume(tube.mesh);
  EXPECT_GT(std::abs(tubes::volume(*plain) / before - 1), 1e-4);
  EXPECT_NEAR(tubes::volume(*kept) / before, 1, 1e-9);
}

TEST(Deform, APullWithAMinuteTurnStaysAPull) {
  const Shape tube(tubes::tube(8, 1, 0, 48, 160));
  SphereMove pull = hinge(tube, 10, 0.1, 0);
  pull.translate = {2, 0, 0};
  const auto straight = deform(tube.mesh, tube.hierarchy, 10, std::vector{pull});
  for (const double angle : {1e-4, 1e-3, 1e-2}) {
    pull.rotate = {0, 0, angle};
    const auto turned = deform(tube.mesh, tube.hierarchy, 10, std::vector{pull});
    for (std::size_t v = 0; v < straight->positions.size(); ++v)
      ASSERT_LT((turned->positions[v] - straight->positions[v]).norm(), 8 * angle) << angle << ' ' << v;
  }
}

TEST(Deform, KeepsTheVolumeFarFromTheOrigin) {
  const Vector3d far(1e5, 4e6, -3e5);
  const Shape tube(surfaces::moved(tubes::tube(8, 1, 0, 48, 160), far));
  const auto volume_of = [&](const Mesh& mesh) { return tubes::volume(surfaces::moved(mesh, -far)); };
  std::vector move{hinge(tube, 10, far.x(), 1.5)};
  move[0].about = far;
  EXPECT_NEAR(volume_of(*deform(tube.mesh, tube.hierarchy, 10, move)) / volume_of(tube.mesh), 1, 1e-6);
}

TEST(Deform, KeepsTheVolumeBetweenTurnsThatLieFarApart) {
  // Its ends turn to either side by more than half a turn between them; the way behind is shorter.
  const Shape tube(tubes::tube(12, 0.5, 0.03, 32, 200));
  std::vector<SphereMove> apart;
  for (const double side : {-1.0, 1.0})
    apart.push_back({.spheres = tube.spheres_where(8, [&](const Sphere& s) { return side * s.centre.x() > 0.1; }),
                     .rotate = {side * 2.6, 0, 0},
                     .about = Vector3d::Zero()});
  const auto plain = deform(tube.mesh, tube.hierarchy, 8, apart, {.keep_volume = false});
  const auto kept = deform(tube.mesh, tube.hierarchy, 8, apart);
  const double before = tubes::volume(tube.mesh);
  EXPECT_GT(std::abs(tubes::volume(*plain) / before - 1), 1e-4);
  EXPECT_NEAR(tubes::volume(*kept) / before, 1, 1e-9);
}

TEST(Deform, KeepsTheVolumeOnlyWhereTurnsBlend) {
  const Shape tube(tubes::tube(12, 0.5, 0.03, 32, 200));
  const std::vector move{hinge(tube, 8, 1, 1.2)};
  const auto kept = deform(tube.mesh, tube.hierarchy, 8, move);
  const auto plain = deform(tube.mesh, tube.hierarchy, 8, move, {.keep_volume = false});
  const double before = tubes::volume(tube.mesh);
  EXPECT_LT(std::abs(tubes::volume(*kept) - before), 1e-9 * before);
  EXPECT_GT(std::abs(tubes::volume(*plain) - before), 1e-5 * before);
  std::size_t moved = 0;
  for (std::size_t v = 0; v < kept->positions.size(); ++v) {
    const bool differs = kept->positions[v] != plain->positions[v];
    EXPECT_FALSE(differs && std::abs(tube.mesh.positions[v].x() - 1) > 4) << v;
    moved += differs ? 1U : 0U;
  }
  EXPECT_GT(moved, 100U);
  // What pulls or swells means to change it.
  std::vector pull = move;
  pull[0].translate = {0, 0, 0.1};
  EXPECT_EQ(deform(tube.mesh, tube.hierarchy, 8, pull)->positions,
            deform(tube.mesh, tube.hierarchy, 8, pull, {.keep_volume = false})->positions);
  // An open mesh has none.
  Mesh open = tube.mesh;
  open.triangles.pop_back();
  const Shape cut(open);
  EXPECT_EQ(deform(cut.mesh, cut.hierarchy, 8, move)->positions,
            deform(cut.mesh, cut.hierarchy, 8, move, {.keep_volume = false})->positions);
}

TEST(Deform, TwistsATubeWithoutLosingVolume) {
  const Shape tube(tubes::tube(8, 1, 0.03, 48, 160));
  std::vector<SphereMove> twist;
  const auto spheres = tube.hierarchy.level(6)->spheres;
  for (std::size_t s = 0; s < spheres.size(); ++s)
    twist.push_back({.spheres = {SphereId(s)}, .rotate = {0.5 * spheres[s].centre.x(), 0, 0}});
  const double before = tubes::volume(tube.mesh);
  const auto volume_with = [&](Blend blend) {
    return tubes::volume(*deform(tube.mesh, tube.hierarchy, 6, twist, {.blend = blend, .keep_volume = false})) / before;
  };
  EXPECT_NEAR(volume_with(Blend::DualQuaternions), 1, 0.02);
  EXPECT_LT(volume_with(Blend::Linear), volume_with(Blend::DualQuaternions));
}

TEST(Deform, ThickensATubeWhereARadiusGrows) {
  const Shape tube(tubes::tube(8, 1, 0.03, 48, 160));
  const auto middle = tube.spheres_where(6, [](const Sphere& s) { return std::abs(s.centre.x()) < 0.5; });
  ASSERT_EQ(middle.size(), 1U);
  const double radius = tube.hierarchy.level(6)->spheres[middle[0].index()].radius;
  const SphereMove swell{.spheres = middle, .radius = 1.5 * radius};
  const auto fat = deform(tube.mesh, tube.hierarchy, 6, std::vector{swell});
  // A fifteenth short of the whole: some heat of the neighbours reaches the middle.
  EXPECT_NEAR(bounding_box(*fat).sizes().y(), 2 * 1.03 + radius, 0.2);
  EXPECT_NEAR(bounding_box(*fat).sizes().x(), bounding_box(tube.mesh).sizes().x(), 1e-3);
  EXPECT_GT(tubes::volume(*fat), 1.1 * tubes::volume(tube.mesh));
  const SphereMove shrink{.spheres = middle, .radius = 0.5 * radius};
  EXPECT_LT(tubes::volume(*deform(tube.mesh, tube.hierarchy, 6, std::vector{shrink})), 0.9 * tubes::volume(tube.mesh));
}

TEST(Deform, LeavesAloneWhatNoMovedSphereReaches) {
  const Shape tube(tubes::tube(12, 0.5, 0.03, 32, 200));
  const SphereMove pull{.spheres = tube.spheres_where(8, [](const Sphere& s) { return s.centre.x() > 5; }),
                        .translate = {0, 3, 0}};
  const auto pulled = deform(tube.mesh, tube.hierarchy, 8, std::vector{pull});
  for (std::size_t v = 0; v < tube.mesh.positions.size(); ++v)
    if (tube.mesh.positions[v].x() < 0) {
      EXPECT_EQ(pulled->positions[v], tube.mesh.positions[v]);
    }
}

TEST(Deform, IsTheSameOnAnyNumberOfThreads) {
  const Shape shape(surfaces::torus(3, 1, 120, 60, 0.2));
  std::vector<SphereMove> moves;
  for (std::size_t s = 0; s < 12; ++s)
    moves.push_back(
        {.spheres = {SphereId(s)}, .translate = {0.1, 0, 0.05}, .rotate = Vector3d(1, 0.3, -0.2) * s, .scale = 1.1});
  auto turns = moves;
  for (SphereMove& move : turns) move = {.spheres = move.spheres, .rotate = move.rotate};
  const auto many = deform(shape.mesh, shape.hierarchy, 12, moves);
  const auto many_turned = deform(shape.mesh, shape.hierarchy, 12, turns);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(deform(shape.mesh, shape.hierarchy, 12, moves)->positions, many->positions);
  EXPECT_EQ(deform(shape.mesh, shape.hierarchy, 12, turns)->positions, many_turned->positions);
}

TEST(Deform, RefusesWhatDoesNotFit) {
  const Shape shape(surfaces::icosphere(3));
  const Shape other(surfaces::icosphere(2));
  const auto message = [&](const Mesh& mesh, std::size_t level, const SphereMove& move) {
    const auto refused = deform(mesh, shape.hierarchy, level, std::vector{SphereMove{}, move});
    return refused ? std::string("taken") : refused.error().message;
  };
  EXPECT_EQ(message(other.mesh, 4, {}), "the hierarchy is of another mesh: it has 642 vertices, the mesh 162");
  EXPECT_EQ(message(surfaces::moved(shape.mesh, {0, 0, 0.1}), 4, {}),
            "the hierarchy is of another mesh: vertex 0 lies elsewhere");
  EXPECT_EQ(message(shape.mesh, 0, {}), "expected 1 to 642 spheres, found 0");
  EXPECT_EQ(message(shape.mesh, 643, {}), "expected 1 to 642 spheres, found 643");
  EXPECT_EQ(message(shape.mesh, 4, {.spheres = {SphereId(1), SphereId(4)}}),
            "move 1, spheres[1]: expected a sphere of the level, 0 to 3, found 4");
  EXPECT_EQ(message(shape.mesh, 4, {.translate = {0, std::nan(""), 0}}), "move 1, translate: expected finite numbers");
  EXPECT_EQ(message(shape.mesh, 4, {.rotate = {0, HUGE_VAL, 0}}), "move 1, rotate: expected finite numbers");
  EXPECT_EQ(message(shape.mesh, 4, {.about = Vector3d(0, 0, std::nan(""))}), "move 1, about: expected finite numbers");
  EXPECT_EQ(message(shape.mesh, 4, {.scale = 0}), "move 1, scale: expected a positive number");
  EXPECT_EQ(message(shape.mesh, 4, {.radius = -1}), "move 1, radius: expected a number that is not negative");
  for (const double far : {1e60, 1e200, 1e307})
    EXPECT_NE(
        message(shape.mesh, 4, {.spheres = shape.all(4), .translate = {2 * far, 0, 0}}).find("use smaller numbers"),
        std::string::npos);
}

TEST(Refit, OfAnUndeformedMeshIsTheHierarchy) {
  const Shape shape(tubes::tube(6, 1, 0.05));
  const Refit refit(shape.mesh, shape.hierarchy);
  const auto nodes = shape.hierarchy.nodes_of_level(20);
  const auto fitted = refit.fit(nodes, shape.mesh.positions);
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    EXPECT_EQ(fitted[s].sphere.centre, shape.hierarchy.sphere(nodes[s]).centre);
    EXPECT_EQ(fitted[s].sphere.radius, shape.hierarchy.sphere(nodes[s]).radius);
  }
}

TEST(Refit, FindsTheSpheresOfTheBuildWhereverTheMeshHasGone) {
  // Moved, turned and scaled as a whole: the same minima.
  for (const Mesh& mesh : {tubes::tube(6, 1, 0.05), surfaces::torus(3, 1, 60, 30, 0.3), ball(4)}) {
    const Shape shape(mesh);
    const Refit refit(shape.mesh, shape.hierarchy);
    Eigen::Affine3d by = Eigen::Affine3d::Identity();
    by.translate(Vector3d(5, -3, 2)).rotate(Eigen::AngleAxisd(1.2, Vector3d(1, 1, 0).normalized())).scale(2.5);
    const Mesh gone = moved(shape.mesh, by);
    const double diagonal = bounding_box_diagonal(gone);
    for (const std::size_t level : {1, 5, 30}) {
      const auto nodes = shape.hierarchy.nodes_of_level(level);
      const auto fitted = refit.fit(nodes, gone.positions);
      for (std::size_t s = 0; s < nodes.size(); ++s) {
        const Sphere sphere = shape.hierarchy.sphere(nodes[s]);
        EXPECT_LT((fitted[s].sphere.centre - by * sphere.centre).norm() / diagonal, 2e-5);
        EXPECT_NEAR(fitted[s].sphere.radius / diagonal, 2.5 * sphere.radius / diagonal, 2e-5);
        EXPECT_NEAR(fitted[s].frame.scale, 2.5, 1e-6);
        EXPECT_LT((fitted[s].frame.turn - by.rotation()).norm(), 1e-6);
      }
    }
  }
}

TEST(Refit, FollowsATubeThatWasThickened) {
  const Shape tube(tubes::tube(8, 1, 0.03, 48, 160));
  const Refit refit(tube.mesh, tube.hierarchy);
  Mesh thick = tube.mesh;
  for (Vector3d& p : thick.positions) p = Vector3d(p.x(), 1.4 * p.y(), 1.4 * p.z());
  const auto nodes = tube.hierarchy.nodes_of_level(6);
  const auto fitted = refit.fit(nodes, thick.positions);
  for (std::size_t s = 0; s < nodes.size(); ++s)
    if (const Sphere was = tube.hierarchy.sphere(nodes[s]); std::abs(was.centre.x()) < 3) {
      EXPECT_NEAR(fitted[s].sphere.radius, 1.4 * was.radius, 0.03);
    }
}

TEST(Refit, FitsOnlyWhatIsWantedAndTheSame) {
  const Shape tube(tubes::tube(8, 1, 0.03));
  const Refit refit(tube.mesh, tube.hierarchy);
  Mesh sheared = tube.mesh;
  for (Vector3d& p : sheared.positions) p.y() += 0.2 * p.x();
  const auto nodes = tube.hierarchy.nodes_of_level(12);
  const auto all = refit.fit(nodes, sheared.positions);
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    std::vector<bool> wanted(nodes.size(), false);
    wanted[s] = true;
    const auto one = refit.fit(nodes, sheared.positions, wanted);
    EXPECT_EQ(one[s].sphere.centre, all[s].sphere.centre);
    EXPECT_EQ(one[s].sphere.radius, all[s].sphere.radius);
  }
}

}  // namespace
}  // namespace armature::sdk
