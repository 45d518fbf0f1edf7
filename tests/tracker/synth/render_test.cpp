#include "tracker/synth/render.h"

#include <gtest/gtest.h>

namespace armature {
namespace {

using Eigen::Vector3d;

Intrinsics small() {
  return kinect_intrinsics(160, 120);
}

float depth_at(const SurfaceImage& image, int u, int v) {
  return image.depth_m[static_cast<std::size_t>(v) * static_cast<std::size_t>(image.intrinsics.width) +
                       static_cast<std::size_t>(u)];
}

TEST(Render, ASphereOnTheAxisIsNearestInTheMiddle) {
  SurfaceImage image;
  image.reset(small());
  SurfaceEdge ball;
  ball.edge = {{{0, 0, 2}, 0.3}, {{0, 0, 2}, 0.3}};
  ball.cut.bands[0] = {1e9, 7, 7};
  render_edges(std::vector<SurfaceEdge>{ball}, 1, image);
  EXPECT_NEAR(depth_at(image, 80, 60), 1.7F, 1e-6);
  EXPECT_EQ(depth_at(image, 10, 10), SurfaceImage::kNothing);
  EXPECT_EQ(image.part[60 * 160 + 80], 7);
  EXPECT_EQ(image.owner[60 * 160 + 80], 1);
}

TEST(Render, TheRectangleCutsNothingOff) {
  // Every pixel whose ray meets the primitive is drawn, also at the border of its rectangle.
  const SurfaceEdge limb{{{{-0.3, 0.2, 1.5}, 0.10}, {{0.35, -0.25, 2.2}, 0.04}}, {}, Material::Body};
  SurfaceImage image;
  image.reset(small());
  render_edges(std::vector<SurfaceEdge>{limb}, 1, image);
  const Intrinsics k = small();
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const sdk::Ray ray{Vector3d::Zero(), {(u - k.centre_x_px) / k.focal_x_px, (v - k.centre_y_px) / k.focal_y_px, 1}};
      EXPECT_EQ(sdk::intersect(limb.edge, ray).has_value(), depth_at(image, u, v) < SurfaceImage::kNothing)
          << u << "," << v;
    }
  }
}

TEST(Render, TheFloorIsWhereTheCamerasHeightPutsIt) {
  SurfaceImage image;
  image.reset(small());
  const RigidTransform camera = camera_from_world(1.0, 0.2);
  render_room(Room{}, camera, image);
  const Intrinsics k = small();
  const RigidTransform world{camera.rotation.transpose(), -(camera.rotation.transpose() * camera.translation)};
  int floor = 0;
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const auto pixel = static_cast<std::size_t>(v * k.width + u);
      if (image.material[pixel] != static_cast<std::uint8_t>(Material::Floor)) continue;
      ++floor;
      const double z = static_cast<double>(image.depth_m[pixel]);
      const Vector3d point{(u - k.centre_x_px) / k.focal_x_px * z, (v - k.centre_y_px) / k.focal_y_px * z, z};
      EXPECT_NEAR((world * point).y(), 0, 1e-5);
    }
  }
  EXPECT_GT(floor, 2000);
}

TEST(Render, ALevelCameraSeesTheWorldUpright) {
  const RigidTransform camera = camera_from_world(1.0, 0);
  const Vector3d head = camera * Vector3d(0.3, 1.7, -2.5);
  EXPECT_LT((head - Vector3d(0.3, -0.7, 2.5)).norm(), 1e-9);
  // Looking down moves what is ahead towards the top of the image.
  EXPECT_LT((camera_from_world(1.0, 0.1) * Vector3d(0, 1.0, -2)).y(), -0.1);
}

}  // namespace
}  // namespace armature
