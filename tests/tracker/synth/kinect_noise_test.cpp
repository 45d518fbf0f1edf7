#include "tracker/synth/kinect_noise.h"

#include <cmath>

#include <gtest/gtest.h>

namespace armature {
namespace {

SurfaceImage wall_at(float z, int width = 320, int height = 240) {
  SurfaceImage image;
  image.reset(kinect_intrinsics(width, height));
  std::fill(image.depth_m.begin(), image.depth_m.end(), z);
  return image;
}

struct Statistics {
  double mean = 0, sigma = 0, neighbour_correlation = 0;
};

Statistics measure(const SensedImage& sensed, int width, double truth_mm) {
  Statistics s;
  double n = 0, product = 0;
  for (std::size_t i = 0; i < sensed.depth_mm.size(); ++i) {
    const double e = sensed.depth_mm[i] - truth_mm;
    s.mean += e;
    s.sigma += e * e;
    if (i % static_cast<std::size_t>(width) != 0) product += e * (sensed.depth_mm[i - 1] - truth_mm);
    ++n;
  }
  s.mean /= n;
  s.sigma = std::sqrt(s.sigma / n - s.mean * s.mean);
  s.neighbour_correlation = product / n / (s.sigma * s.sigma);
  return s;
}

TEST(KinectNoise, AxialSigmaFollowsTheModel) {
  // Disparities lie on a grid: averaged over walls at all phases of it, sigma is the model's within 10 %.
  KinectSensor sensor;
  SensedImage sensed;
  for (const double z : {1.0, 2.0, 3.0}) {
    const double step = z * z / 348;
    double variance = 0;
    for (int phase = 0; phase < 8; ++phase) {
      const double at = z + step * phase / 8;
      sensor.sense(wall_at(static_cast<float>(at)), {}, 100 + static_cast<std::uint64_t>(phase), 1, sensed);
      const Statistics s = measure(sensed, 320, 1000 * at);
      variance += (s.sigma * s.sigma + s.mean * s.mean) / 8;
    }
    EXPECT_NEAR(std::sqrt(variance) / (1000 * axial_sigma(z)), 1, 0.10) << "at " << z << " m";
  }
}

TEST(KinectNoise, NeighboursErrAlike) {
  KinectSensor sensor;
  SensedImage sensed;
  sensor.sense(wall_at(3.0F), {}, 7, 1, sensed);
  EXPECT_GT(measure(sensed, 320, 3000).neighbour_correlation, 0.3);
}

TEST(KinectNoise, EveryDepthIsADisparityInEighths) {
  KinectSensor sensor;
  SensedImage sensed;
  sensor.sense(wall_at(2.4F), {}, 3, 1, sensed);
  for (const std::uint16_t depth : sensed.depth_mm) {
    const double disparity = 348000.0 / depth;
    EXPECT_NEAR(disparity, std::nearbyint(disparity), 0.5 * 348000.0 / depth / depth + 1e-9);
  }
}

TEST(KinectNoise, WithoutNoiseDepthIsTheTruthInMillimetres) {
  KinectSensor sensor;
  SensedImage sensed;
  sensor.sense(wall_at(2.3456F), {.strength = 0}, 3, 1, sensed);
  for (const std::uint16_t depth : sensed.depth_mm) EXPECT_EQ(depth, 2346);
}

/// A board of this half width in pixels at 1.5 m before a wall at 3.5 m.
SurfaceImage board() {
  SurfaceImage image = wall_at(3.5F);
  for (int v = 60; v < 180; ++v) {
    for (int u = 120; u < 200; ++u) image.depth_m[static_cast<std::size_t>(v * 320 + u)] = 1.5F;
  }
  return image;
}

TEST(KinectNoise, TheShadowLiesLeftOfANearThingAndIsAsWideAsTheDisparityStep) {
  KinectSensor sensor;
  SensedImage sensed;
  sensor.sense(board(), {}, 3, 1, sensed);
  // 285.63 px x 75 mm x (1/1.5 - 1/3.5) = 8.2 px at 320 columns.
  double left = 0, right = 0;
  for (int v = 70; v < 170; ++v) {
    for (int u = 100; u < 120; ++u) left += sensed.depth_mm[static_cast<std::size_t>(v * 320 + u)] == 0;
    for (int u = 200; u < 220; ++u) right += sensed.depth_mm[static_cast<std::size_t>(v * 320 + u)] == 0;
  }
  EXPECT_NEAR(left / 100, 8.2, 1.5);
  EXPECT_LT(right / 100, 1.5);
}

TEST(KinectNoise, EdgesAreRaggedByAboutAPixel) {
  KinectSensor sensor;
  SensedImage sensed;
  sensor.sense(board(), {}, 3, 1, sensed);
  double sum = 0, squares = 0;
  for (int v = 70; v < 170; ++v) {
    int edge = 210;
    while (sensed.depth_mm[static_cast<std::size_t>(v * 320 + edge)] > 2000 ||
           sensed.depth_mm[static_cast<std::size_t>(v * 320 + edge)] == 0) {
      --edge;
    }
    sum += edge;
    squares += edge * edge;
  }
  const double mean = sum / 100, sigma = std::sqrt(squares / 100 - mean * mean);
  EXPECT_NEAR(mean, 199.5, 1.0);
  EXPECT_GT(sigma, 0.2);
  EXPECT_LT(sigma, 1.2);
}

TEST(KinectNoise, SomeOfTheHairIsMissing) {
  SurfaceImage image = wall_at(2.0F);
  std::fill(image.material.begin(), image.material.end(), static_cast<std::uint8_t>(Material::Hair));
  KinectSensor sensor;
  SensedImage sensed;
  sensor.sense(image, {.hair_missing = 0.3}, 3, 1, sensed);
  double missing = 0;
  for (const std::uint16_t depth : sensed.depth_mm) missing += depth == 0;
  EXPECT_GT(missing / static_cast<double>(sensed.depth_mm.size()), 0.1);
  EXPECT_LT(missing / static_cast<double>(sensed.depth_mm.size()), 0.5);
}

TEST(KinectNoise, TheSameSeedGivesTheSameBytesAndAnotherSeedOthers) {
  KinectSensor a, b;
  SensedImage first, second, third;
  a.sense(board(), {}, 3, 1, first);
  b.sense(board(), {}, 3, 1, second);
  b.sense(board(), {}, 4, 1, third);
  EXPECT_EQ(first.depth_mm, second.depth_mm);
  EXPECT_NE(first.depth_mm, third.depth_mm);
}

}  // namespace
}  // namespace armature
