#include "tools/commands/appliance/site.h"

#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace armature::tools {
namespace {

// A sensor that looks down by 20 degrees; camera frame: x right, y down, z forward.
const Eigen::Vector3f kUp =
    Eigen::AngleAxisf(20 * std::numbers::pi_v<float> / 180, Eigen::Vector3f::UnitX()) * -Eigen::Vector3f::UnitY();

Eigen::Vector3f leaning(float degrees, const Eigen::Vector3f& about) {
  return Eigen::AngleAxisf(degrees * std::numbers::pi_v<float> / 180, about) * kUp;
}

TEST(Site, ALevelFloorLeansNotAtAll) {
  EXPECT_NEAR(degrees_between(kUp, kUp), 0, 1e-3);
  EXPECT_NEAR(degrees_between(kUp, 3 * kUp), 0, 1e-3) << "directions have no length";
}

TEST(Site, ARampAheadLeans) {
  EXPECT_NEAR(degrees_between(kUp, leaning(8, Eigen::Vector3f::UnitX())), 8, 1e-3);
}

TEST(Site, ARampToTheSideLeansThoughTheSensorLooksDownAsFar) {
  const Eigen::Vector3f ahead = Eigen::Vector3f::UnitX().cross(kUp).normalized();
  EXPECT_NEAR(degrees_between(kUp, leaning(8, ahead)), 8, 1e-3);
  EXPECT_NEAR(degrees_between(kUp, leaning(-8, ahead)), 8, 1e-3);
}

}  // namespace
}  // namespace armature::tools
