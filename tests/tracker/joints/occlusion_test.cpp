#include "tracker/joints/occlusion.h"

#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace armature {
namespace {

constexpr Intrinsics kCamera{
    .width = 320, .height = 240, .focal_x_px = 280, .focal_y_px = 280, .centre_x_px = 160, .centre_y_px = 120};
constexpr std::uint8_t kUser = 1;
constexpr std::uint8_t kStranger = 2;

/// A person who fills the image at 2.5 m, and a rectangle of something else before her.
struct View {
  std::vector<std::uint16_t> depth_mm = std::vector<std::uint16_t>(320 * 240, 2500);
  std::vector<std::uint8_t> user_of_pixel = std::vector<std::uint8_t>(320 * 240, kUser);

  std::optional<FloorPlane> floor;

  [[nodiscard]] Segmentation segmentation() const {
    Segmentation out;
    out.user_of_pixel = user_of_pixel;
    out.floor = floor;
    return out;
  }
  View& cover(int left, int right, std::uint16_t mm, std::uint8_t whose) {
    for (int v = 0; v < 240; ++v)
      for (int u = left; u < right; ++u) {
        const auto pixel = static_cast<std::size_t>(v * 320 + u);
        depth_mm[pixel] = mm;
        user_of_pixel[pixel] = whose;
      }
    return *this;
  }

  /// The joint at the middle of the image after strangers were looked for.
  [[nodiscard]] Joint knee() const {
    Skeleton skeleton;
    skeleton[JointId::LeftKnee] = {
        .position = Eigen::Vector3f(0, 0, 2.55F), .confidence = 0.8F, .state = JointState::Observed};
    doubt_hidden_joints({depth_mm, kCamera, 0, {}, {}}, segmentation(), kUser, skeleton);
    return skeleton[JointId::LeftKnee];
  }
};

TEST(Occlusion, AJointInTheOpenKeepsItsConfidence) {
  EXPECT_FLOAT_EQ(View().knee().confidence, 0.8F);
  EXPECT_EQ(View().knee().state, JointState::Observed);
}

TEST(Occlusion, AJointBehindSomebodyIsInferredWithoutConfidence) {
  const Joint knee = View().cover(0, 320, 1500, kStranger).knee();
  EXPECT_EQ(knee.confidence, 0);
  EXPECT_EQ(knee.state, JointState::Inferred);
}

TEST(Occlusion, WhoComesNearerTakesConfidenceBitByBit) {
  float last = 0.8F;
  for (const int edge : {140, 150, 160}) {
    const float confidence = View().cover(0, edge, 1500, kStranger).knee().confidence;
    EXPECT_LT(confidence, last);
    last = confidence;
  }
}

TEST(Occlusion, AWallBehindHidesNothing) {
  EXPECT_FLOAT_EQ(View().cover(0, 320, 4000, 0).knee().confidence, 0.8F);
}

TEST(Occlusion, OnesOwnArmHidesNothing) {
  EXPECT_FLOAT_EQ(View().cover(0, 320, 1900, kUser).knee().confidence, 0.8F);
}

TEST(Occlusion, TheFloorBeforeSomebodyHidesNothing) {
  View view;
  view.cover(0, 320, 1500, 0);
  view.floor = {.normal = {0, -1, 0}, .offset = 1};  // a metre below the camera
  EXPECT_EQ(view.knee().confidence, 0);
  view.floor->offset = -1;  // all of the image lies on it, or lower
  EXPECT_FLOAT_EQ(view.knee().confidence, 0.8F);
}

TEST(Occlusion, PixelsWithoutDepthSayNothing) {
  EXPECT_FLOAT_EQ(View().cover(0, 320, 0, 0).knee().confidence, 0.8F);
}

TEST(Occlusion, AJointOutsideTheImageOrNowhereIsLeftAlone) {
  const View view = View().cover(0, 320, 1500, kStranger);
  Skeleton skeleton;
  const auto put = [&](JointId id, const Eigen::Vector3f& place) {
    skeleton[id] = {.position = place, .confidence = 0.8F, .state = JointState::Observed};
  };
  put(JointId::Head, {0, -9, 2.5F});
  put(JointId::Neck, {0, 0, -1});
  put(JointId::Waist, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
  doubt_hidden_joints({view.depth_mm, kCamera, 0, {}, {}}, view.segmentation(), kUser, skeleton);
  for (const JointId id : {JointId::Head, JointId::Neck, JointId::Waist}) EXPECT_EQ(skeleton[id].confidence, 0.8F);
}

}  // namespace
}  // namespace armature
