#include "tracker/joints/joint_estimator.h"

#include <algorithm>
#include <array>
#include <vector>

#include "tracker/joints/body_fit.h"
#include "tracker/joints/joint_correction.h"
#include "tracker/joints/vote_cloud.h"

namespace armature {
namespace {

constexpr std::size_t kMaxVotes = 1024;  // a joint
/// The area whose certain vote gives a confidence of one half.
constexpr float kHalfArea_m2 = 0.0005F;
constexpr int kSteps = 12;
/// How much more votes a mode needs than the one that the joint was in.
constexpr float kStay = 1.25F;
constexpr float kTorsoRadius_m = 0.5F;

/// The joint with which an unseen one is carried along.
constexpr std::array<JointId, kJointCount> kCarrier = [] {
  using enum JointId;
  return std::array<JointId, kJointCount>{
      Head,         Neck,         Chest,     Torso,       Torso,         Torso,         Chest,      LeftCollar,
      LeftShoulder, LeftShoulder, LeftElbow, LeftElbow,   LeftWrist,     Waist,         LeftHip,    LeftHip,
      LeftKnee,     LeftAnkle,    Chest,     RightCollar, RightShoulder, RightShoulder, RightElbow, RightElbow,
      RightWrist,   Waist,        RightHip,  RightHip,    RightKnee,     RightAnkle};
}();

/// Carriers before what they carry.
constexpr std::array<JointId, kJointCount> kOrder = [] {
  using enum JointId;
  return std::array<JointId, kJointCount>{
      Torso,        Chest,     Waist,       Neck,          Head,          HeadTop,    LeftCollar,   LeftShoulder,
      LeftUpperArm, LeftElbow, LeftForearm, LeftWrist,     LeftHand,      LeftHip,    LeftThigh,    LeftKnee,
      LeftAnkle,    LeftFoot,  RightCollar, RightShoulder, RightUpperArm, RightElbow, RightForearm, RightWrist,
      RightHand,    RightHip,  RightThigh,  RightKnee,     RightAnkle,    RightFoot};
}();

float tree_count(const PartVotes& votes) noexcept {
  const auto& leaves = votes.pixels.front().leaves;
  return static_cast<float>(std::find(leaves.begin(), leaves.end(), nullptr) - leaves.begin());
}

constexpr std::array<PartLabel, 6> kTorsoParts = {PartLabel::LeftClavicle, PartLabel::RightClavicle,
                                                  PartLabel::LeftWaist,    PartLabel::RightWaist,
                                                  PartLabel::LeftHip,      PartLabel::RightHip};

/// The centre of mass of the torso's visible surface near `torso`.
Eigen::Vector3f torso_centre(const PartVotes& votes, const Eigen::Vector3f& torso) noexcept {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float mass = 0;
  for (const ClassifiedPixel& pixel : votes.pixels) {
    const float inside = 1 - (pixel.point - torso).squaredNorm() / (kTorsoRadius_m * kTorsoRadius_m);
    if (inside <= 0) continue;
    int share = 0;
    for (const Leaf* leaf : pixel.leaves) {
      if (leaf == nullptr) break;
      for (const PartLabel part : kTorsoParts) share += leaf->probability[index(part)];
    }
    const float w = pixel.area_m2 * static_cast<float>(share) * inside;
    sum += w * (pixel.point - torso);
    mass += w;
  }
  return mass > 0 ? Eigen::Vector3f(torso + sum / mass) : torso;
}

}  // namespace

struct JointEstimator::State {
  State(std::shared_ptr<const Forest> forest, const JointOptions& all)
      : options(all), correction(std::move(forest)), clouds(kJointCount, VoteCloud(kMaxVotes)) {}

  JointOptions options;
  JointCorrection correction;
  std::vector<VoteCloud> clouds;
  std::array<int, kJointCount> unseen{};  // frames since last observed
  Skeleton last;                          // before its correction
  bool has_last = false;
  RestingBody resting;
  BodyFit fit;
  bool keeps_build = false;

  void collect(const PartVotes& votes) noexcept;
  [[nodiscard]] VoteMode find_mode(std::size_t joint) const noexcept;
};

void JointEstimator::State::collect(const PartVotes& votes) noexcept {
  const auto for_each_leaf = [&](const auto& use) {
    for (const ClassifiedPixel& pixel : votes.pixels) {
      for (const Leaf* leaf : pixel.leaves) {
        if (leaf == nullptr) break;
        use(pixel, *leaf);
      }
    }
  };
  std::array<std::uint32_t, LeafVote::kNone + 1> count{};
  for_each_leaf([&](const ClassifiedPixel&, const Leaf& leaf) {
    for (const LeafVote& vote : leaf.votes) ++count[vote.joint];
  });
  // Where there are too many votes, every n-th stands for n.
  struct Thinning {
    std::uint32_t every = 0;
    std::uint32_t wait = 0;  // votes that pass until the next one counts
  };
  std::array<Thinning, kJointCount> thinning;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    thinning[j].every = (count[j] + kMaxVotes - 1) / static_cast<std::uint32_t>(kMaxVotes);
    clouds[j].clear();
  }
  for_each_leaf([&](const ClassifiedPixel& pixel, const Leaf& leaf) {
    for (const LeafVote& vote : leaf.votes) {
      if (vote.joint == LeafVote::kNone) break;
      Thinning& thin = thinning[vote.joint];
      if (thin.wait != 0) {
        --thin.wait;
        continue;
      }
      thin.wait = thin.every - 1;
      const Eigen::Vector3f offset(vote.offset[0], vote.offset[1], vote.offset[2]);
      clouds[vote.joint].add(pixel.point + LeafVote::kUnit_m * offset,
                             pixel.area_m2 * vote_weight(vote.weight_code) * static_cast<float>(thin.every));
    }
  });
  for (VoteCloud& cloud : clouds) cloud.finish();
}

VoteMode JointEstimator::State::find_mode(std::size_t joint) const noexcept {
  const VoteCloud& cloud = clouds[joint];
  const float radius = options.bandwidth_m;
  // A wide kernel first finds where most votes are.
  const VoteMode wide = cloud.mode_near(cloud.mean(), 3 * radius, kSteps);
  VoteMode best = cloud.mode_near(wide.position, radius, kSteps);
  if (has_last && last.joints[joint].state == JointState::Observed) {
    const VoteMode again = cloud.mode_near(last.joints[joint].position, radius, kSteps);
    if (kStay * again.mass > best.mass) best = again;
  }
  return best;
}

JointEstimator::JointEstimator(std::shared_ptr<const Forest> forest, const JointOptions& options)
    : state_(std::make_unique<State>(std::move(forest), options)) {}
JointEstimator::~JointEstimator() = default;
JointEstimator::JointEstimator(JointEstimator&&) noexcept = default;
JointEstimator& JointEstimator::operator=(JointEstimator&&) noexcept = default;

void JointEstimator::reset() noexcept {
  state_->last = {};
  state_->has_last = false;
  state_->unseen = {};
  state_->resting = {};
  state_->fit.reset();
  state_->keeps_build = false;
}

void JointEstimator::keep_build(bool keep) noexcept {
  state_->keeps_build = keep;
}

const Skeleton& JointEstimator::voted() const noexcept {
  return state_->last;
}

void JointEstimator::estimate(const PartVotes& votes, Skeleton& out) noexcept {
  State& s = *state_;
  if (votes.pixels.empty()) {
    out = s.last;
    for (Joint& joint : out.joints) {
      joint.state = JointState::Lost;
      joint.confidence = 0;
    }
    s.last = out;
    return;
  }
  s.collect(votes);
  const float half = kHalfArea_m2 * tree_count(votes);
  for (const JointId id : kOrder) {
    const std::size_t j = index(id);
    const VoteMode mode = s.find_mode(j);
    Joint& joint = out.joints[j];
    joint.confidence = mode.mass / (mode.mass + half);
    if (joint.confidence >= s.options.observed_confidence) {
      joint.state = JointState::Observed;
      joint.position = mode.position;
      s.unseen[j] = 0;
      continue;
    }
    ++s.unseen[j];
    const bool carried = s.has_last && s.unseen[j] <= s.options.hold_frames &&
                         s.last.joints[j].state != JointState::Lost && kCarrier[j] != id;
    const auto carrier = index(kCarrier[j]);
    if (carried) {
      const Eigen::Vector3f predicted =
          s.last.joints[j].position + out.joints[carrier].position - s.last.joints[carrier].position;
      // What little is seen pulls as hard as it deserves.
      const float pull = joint.confidence / s.options.observed_confidence;
      joint.position = mode.mass > 0 ? Eigen::Vector3f(predicted + pull * (mode.position - predicted)) : predicted;
      joint.state = JointState::Inferred;
    } else if (mode.mass > 0) {
      joint.position = mode.position;
      joint.state = JointState::Inferred;
    } else {
      joint.position = s.has_last ? s.last.joints[j].position : out.joints[carrier].position;
      joint.state = JointState::Lost;
    }
  }
  out.user_position = torso_centre(votes, out[JointId::Torso].position);
  s.last = out;
  s.has_last = true;
  if (!s.keeps_build || !s.resting.settled()) s.resting.add(out);
  s.correction.apply(out, s.resting);
  if (!s.keeps_build || !s.fit.settled()) s.fit.learn(votes, out);
  s.fit.apply(votes, out);
}

}  // namespace armature
