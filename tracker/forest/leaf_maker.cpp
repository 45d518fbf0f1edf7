#include "tracker/forest/leaf_maker.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tracker/forest/joint_parts.h"

namespace armature {
namespace {

constexpr std::size_t kMaxOffsets = 1000;  // more would not change a mean by a millimetre
constexpr float kModeRadius_m = 0.15F;
constexpr int kModeSteps = 4;
constexpr float kSpread_m = 0.04F;
constexpr float kMinNearby = 0.1F;  // below, the leaf knows nothing of the joint

struct OffsetMode {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  float variance_m2 = 0;  // per axis, of all the offsets about the mode
};

OffsetMode offset_mode(std::span<const Eigen::Vector3f> offsets) {
  OffsetMode mode;
  for (const Eigen::Vector3f& offset : offsets) mode.mean += offset;
  mode.mean /= static_cast<float>(offsets.size());
  for (int step = 0; step < kModeSteps; ++step) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    int count = 0;
    for (const Eigen::Vector3f& offset : offsets) {
      if ((offset - mode.mean).squaredNorm() > kModeRadius_m * kModeRadius_m) continue;
      sum += offset;
      ++count;
    }
    if (count == 0) break;
    mode.mean = sum / static_cast<float>(count);
  }
  for (const Eigen::Vector3f& offset : offsets) mode.variance_m2 += (offset - mode.mean).squaredNorm();
  mode.variance_m2 /= 3 * static_cast<float>(offsets.size());
  return mode;
}

std::array<std::uint8_t, 32> probabilities(std::span<const std::size_t> counts, std::size_t total) {
  std::array<std::uint8_t, 32> result{};
  std::size_t sum = 0;
  std::size_t largest = 0;
  for (std::size_t part = 0; part < kPartCount; ++part) {
    result[part] = static_cast<std::uint8_t>(counts[part] * 255 / total);
    sum += result[part];
    if (counts[part] > counts[largest]) largest = part;
  }
  result[largest] = static_cast<std::uint8_t>(result[largest] + (255 - sum));
  return result;
}

LeafVote make_vote(std::size_t joint, const OffsetMode& mode, float weight) {
  LeafVote vote;
  for (int axis = 0; axis < 3; ++axis) {
    const float units = std::floor(mode.mean[axis] / LeafVote::kUnit_m + 0.5F);
    vote.offset[static_cast<std::size_t>(axis)] = static_cast<std::int8_t>(std::clamp(units, -127.0F, 127.0F));
  }
  vote.joint = static_cast<std::uint8_t>(joint);
  vote.weight_code = vote_weight_code(weight);
  return vote;
}

}  // namespace

Leaf make_leaf(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples) {
  Leaf leaf;
  std::array<std::size_t, kPartCount> counts{};
  for (const TrainingSample& sample : samples) ++counts[sample.part];
  leaf.probability = probabilities(counts, samples.size());

  const std::size_t used = std::min(samples.size(), kMaxOffsets);
  std::vector<Eigen::Vector3f> points(used);
  std::vector<const TrainingPerson*> owners(used);
  for (std::size_t i = 0; i < used; ++i) {
    const TrainingSample& sample = samples[i * samples.size() / used];
    owners[i] = &persons[sample.person];
    points[i] = owners[i]->point(sample.u, sample.v);
  }

  struct Candidate {
    float weight;
    LeafVote vote;
  };
  std::vector<Candidate> candidates;
  std::vector<Eigen::Vector3f> offsets(used);
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    const std::uint32_t nearby_parts = parts_around(static_cast<JointId>(joint));
    std::size_t nearby = 0;
    for (std::size_t part = 0; part < kPartCount; ++part) {
      if ((nearby_parts >> part & 1U) != 0) nearby += counts[part];
    }
    const float probability = static_cast<float>(nearby) / static_cast<float>(samples.size());
    if (probability < kMinNearby) continue;
    for (std::size_t i = 0; i < used; ++i) offsets[i] = owners[i]->joints[joint] - points[i];
    const OffsetMode mode = offset_mode(offsets);
    const float certainty = kSpread_m * kSpread_m / (mode.variance_m2 + kSpread_m * kSpread_m);
    const float weight = probability * certainty * certainty;
    candidates.push_back({weight, make_vote(joint, mode, weight)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.weight > b.weight; });
  for (std::size_t i = 0; i < std::min<std::size_t>(candidates.size(), kVotesPerLeaf); ++i) {
    leaf.votes[i] = candidates[i].vote;
  }
  return leaf;
}

}  // namespace armature
