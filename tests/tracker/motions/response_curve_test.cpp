#include "tracker/motions/response_curve.h"

#include <gtest/gtest.h>

namespace armature {
namespace {

constexpr ResponseCurve kCurve{.knee_rad = 0.2F, .near = 2, .far = 0.5F};

TEST(ResponseCurve, IsSteepUpToItsKneeAndFlatBeyond) {
  EXPECT_FLOAT_EQ(kCurve.true_angle(0), 0);
  EXPECT_FLOAT_EQ(kCurve.true_angle(0.05F), 0.1F);
  EXPECT_FLOAT_EQ(kCurve.true_angle(0.1F), 0.2F);
  EXPECT_FLOAT_EQ(kCurve.true_angle(0.3F), 0.3F);
}

TEST(ResponseCurve, IsTheSameToBothSides) {
  for (const float shown : {0.03F, 0.1F, 0.4F}) EXPECT_EQ(kCurve.true_angle(-shown), -kCurve.true_angle(shown));
}

TEST(ResponseCurve, TheInverseLeadsBack) {
  for (const float shown : {-0.4F, -0.05F, 0.0F, 0.1F, 0.25F}) {
    EXPECT_NEAR(kCurve.shown_angle(kCurve.true_angle(shown)), shown, 1e-6F);
  }
}

}  // namespace
}  // namespace armature
