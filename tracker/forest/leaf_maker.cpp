#include "tracker/forest/leaf_maker.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tracker/forest/joint_parts.h"
#include "tracker/forest/random.h"

namespace armature {
namespace {

constexpr std::int64_t kMaxOffsets = 1000;  // of a leaf; more would not change a mean by a millimetre
constexpr std::size_t kLeavesAtOnce = 64;
constexpr float kUnits_per_m = 10000;
constexpr std::int64_t kModeRadius = 1500;  // 15 cm
constexpr std::int64_t kEverywhere = 1'000'000;
constexpr int kModeSteps = 4;
constexpr float kSpread_m = 0.04F;
constexpr float kMinNearby = 0.1F;  // below, the leaf knows nothing of the joint

/// In units of a tenth of a millimetre.
using Offset = std::array<std::int64_t, 3>;

Offset in_units(const Eigen::Vector3f& metres) {
  Offset offset{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    offset[axis] = std::llround(metres[static_cast<Eigen::Index>(axis)] * kUnits_per_m);
  }
  return offset;
}

std::int64_t squared_distance(const Offset& a, const Offset& b) {
  std::int64_t sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) sum += (a[axis] - b[axis]) * (a[axis] - b[axis]);
  return sum;
}

/// Where one joint lies from the samples of one leaf.
struct JointOffsets {
  std::size_t joint = 0;
  float probability = 0;        // of the parts around the joint
  std::vector<Offset> offsets;  // from this rank's samples
  Offset mode{};                // of those of all ranks
  float variance_m2 = 0;        // per axis, of all the offsets about the mode
};

/// Moves each mode to the mean of the offsets within `radius` of it.
void shift_modes(std::span<JointOffsets> all, std::int64_t radius, Ranks& ranks) {
  std::vector<std::int64_t> sums(all.size() * 4, 0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const Offset& offset : all[i].offsets) {
      if (squared_distance(offset, all[i].mode) > radius * radius) continue;
      for (std::size_t axis = 0; axis < 3; ++axis) sums[4 * i + axis] += offset[axis];
      ++sums[4 * i + 3];
    }
  }
  ranks.sum(sums);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::int64_t count = sums[4 * i + 3];
    if (count == 0) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) all[i].mode[axis] = sums[4 * i + axis] / count;
  }
}

void find_variances(std::span<JointOffsets> all, Ranks& ranks) {
  std::vector<std::int64_t> sums(all.size() * 2, 0);
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const Offset& offset : all[i].offsets) sums[2 * i] += squared_distance(offset, all[i].mode);
    sums[2 * i + 1] = std::ssize(all[i].offsets);
  }
  ranks.sum(sums);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto mean =
        static_cast<double>(sums[2 * i]) / static_cast<double>(std::max<std::int64_t>(1, sums[2 * i + 1]));
    all[i].variance_m2 = static_cast<float>(mean / (3.0 * kUnits_per_m * kUnits_per_m));
  }
}

std::array<std::uint8_t, 32> probabilities(const PartCounts& counts) {
  const std::int64_t all = total(counts);
  std::array<std::uint8_t, 32> result{};
  int sum = 0;
  std::size_t largest = 0;
  for (std::size_t part = 0; part < kPartCount; ++part) {
    result[part] = static_cast<std::uint8_t>(counts[part] * 255 / all);
    sum += result[part];
    if (counts[part] > counts[largest]) largest = part;
  }
  result[largest] = static_cast<std::uint8_t>(result[largest] + (255 - sum));
  return result;
}

LeafVote make_vote(const JointOffsets& found, float weight) {
  LeafVote vote;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float metres = static_cast<float>(found.mode[axis]) / kUnits_per_m;
    const float units = std::floor(metres / LeafVote::kUnit_m + 0.5F);
    vote.offset[axis] = static_cast<std::int8_t>(std::clamp(units, -127.0F, 127.0F));
  }
  vote.joint = static_cast<std::uint8_t>(found.joint);
  vote.weight_code = vote_weight_code(weight);
  return vote;
}

/// The joints that a leaf may know of, with the offsets from this rank's samples.
void add_offsets(std::span<const TrainingPerson> persons, const GrowingNode& node, std::uint64_t tree_seed,
                 const Ranks& ranks, std::vector<JointOffsets>& out) {
  const std::int64_t all = total(node.parts);
  std::vector<TrainingSample> scratch;
  const auto samples = draw_of_node(node.samples, all, kMaxOffsets, derive_seed(tree_seed, node.path), ranks, scratch);
  std::vector<Eigen::Vector3f> points;
  for (const TrainingSample& sample : samples) points.push_back(persons[sample.person].point(sample.u, sample.v));
  for (std::size_t joint = 0; joint < kJointCount; ++joint) {
    const std::uint32_t nearby_parts = parts_around(static_cast<JointId>(joint));
    std::int64_t nearby = 0;
    for (std::size_t part = 0; part < kPartCount; ++part) {
      if ((nearby_parts >> part & 1U) != 0) nearby += node.parts[part];
    }
    const float probability = static_cast<float>(nearby) / static_cast<float>(all);
    if (probability < kMinNearby) continue;
    JointOffsets& offsets = out.emplace_back();
    offsets.joint = joint;
    offsets.probability = probability;
    for (std::size_t i = 0; i < samples.size(); ++i) {
      offsets.offsets.push_back(in_units(persons[samples[i].person].joints[joint] - points[i]));
    }
  }
}

/// The votes with the largest weights, strongest first; of equals the first joint.
std::array<LeafVote, kVotesPerLeaf> strongest_votes(std::span<const JointOffsets> joints) {
  struct Candidate {
    float weight;
    LeafVote vote;
  };
  std::vector<Candidate> candidates;
  for (const JointOffsets& found : joints) {
    const float certainty = kSpread_m * kSpread_m / (found.variance_m2 + kSpread_m * kSpread_m);
    const float weight = found.probability * certainty * certainty;
    candidates.push_back({weight, make_vote(found, weight)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.weight > b.weight; });
  std::array<LeafVote, kVotesPerLeaf> votes{};
  for (std::size_t i = 0; i < std::min(candidates.size(), votes.size()); ++i) votes[i] = candidates[i].vote;
  return votes;
}

}  // namespace

std::vector<Leaf> make_leaves(std::span<const TrainingPerson> persons, std::span<const GrowingNode> nodes,
                              std::uint64_t tree_seed, Ranks& ranks) {
  std::vector<Leaf> leaves(nodes.size());
  std::vector<JointOffsets> joints;
  for (std::size_t begin = 0; begin < nodes.size(); begin += kLeavesAtOnce) {
    const std::size_t end = std::min(nodes.size(), begin + kLeavesAtOnce);
    joints.clear();
    std::vector<std::size_t> first_of;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      first_of.push_back(joints.size());
      add_offsets(persons, nodes[leaf], tree_seed, ranks, joints);
    }
    first_of.push_back(joints.size());
    shift_modes(joints, kEverywhere, ranks);
    for (int step = 0; step < kModeSteps; ++step) shift_modes(joints, kModeRadius, ranks);
    find_variances(joints, ranks);
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      const std::size_t first = first_of[leaf - begin];
      leaves[leaf].probability = probabilities(nodes[leaf].parts);
      leaves[leaf].votes = strongest_votes(std::span(joints).subspan(first, first_of[leaf - begin + 1] - first));
    }
  }
  return leaves;
}

}  // namespace armature
