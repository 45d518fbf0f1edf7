#include "tools/evaluation/real_evaluation.h"

#include <algorithm>
#include <chrono>
#include <numbers>

#include "tools/evaluation/statistics.h"
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

/// The motion angles of two skeletons over a sequence, compared.
struct AngleComparison {
  PerMotion<double> our_span_rad{}, sdk_span_rad{}, correlation{};
};

AngleComparison compare_angles(const std::vector<Skeleton>& ours, const std::vector<Skeleton>& sdk) {
  const auto span_of = [](const std::vector<double>& angles) {
    const auto [low, high] = std::minmax_element(angles.begin(), angles.end());
    return *high - *low;
  };
  const RestPose our_rest = rest_of(ours), sdk_rest = rest_of(sdk);
  PerMotion<std::vector<double>> our_angles, sdk_angles;
  for (std::size_t t = 0; t < ours.size(); ++t) {
    const MotionAngles a = motion_angles(ours[t], our_rest), b = motion_angles(sdk[t], sdk_rest);
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      our_angles[m].push_back(a.angle_rad[m]);
      sdk_angles[m].push_back(b.angle_rad[m]);
    }
  }
  AngleComparison out;
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    out.our_span_rad[m] = span_of(our_angles[m]);
    out.sdk_span_rad[m] = span_of(sdk_angles[m]);
    out.correlation[m] = correlation(our_angles[m], sdk_angles[m]);
  }
  return out;
}

/// Gathers agreement over sequences.
class Agreement {
 public:
  /// Returns the median deviation in this sequence.
  double add(const std::vector<Skeleton>& ours, const std::vector<Skeleton>& sdk, const AngleComparison& angles) {
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
      out.correlation[m] = {.mean = mean(correlations_[m]),
                            .median = percentile(correlations_[m], 50),
                            .sequences = static_cast<int>(correlations_[m].size())};
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

}  // namespace

Expected<RealEvaluation> evaluate_real(const MaskedTracker& tracker, const std::filesystem::path& folder,
                                       bool all_actions, const std::function<void(double)>& progress) {
  const auto names = list_utd_sequences(folder);
  if (!names) return tl::unexpected(names.error());
  RealEvaluation result;
  Agreement as_is, late, calm, calm_late;
  std::vector<double> frame_us;
  std::size_t tracked = 0, observed = 0;
  for (std::size_t i = 0; i < names->size(); ++i) {
    const auto sequence = read_utd_sequence(folder, (*names)[i]);
    if (!sequence) return tl::unexpected(sequence.error());
    progress(static_cast<double>(i + 1) / static_cast<double>(names->size()));
    if (!all_actions && std::find(kActions.begin(), kActions.end(), sequence->action) == kActions.end()) continue;
    if (sequence->frame_count() == 0) continue;

    std::vector<Skeleton> ours, sdk;
    std::vector<std::uint8_t> mask;
    tracker.reset(sequence->intrinsics);
    for (std::size_t t = 0; t < sequence->frame_count(); ++t) {
      const auto depth = sequence->frame(t);
      mask.assign(depth.size(), 0);
      std::transform(depth.begin(), depth.end(), mask.begin(), [](std::uint16_t d) { return d != 0 ? 1 : 0; });
      const auto start = std::chrono::steady_clock::now();
      ours.push_back(tracker.track(
          {.depth_mm = depth, .intrinsics = sequence->intrinsics, .sequence = t, .sensor = {}, .host = {}}, mask));
      frame_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
      ours.back().user_position = ours.back()[JointId::Torso].position;
      sdk.push_back(from_sdk(sequence->joints[t]));
      bool whole = true;
      for (const JointId id : kNavigationJoints) {
        whole = whole && ours.back()[id].state != JointState::Lost;
        observed += ours.back()[id].state == JointState::Observed ? 1 : 0;
      }
      tracked += whole ? 1 : 0;
    }
    const std::vector<Skeleton> sdk_later = delayed(sdk);
    const AngleComparison angles = compare_angles(ours, sdk), angles_later = compare_angles(ours, sdk_later);
    const double median_m = as_is.add(ours, sdk, angles);
    late.add(ours, sdk_later, angles_later);
    const std::vector<Skeleton> published = filtered(ours);
    calm.add(published, sdk, compare_angles(published, sdk));
    calm_late.add(published, sdk_later, compare_angles(published, sdk_later));
    result.sequences.push_back({.name = sequence->name,
                                .frames = static_cast<int>(ours.size()),
                                .median_m = median_m,
                                .sdk_span_rad = angles.sdk_span_rad,
                                .our_span_rad = angles.our_span_rad,
                                .correlation = angles.correlation,
                                .correlation_delayed = angles_later.correlation});
    result.frames += static_cast<int>(ours.size());
  }
  if (result.frames == 0) return fail(folder.string() + ": no recordings of the actions to evaluate");
  result.frames_tracked = static_cast<double>(tracked) / result.frames;
  result.joints_observed = static_cast<double>(observed) / (result.frames * static_cast<double>(kJoints));
  result.as_is = as_is.result();
  result.delayed = late.result();
  result.filtered = calm.result();
  result.filtered_delayed = calm_late.result();
  result.p50_us = percentile(frame_us, 50);
  result.p99_us = percentile(frame_us, 99);
  return result;
}

}  // namespace armature::tools
