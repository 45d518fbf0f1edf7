#include <cmath>
#include <numbers>
#include <vector>

#include <armature/sdk/spheremesh/fewest_spheres.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

/// A closed cylinder along x, from 0 to 10, of radius 1.
Mesh cylinder() {
  constexpr std::size_t kRound = 24;
  Mesh mesh;
  for (const double x : {0.0, 10.0}) {
    for (std::size_t i = 0; i < kRound; ++i) {
      const double turn = 2 * std::numbers::pi * static_cast<double>(i) / kRound;
      mesh.positions.emplace_back(x, std::cos(turn), std::sin(turn));
    }
  }
  for (std::size_t i = 0; i < kRound; ++i) {
    const std::size_t next = (i + 1) % kRound;
    mesh.triangles.push_back({VertexId(i), VertexId(next), VertexId(kRound + i)});
    mesh.triangles.push_back({VertexId(next), VertexId(kRound + next), VertexId(kRound + i)});
  }
  return mesh;
}

/// Unit balls spread along the cylinder's axis, joined by nothing: the more, the nearer.
Expected<SphereMesh> balls(std::size_t count) {
  SphereMesh shape;
  for (std::size_t i = 0; i < count; ++i) {
    shape.spheres.push_back({{10 * (static_cast<double>(i) + 0.5) / static_cast<double>(count), 0, 0}, 1});
  }
  return shape;
}

TEST(FewestSpheres, KeepTheBoundAndOneSphereLessDoesNot) {
  const Mesh mesh = cylinder();
  std::vector<std::size_t> tried;
  const auto result = fewest_spheres(mesh, {.percent = 0.5, .least = 1, .most = 200}, [&](std::size_t count) {
    tried.push_back(count);
    return balls(count);
  });
  ASSERT_TRUE(result) << result.error().message;
  const std::size_t count = result->spheres.size();
  EXPECT_LT(count, 100U);
  const auto fewer = fewest_spheres(mesh, {.percent = 0.5, .least = count - 1, .most = count - 1}, balls);
  EXPECT_FALSE(fewer);
  EXPECT_LT(tried.size(), 16U);  // doubling and halving, not counting
}

TEST(FewestSpheres, WhatCannotBeKeptIsRefusedWithTheErrorThatRemains) {
  const auto result = fewest_spheres(cylinder(), {.percent = 1e-6, .least = 1, .most = 4}, balls);
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find("even 4 spheres"), std::string::npos) << result.error().message;
}

TEST(FewestSpheres, AskingToStopStops) {
  std::stop_source stop;
  const auto result = fewest_spheres(cylinder(), {.percent = 0.01, .least = 1, .most = 1000},
                                     [&](std::size_t count) {
                                       if (count >= 4) stop.request_stop();
                                       return balls(count);
                                     },
                                     {.stop = stop.get_token()});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::Cancelled);
}

}  // namespace
}  // namespace armature::sdk
