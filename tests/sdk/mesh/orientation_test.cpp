#include <numbers>

#include <armature/sdk/mesh/orientation.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using surfaces::inside_out;
using surfaces::moved;
using surfaces::together;

std::vector<double> volumes(const Mesh& mesh) {
  return signed_volumes(mesh, find_components(mesh, Adjacency(mesh), LinkedBy::Vertices));
}

/// The volumes after orient_outward().
std::vector<double> outward(Mesh mesh) {
  EXPECT_TRUE(orient_outward(mesh));
  EXPECT_EQ(orient_outward(mesh), 0U) << "a second time changes nothing";
  return volumes(mesh);
}

const Mesh kBall = surfaces::icosphere(2);
const double kVolume = volumes(kBall)[0];

TEST(SignedVolume, IsThatOfTheSolidWhereverItIs) {
  EXPECT_NEAR(volumes(surfaces::cube())[0], 1, 1e-12);
  EXPECT_NEAR(volumes(inside_out(surfaces::cube()))[0], -1, 1e-12);
  EXPECT_NEAR(volumes(moved(surfaces::cube(), Vector3d(1e6, -1e6, 1e6)))[0], 1, 1e-6);
  EXPECT_NEAR(volumes(surfaces::torus(3, 1, 200, 100))[0], 6 * std::numbers::pi * std::numbers::pi, 0.1);
}

TEST(Orienting, TurnsAnInsideOutBallOver) {
  EXPECT_NEAR(outward(inside_out(kBall))[0], kVolume, 1e-9);
  EXPECT_NEAR(outward(kBall)[0], kVolume, 1e-9);
}

TEST(Orienting, MakesFacesAgreeWithMostOfTheArea) {
  Mesh ball = kBall;
  for (std::size_t i = 0; i < ball.triangles.size(); i += 3) std::swap(ball.triangles[i][0], ball.triangles[i][1]);
  EXPECT_NEAR(outward(ball)[0], kVolume, 1e-9);
}

TEST(Orienting, KeepsTheInnerShellOfAHollowBall) {
  const Mesh hollow = together(kBall, inside_out(moved(kBall, Vector3d::Zero(), 0.5)));
  const auto v = outward(hollow);
  EXPECT_NEAR(v[0], kVolume, 1e-9);
  EXPECT_NEAR(v[1], -kVolume / 8, 1e-9);
}

TEST(Orienting, TurnsAHollowBallThatIsInsideOutAsAWhole) {
  const auto v = outward(inside_out(together(kBall, inside_out(moved(kBall, Vector3d::Zero(), 0.5)))));
  EXPECT_NEAR(v[0], kVolume, 1e-9);
  EXPECT_NEAR(v[1], -kVolume / 8, 1e-9);
}

TEST(Orienting, KeepsASolidWithinASolid) {
  EXPECT_NEAR(outward(together(moved(kBall, Vector3d::Zero(), 0.5), kBall))[0], kVolume / 8, 1e-9);
}

TEST(Orienting, LooksAtEachShellByItself) {
  // The second one lies within the first one's box, but not within it.
  const Mesh two = together(kBall, inside_out(moved(kBall, Vector3d(0.8, 0.8, 0.8), 0.1)));
  const auto v = outward(two);
  EXPECT_NEAR(v[0], kVolume, 1e-9);
  EXPECT_NEAR(v[1], kVolume / 1000, 1e-9);
}

TEST(Orienting, TurnsAnOpenBowlButNoSheet) {
  Mesh bowl = inside_out(kBall);
  std::erase_if(bowl.triangles, [&](const Triangle& t) {
    for (const VertexId v : t)
      if (bowl.position(v).z() > 0) return true;
    return false;
  });
  EXPECT_EQ(orient_outward(bowl), bowl.triangles.size());
  Mesh sheet = surfaces::paraboloid(0, 0, 5);
  EXPECT_EQ(orient_outward(sheet), 0U);
  sheet = inside_out(sheet);
  EXPECT_EQ(orient_outward(sheet), 0U);
}

TEST(Orienting, OfWhatIsDegenerateChangesNothing) {
  Mesh mesh;
  EXPECT_EQ(orient_outward(mesh), 0U);
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.triangles = {surfaces::triangle(0, 1, 2), surfaces::triangle(1, 1, 1)};
  EXPECT_EQ(orient_outward(mesh), 0U);
}

}  // namespace
}  // namespace armature::sdk
