#include "tools/evaluation/real_evaluation.h"

#include <algorithm>
#include <chrono>
#include <numbers>

#include "tools/evaluation/sdk_imitation.h"
#include "tools/evaluation/statistics.h"
#include "tools/evaluation/surface_turn.h"
#include "tools/evaluation/utd_sequence.h"
#include "tracker/joints/skeleton_filter.h"
#include "tracker/motions/receptors.h"

namespace armature::tools {
namespace {

constexpr std::size_t kJoints = kNavigationJoints.size();
constexpr std::array kActions = {1, 2, 3, 4, 22, 23, 26, 27};
constexpr float kNear_m = 0.15F;
constexpr double kMinSpan_rad = 10 * std::numbers::pi / 180;
constexpr std::size_t kRestFrames = 3;
constexpr std::chrono::nanoseconds kFrameTime = std::chrono::nanoseconds(std::chrono::seconds(1)) / 30;

/// What the SDK calls the navigation joints.
constexpr std::array<SdkJoint, kJoints> kSdkNames = {
    SdkJoint::Head,    SdkJoint::ShoulderCenter, SdkJoint::HipCenter, SdkJoint::LeftShoulder, SdkJoint::RightShoulder,
    SdkJoint::LeftHip, SdkJoint::RightHip,       SdkJoint::LeftKnee,  SdkJoint::RightKnee};

Skeleton from_sdk(const SdkJoints& joints) {
  Skeleton skeleton;
  for (std::size_t j = 0; j < kJoints; ++j) {
    skeleton[kNavigationJoints[j]] = {joints[static_cast<std::size_t>(kSdkNames[j])], 1, JointState::Observed};
  }
  skeleton.user_position = joints[static_cast<std::size_t>(SdkJoint::Spine)];
  return skeleton;
}

/// Each frame's joints as they were 1.5 frames before.
std::vector<Skeleton> delayed(const std::vector<Skeleton>& frames) {
  std::vector<Skeleton> late = frames;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    const Skeleton& one = frames[t >= 1 ? t - 1 : 0];
    const Skeleton& two = frames[t >= 2 ? t - 2 : 0];
    for (std::size_t j = 0; j < kJointCount; ++j) {
      late[t].joints[j].position = 0.5F * (one.joints[j].position + two.joints[j].position);
    }
    late[t].user_position = 0.5F * (one.user_position + two.user_position);
  }
  return late;
}

/// As it would be published.
std::vector<Skeleton> filtered(const std::vector<Skeleton>& frames) {
  std::vector<Skeleton> calm = frames;
  SkeletonFilter filter;
  std::chrono::nanoseconds time{0};
  for (Skeleton& frame : calm) filter.filter(frame, time += kFrameTime);
  return calm;
}

/// The mean of the first frames.
RestPose rest_of(const std::vector<Skeleton>& frames) {
  RestPose rest;
  rest.skeleton = frames.front();
  const std::size_t count = std::min(kRestFrames, frames.size());
  for (std::size_t t = 1; t < count; ++t) {
    for (std::size_t j = 0; j < kJointCount; ++j) rest.skeleton.joints[j].position += frames[t].joints[j].position;
    rest.skeleton.user_position += frames[t].user_position;
  }
  for (Joint& joint : rest.skeleton.joints) joint.position /= static_cast<float>(count);
  rest.skeleton.user_position /= static_cast<float>(count);
  rest.frame = user_frame(rest.skeleton, -Eigen::Vector3f::UnitY());
  return rest;
}

using Angles = std::vector<double>;  // of one motion, a number a frame

PerMotion<Angles> angles_of(const std::vector<Skeleton>& frames) {
  const RestPose rest = rest_of(frames);
  PerMotion<Angles> out;
  for (const Skeleton& frame : frames) {
    const MotionAngles angles = motion_angles(frame, rest);
    for (std::size_t m = 0; m < kMotionCount; ++m) out[m].push_back(angles.angle_rad[m]);
  }
  return out;
}

double span_of(const Angles& angles) {
  const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
  return *high - *low;
}

/// The motion angles of two skeletons over a sequence, compared.
struct AngleComparison {
  PerMotion<double> our_span_rad{}, sdk_span_rad{}, correlation{};
};

AngleComparison compare_angles(const std::vector<Skeleton>& ours, const std::vector<Skeleton>& sdk) {
  const PerMotion<Angles> our_angles = angles_of(ours), sdk_angles = angles_of(sdk);
  AngleComparison out;
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    out.our_span_rad[m] = span_of(our_angles[m]);
    out.sdk_span_rad[m] = span_of(sdk_angles[m]);
    out.correlation[m] = correlation(our_angles[m], sdk_angles[m]);
  }
  return out;
}

AngleCorrelation summary(std::vector<double> correlations) {
  return {.mean = mean(correlations),
          .median = percentile(correlations, 50),
          .sequences = static_cast<int>(correlations.size())};
}

/// Gathers agreement over sequences.
class Agreement {
 public:
  /// Returns the median deviation in this sequence.
  double add(const std::vector<Skeleton>& ours, const std::vector<Skeleton>& sdk) {
    const AngleComparison angles = compare_angles(ours, sdk);
    std::vector<double> here;
    for (std::size_t j = 0; j < kJoints; ++j) {
      Eigen::Vector3f offset = Eigen::Vector3f::Zero();
      for (std::size_t t = 0; t < ours.size(); ++t) offset += difference(ours[t], sdk[t], j);
      offset /= static_cast<float>(ours.size());
      for (std::size_t t = 0; t < ours.size(); ++t) {
        const Eigen::Vector3f d = difference(ours[t], sdk[t], j);
        here.push_back(static_cast<double>((d - offset).norm()));
        deviations_m_[j].push_back(here.back());
        differences_[j].push_back(d);
      }
    }
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      if (angles.sdk_span_rad[m] > kMinSpan_rad) correlations_[m].push_back(angles.correlation[m]);
    }
    return percentile(here, 50);
  }

  [[nodiscard]] RealAgreement result() {
    RealAgreement out;
    std::vector<double> all, knees;
    std::size_t near = 0, total = 0;
    for (std::size_t j = 0; j < kJoints; ++j) {
      auto& deviations = deviations_m_[j];
      all.insert(all.end(), deviations.begin(), deviations.end());
      if (kNavigationJoints[j] == JointId::LeftKnee || kNavigationJoints[j] == JointId::RightKnee) {
        knees.insert(knees.end(), deviations.begin(), deviations.end());
      }
      out.joints[j] = {percentile(deviations, 50), percentile(deviations, 90)};
      Eigen::Vector3f offset = Eigen::Vector3f::Zero();
      for (const Eigen::Vector3f& d : differences_[j]) offset += d;
      if (!differences_[j].empty()) offset /= static_cast<float>(differences_[j].size());
      for (const Eigen::Vector3f& d : differences_[j]) near += (d - offset).norm() < kNear_m ? 1 : 0;
      total += differences_[j].size();
    }
    out.all = {percentile(all, 50), percentile(all, 90)};
    out.knees = {percentile(knees, 50), percentile(knees, 90)};
    out.within_15_cm = total == 0 ? 0 : static_cast<double>(near) / static_cast<double>(total);
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      out.correlation[m] = summary(correlations_[m]);
    }
    return out;
  }

 private:
  static Eigen::Vector3f difference(const Skeleton& ours, const Skeleton& sdk, std::size_t j) {
    return ours[kNavigationJoints[j]].position - sdk[kNavigationJoints[j]].position;
  }

  std::array<std::vector<double>, kJoints> deviations_m_;
  std::array<std::vector<Eigen::Vector3f>, kJoints> differences_;
  PerMotion<std::vector<double>> correlations_;
};

/// A recording, tracked.
struct Tracked {
  SeenTwice seen;
  std::vector<std::optional<double>> shoulders_turn, hips_turn;  // of the surface, a frame
};

/// Looks where both see the trunk in the middle, so that neither is favoured.
void add_surface_turns(const DepthView& frame, std::span<const std::uint8_t> mask, Tracked& to) {
  Skeleton middle = to.seen.ours.back();
  for (const JointId id : kNavigationJoints) {
    middle[id].position = 0.5F * (middle[id].position + to.seen.sdk.back()[id].position);
  }
  to.shoulders_turn.push_back(surface_turn(frame, mask, shoulder_strip(middle)));
  to.hips_turn.push_back(surface_turn(frame, mask, hip_strip(middle)));
}

Angles smoothed(const Angles& angles) {
  Angles out;
  const auto n = std::ssize(angles);
  for (std::ptrdiff_t t = 0; t < n; ++t) {
    double sum = 0;
    for (std::ptrdiff_t i = t - 2; i <= t + 2; ++i) {
      sum += angles[static_cast<std::size_t>(std::clamp<std::ptrdiff_t>(i, 0, n - 1))];
    }
    out.push_back(sum / 5);
  }
  return out;
}

/// Gathers how turns about the vertical agree with the surface's.
class SurfaceComparison {
 public:
  void add(const std::vector<std::optional<double>>& surface, const Angles& ours, const Angles& sdk) {
    if (span_of(sdk) <= kMinSpan_rad) return;
    Angles seen, our_seen, sdk_seen;
    for (std::size_t t = 0; t < surface.size(); ++t) {
      if (!surface[t]) continue;
      seen.push_back(*surface[t]);
      our_seen.push_back(ours[t]);
      sdk_seen.push_back(sdk[t]);
    }
    if (seen.empty()) return;
    seen = smoothed(seen);
    ours_.add(smoothed(our_seen), seen);
    sdk_.add(smoothed(sdk_seen), seen);
  }

  [[nodiscard]] SurfaceAgreement result() {
    return {.ours = summary(ours_.correlations),
            .sdk = summary(sdk_.correlations),
            .share_of_ours = percentile(ours_.shares, 50),
            .share_of_sdk = percentile(sdk_.shares, 50)};
  }

 private:
  struct Side {
    std::vector<double> correlations, shares;

    void add(const Angles& turn, const Angles& surface) {
      correlations.push_back(correlation(surface, turn));
      shares.push_back(slope(turn, surface));
    }
  };
  Side ours_, sdk_;
};

/// What each of the evaluated recordings says of agreement.
void find_agreement(std::span<const Tracked> recordings, RealEvaluation& result) {
  Agreement as_is, late, calm, calm_late, imitating, imitating_calm_late;
  SurfaceComparison shoulders, hips;
  std::vector<SeenTwice> seen, seen_later;
  for (const Tracked& recording : recordings) seen.push_back(recording.seen);
  for (const SeenTwice& one : seen) seen_later.push_back({one.person, one.ours, delayed(one.sdk)});
  const auto imitations = imitate_sdk(seen), imitations_later = imitate_sdk(seen_later);
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const std::vector<Skeleton>&ours = seen[i].ours, &sdk = seen[i].sdk, &sdk_later = seen_later[i].sdk;
    const AngleComparison angles = compare_angles(ours, sdk);
    SequenceAgreement& sequence = result.sequences[i];
    sequence.sdk_span_rad = angles.sdk_span_rad;
    sequence.our_span_rad = angles.our_span_rad;
    sequence.correlation = angles.correlation;
    sequence.correlation_delayed = compare_angles(ours, sdk_later).correlation;
    sequence.median_m = as_is.add(ours, sdk);
    late.add(ours, sdk_later);
    const std::vector<Skeleton> published = filtered(ours);
    calm.add(published, sdk);
    calm_late.add(published, sdk_later);
    imitating.add(imitations[i], sdk);
    imitating_calm_late.add(filtered(imitations_later[i]), sdk_later);
    const PerMotion<Angles> our_angles = angles_of(ours), sdk_angles = angles_of(sdk);
    constexpr std::size_t kShoulders = index(MotionId::RotateShoulders), kHips = index(MotionId::RotateHips);
    shoulders.add(recordings[i].shoulders_turn, our_angles[kShoulders], sdk_angles[kShoulders]);
    hips.add(recordings[i].hips_turn, our_angles[kHips], sdk_angles[kHips]);
  }
  result.as_is = as_is.result();
  result.delayed = late.result();
  result.filtered = calm.result();
  result.filtered_delayed = calm_late.result();
  result.imitating = imitating.result();
  result.imitating_filtered_delayed = imitating_calm_late.result();
  result.shoulders_surface = shoulders.result();
  result.hips_surface = hips.result();
}

}  // namespace

Expected<RealEvaluation> evaluate_real(const MaskedTracker& tracker, const std::filesystem::path& folder,
                                       bool all_actions, const std::function<void(double)>& progress) {
  const auto names = list_utd_sequences(folder);
  if (!names) return tl::unexpected(names.error());
  RealEvaluation result;
  std::vector<Tracked> recordings;
  std::vector<double> frame_us;
  std::size_t tracked = 0, observed = 0;
  for (std::size_t i = 0; i < names->size(); ++i) {
    const auto sequence = read_utd_sequence(folder, (*names)[i]);
    if (!sequence) return tl::unexpected(sequence.error());
    progress(static_cast<double>(i + 1) / static_cast<double>(names->size()));
    if (!all_actions && std::find(kActions.begin(), kActions.end(), sequence->action) == kActions.end()) continue;
    if (sequence->frame_count() == 0) continue;

    Tracked& recording = recordings.emplace_back();
    recording.seen.person = sequence->person;
    std::vector<Skeleton>& ours = recording.seen.ours;
    std::vector<std::uint8_t> mask;
    tracker.reset(sequence->intrinsics);
    for (std::size_t t = 0; t < sequence->frame_count(); ++t) {
      const auto depth = sequence->frame(t);
      const DepthView frame{
          .depth_mm = depth, .intrinsics = sequence->intrinsics, .sequence = t, .sensor = {}, .host = {}};
      mask.assign(depth.size(), 0);
      std::transform(depth.begin(), depth.end(), mask.begin(), [](std::uint16_t d) { return d != 0 ? 1 : 0; });
      const auto start = std::chrono::steady_clock::now();
      ours.push_back(tracker.track(frame, mask));
      frame_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
      ours.back().user_position = ours.back()[JointId::Torso].position;
      recording.seen.sdk.push_back(from_sdk(sequence->joints[t]));
      add_surface_turns(frame, mask, recording);
      bool whole = true;
      for (const JointId id : kNavigationJoints) {
        whole = whole && ours.back()[id].state != JointState::Lost;
        observed += ours.back()[id].state == JointState::Observed ? 1 : 0;
      }
      tracked += whole ? 1 : 0;
    }
    result.sequences.push_back({.name = sequence->name, .frames = static_cast<int>(ours.size())});
    result.frames += static_cast<int>(ours.size());
  }
  if (result.frames == 0) return fail(folder.string() + ": no recordings of the actions to evaluate");
  result.frames_tracked = static_cast<double>(tracked) / result.frames;
  result.joints_observed = static_cast<double>(observed) / (result.frames * static_cast<double>(kJoints));
  find_agreement(recordings, result);
  result.p50_us = percentile(frame_us, 50);
  result.p99_us = percentile(frame_us, 99);
  return result;
}

}  // namespace armature::tools
