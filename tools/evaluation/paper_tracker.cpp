#include "tools/evaluation/paper_tracker.h"

#include <algorithm>
#include <initializer_list>

namespace armature::tools {
namespace {

constexpr int kTrees = 3;
constexpr float kRadius_m = 0.19F;  // as wide as a Gaussian exp(-d^2/h^2) of h = 10 cm
constexpr int kStarts = 6;
constexpr int kSteps = 20;
constexpr std::size_t kMaxVotes = 1024;
constexpr float kHalfArea_m2 = 0.0005F;  // gives a confidence of one half
constexpr float kTorsoRadius_m = 0.5F;

/// Where a joint is read from. Its parts are not all centred on it, so that it lies a constant away from their mode:
/// the paper's push-back, medians over training images.
struct Source {
  std::uint32_t parts;  ///< bits of 1 << PartLabel
  float down_m;         ///< in the image
  float back_m;         ///< along the camera's axis
};

constexpr Source left_or_middle(JointId joint) {
  using enum PartLabel;
  const auto from = [](float down_m, float back_m, std::initializer_list<PartLabel> parts) {
    Source source{0, down_m, back_m};
    for (const PartLabel part : parts) source.parts |= 1U << index(part);
    return source;
  };
  switch (joint) {
    case JointId::HeadTop: return from(-0.037F, 0.056F, {HeadTopLeft, HeadTopRight});
    case JointId::Head: return from(-0.009F, 0.066F, {HeadTopLeft, HeadTopRight, HeadLeft, HeadRight});
    case JointId::Neck: return from(0.060F, 0.078F, {Neck});
    case JointId::Chest: return from(0.010F, 0.124F, {LeftClavicle, RightClavicle});
    case JointId::Torso: return from(-0.007F, 0.142F, {LeftClavicle, RightClavicle, LeftWaist, RightWaist});
    case JointId::Waist: return from(0.005F, 0.136F, {LeftWaist, RightWaist, LeftHip, RightHip});
    case JointId::LeftCollar: return from(-0.075F, 0.082F, {LeftClavicle});
    case JointId::LeftShoulder: return from(-0.015F, 0.055F, {LeftShoulder});
    case JointId::LeftUpperArm: return from(-0.024F, 0.051F, {LeftUpperArm});
    case JointId::LeftElbow: return from(-0.010F, 0.051F, {LeftElbow});
    case JointId::LeftForearm: return from(-0.004F, 0.039F, {LeftForearm});
    case JointId::LeftWrist: return from(-0.004F, 0.025F, {LeftWrist});
    case JointId::LeftHand: return from(-0.002F, 0.025F, {LeftHand});
    case JointId::LeftHip: return from(-0.013F, 0.104F, {LeftHip});
    case JointId::LeftThigh: return from(0.008F, 0.083F, {LeftThigh});
    case JointId::LeftKnee: return from(0.006F, 0.067F, {LeftKnee});
    case JointId::LeftAnkle: return from(-0.054F, 0.115F, {LeftFoot});
    case JointId::LeftFoot: return from(0.016F, 0.022F, {LeftFoot});
    default: return {0, 0, 0};
  }
}

constexpr Source source_of(JointId joint) {
  if (mirrored(joint) == joint || joint < JointId::RightCollar) return left_or_middle(joint);
  const Source left = left_or_middle(mirrored(joint));
  Source right{0, left.down_m, left.back_m};
  for (int part = 0; part < kPartCount; ++part) {
    if ((left.parts >> part & 1U) != 0) right.parts |= 1U << index(mirrored(static_cast<PartLabel>(part)));
  }
  return right;
}

}  // namespace

Forest paper_forest_of(const Forest& forest) {
  const auto trees = forest.trees();
  const std::size_t count = std::min<std::size_t>(kTrees, trees.size());
  return *Forest::create({trees.begin(), trees.begin() + static_cast<std::ptrdiff_t>(count)}, forest.command());
}

PaperTracker::PaperTracker(std::shared_ptr<const Forest> forest, int stride)
    : classifier_(std::move(forest), {.stride = stride}), cloud_(kMaxVotes) {}

const Skeleton& PaperTracker::track(DepthView frame, std::span<const std::uint8_t> mask) {
  const PartVotes& votes = classifier_.classify(frame, mask, 1);
  labels_.resize(votes.pixels.size());
  std::transform(votes.pixels.begin(), votes.pixels.end(), labels_.begin(), most_likely_part);
  skeleton_ = Skeleton{};
  for (std::size_t j = 0; j < kJointCount; ++j) find(static_cast<JointId>(j), votes);

  // P: the centre of mass of the torso's pixels.
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float area = 0;
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    const ClassifiedPixel& pixel = votes.pixels[i];
    if (!is_torso(labels_[i])) continue;
    if ((pixel.point - skeleton_[JointId::Torso].position).norm() > kTorsoRadius_m) continue;
    sum += pixel.area_m2 * pixel.point;
    area += pixel.area_m2;
  }
  skeleton_.user_position = area > 0 ? Eigen::Vector3f(sum / area) : skeleton_[JointId::Torso].position;
  return skeleton_;
}

void PaperTracker::find(JointId joint, const PartVotes& votes) {
  const Source source = source_of(joint);
  const auto is_mine = [&](PartLabel label) { return (source.parts >> index(label) & 1U) != 0; };
  const auto count = static_cast<std::size_t>(std::count_if(labels_.begin(), labels_.end(), is_mine));
  if (count == 0) return;
  // Where there are too many votes, every n-th stands for n.
  const std::size_t every = (count + kMaxVotes - 1) / kMaxVotes;
  const std::size_t start_every = std::max<std::size_t>(1, count / kStarts);
  std::array<Eigen::Vector3f, kStarts + 1> starts;
  std::size_t start_count = 0, seen = 0;
  cloud_.clear();
  for (std::size_t i = 0; i < labels_.size(); ++i) {
    if (!is_mine(labels_[i])) continue;
    const ClassifiedPixel& pixel = votes.pixels[i];
    if (seen % every == 0) cloud_.add(pixel.point, pixel.area_m2 * static_cast<float>(every));
    if (seen % start_every == start_every / 2 && start_count < starts.size()) starts[start_count++] = pixel.point;
    ++seen;
  }
  cloud_.finish();
  VoteMode best;
  for (std::size_t i = 0; i < start_count; ++i) {
    const VoteMode mode = cloud_.mode_near(starts[i], kRadius_m, kSteps);
    if (mode.mass > best.mass) best = mode;
  }
  if (best.mass <= 0) return;
  skeleton_[joint] = {best.position + Eigen::Vector3f(0, source.down_m, source.back_m),
                      best.mass / (best.mass + kHalfArea_m2), JointState::Observed};
}

}  // namespace armature::tools
