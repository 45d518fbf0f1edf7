#pragma once

#include <cmath>

#include "tracker/forest/random.h"
#include "tracker/forest/trainer.h"

namespace armature {

/// A person cut from a flat board that faces the camera, 1.6 m tall: head, neck, torso with a waist on each side, two
/// legs with feet. Every part can be told by where in the outline it lies.
struct PaperDoll {
  float x_m = 0;  ///< of its middle
  float top_m = -0.8F;
  float z_m = 2.5F;
};

[[nodiscard]] inline Intrinsics qvga() {
  return {320, 240, 285.0, 285.0, 160.0, 120.0};
}
[[nodiscard]] inline Intrinsics vga() {
  return {640, 480, 570.0, 570.0, 320.0, 240.0};
}

/// The part at `x` right and `y` down from the doll's top middle, metres.
[[nodiscard]] inline std::uint8_t paper_part(float x, float y) {
  const auto side = [x](PartLabel left) {
    return static_cast<std::uint8_t>(index(x > 0 ? left : mirrored(left)));  // its left is the camera's right
  };
  const float across = std::abs(x);
  if (y < 0 || y >= 1.6F) return kNoPart;
  if (y < 0.24F) return across < 0.1F ? side(PartLabel::HeadLeft) : kNoPart;
  if (y < 0.32F) return across < 0.06F ? static_cast<std::uint8_t>(index(PartLabel::Neck)) : kNoPart;
  if (y < 0.8F) return across < 0.22F ? side(PartLabel::LeftWaist) : kNoPart;
  if (across < 0.04F || across > 0.2F) return kNoPart;
  return side(y < 1.3F ? PartLabel::LeftThigh : PartLabel::LeftFoot);
}

[[nodiscard]] inline Eigen::Vector3f paper_joint(const PaperDoll& doll, JointId joint) {
  const auto at = [&](float x, float y) { return Eigen::Vector3f(doll.x_m + x, doll.top_m + y, doll.z_m + 0.05F); };
  switch (joint) {
    case JointId::Head: return at(0, 0.12F);
    case JointId::Neck: return at(0, 0.3F);
    case JointId::LeftThigh: return at(0.12F, 1.05F);
    case JointId::RightThigh: return at(-0.12F, 1.05F);
    case JointId::LeftFoot: return at(0.12F, 1.5F);
    case JointId::RightFoot: return at(-0.12F, 1.5F);
    default: return at(0, 0.55F);
  }
}

[[nodiscard]] inline TrainingImage paper_image(const PaperDoll& doll, const Intrinsics& intrinsics) {
  TrainingImage image;
  image.intrinsics = intrinsics;
  image.depth_mm.assign(static_cast<std::size_t>(intrinsics.width * intrinsics.height), 0);
  image.part_of_pixel.assign(image.depth_mm.size(), kNoPart);
  for (int v = 0; v < intrinsics.height; ++v) {
    for (int u = 0; u < intrinsics.width; ++u) {
      const auto x = static_cast<float>((u - intrinsics.centre_x_px) / intrinsics.focal_x_px) * doll.z_m;
      const auto y = static_cast<float>((v - intrinsics.centre_y_px) / intrinsics.focal_y_px) * doll.z_m;
      const auto pixel = static_cast<std::size_t>(v * intrinsics.width + u);
      image.part_of_pixel[pixel] = paper_part(x - doll.x_m, y - doll.top_m);
      if (image.part_of_pixel[pixel] != kNoPart) {
        image.depth_mm[pixel] = static_cast<std::uint16_t>(std::lround(doll.z_m * 1000));
      }
    }
  }
  image.user.resize(image.part_of_pixel.size());
  for (std::size_t i = 0; i < image.user.size(); ++i) image.user[i] = image.part_of_pixel[i] == kNoPart ? 0 : 1;
  for (std::size_t j = 0; j < kJointCount; ++j) image.joints[j] = paper_joint(doll, static_cast<JointId>(j));
  return image;
}

/// The i-th doll of a fixed crowd, 2.2 to 3.2 m away.
[[nodiscard]] inline PaperDoll paper_doll(int i) {
  TrainingRandom random(derive_seed(77, static_cast<std::uint64_t>(i)));
  return {.x_m = static_cast<float>(random.between(-300, 300)) * 0.001F,
          .top_m = static_cast<float>(random.between(-850, -750)) * 0.001F,
          .z_m = static_cast<float>(random.between(2200, 3200)) * 0.001F};
}

[[nodiscard]] inline TrainingImages paper_images() {
  return [](int i) { return paper_image(paper_doll(i), qvga()); };
}

/// Trains in a fraction of a second.
[[nodiscard]] inline TrainerOptions paper_training() {
  TrainerOptions options;
  options.image_count = 40;
  options.tree_count = 2;
  options.max_depth = 10;
  options.pixels_per_image = 200;
  options.features_per_node = 60;
  options.node_samples = 2000;
  options.min_leaf_samples = 4;
  options.seed = 5;
  options.threads = 1;
  options.command = "paper";
  return options;
}

}  // namespace armature
