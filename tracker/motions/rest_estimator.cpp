#include "tracker/motions/rest_estimator.h"

#include <algorithm>
#include <cmath>

#include "tracker/motions/one_euro.h"

namespace armature {
namespace {

using Eigen::Vector3f;

/// The joints that motions are read from: only these have to stand still, arms may do as they like.
constexpr std::array kSteering = {JointId::Head,         JointId::Neck,          JointId::Waist,
                                  JointId::LeftShoulder, JointId::RightShoulder, JointId::LeftHip,
                                  JointId::RightHip,     JointId::LeftKnee,      JointId::RightKnee};

/// Noise of a filtered joint that the sensor and the forest leave at a distance of 1 m; it grows with the square of
/// the distance as disparity does. Synthetic people who stand at 1.7 to 3.5 m leave 0.1 to 0.2 mm at 1 m, as the hips'
/// filtered angle has it; this is twice that, since real ones are not as still.
constexpr float kJointNoiseAt1m = 0.0003F;
/// What a motion's angle is measured over, metres, in the order of MotionId.
constexpr PerMotion<float> kBaseline = {0.36F, 0.22F, 0.42F, 0.50F, 0.70F, 0.35F, 0.25F, 0.25F};

/// How far from the rest pose, in ranges, standing still counts as resting. A young rest pose may have caught somebody
/// who was still settling and moves by more; later only what lies inside every dead zone, left or not yet entered, may
/// move it, so that a small motion that is held is never taken for rest.
constexpr float kNearYoungRest = 0.30F;
constexpr float kNearRest = 0.12F;
constexpr int kYoungFrames = 60;
/// A rest pose is the mean of at most so many frames; then the oldest fade.
constexpr int kAveragedFrames = 90;
/// Improving looks at stillness over this span.
constexpr std::chrono::milliseconds kImproveSpan{400};

Skeleton blended(const Skeleton& a, const Skeleton& b, float weight_b) noexcept {
  Skeleton out = a;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    out.joints[j].position += weight_b * (b.joints[j].position - a.joints[j].position);
    out.joints[j].confidence += weight_b * (b.joints[j].confidence - a.joints[j].confidence);
    out.joints[j].state = std::max(a.joints[j].state, b.joints[j].state);
  }
  out.user_position += weight_b * (b.user_position - a.user_position);
  return out;
}

}  // namespace

RestEstimator::RestEstimator(const RestOptions& rest, const MotionOptions& motions)
    : options_(rest), motions_(motions) {
  reset();
}

void RestEstimator::set_options(const RestOptions& rest, const MotionOptions& motions) noexcept {
  options_ = rest;
  motions_ = motions;
}

void RestEstimator::reset() noexcept {
  seen_ = 0;
  averaged_ = 0;
  progress_ = 0;
  sigma_rad_ = {};
  rest_.reset();
}

const RestEstimator::Sample& RestEstimator::recent(std::size_t age) const noexcept {
  return window_[(seen_ - 1 - age) % kWindow];
}

std::size_t RestEstimator::samples_within(std::chrono::nanoseconds span) const noexcept {
  const std::size_t available = std::min(seen_, kWindow);
  std::size_t count = 0;
  while (count < available && recent(0).time - recent(count).time <= span) ++count;
  return count;
}

bool RestEstimator::stands_still(std::size_t count) const noexcept {
  if (count < 6) return false;
  for (const JointId joint : kSteering) {
    Vector3f newer = Vector3f::Zero(), older = Vector3f::Zero();
    float square = 0;
    const std::size_t half = count / 2;
    for (std::size_t age = 0; age < count; ++age) {
      const Joint& sample = recent(age).skeleton[joint];
      if (sample.state == JointState::Lost) return false;
      (age < half ? newer : older) += sample.position;
    }
    const Vector3f mean = (newer + older) / static_cast<float>(count);
    newer /= static_cast<float>(half);
    older /= static_cast<float>(count - half);
    for (std::size_t age = 0; age < count; ++age) square += (recent(age).skeleton[joint].position - mean).squaredNorm();
    const float noisier = std::max(1.0F, mean.z() * mean.z() / 4);
    if (std::sqrt(square / static_cast<float>(count)) > options_.still_spread_m * noisier) return false;
    if ((newer - older).norm() > options_.still_drift_m * noisier) return false;
  }
  return true;
}

void RestEstimator::adopt(std::size_t count, const Vector3f& up) noexcept {
  Skeleton mean = recent(0).skeleton;
  for (std::size_t age = 1; age < count; ++age) {
    mean = blended(mean, recent(age).skeleton, 1.0F / static_cast<float>(age + 1));
  }
  rest_ = RestPose{mean, user_frame(mean, up)};
  averaged_ = static_cast<int>(count);
  measure_noise(std::min(count, samples_within(kImproveSpan)));  // she may have settled before
}

void RestEstimator::improve(const Vector3f& up) noexcept {
  const std::size_t count = samples_within(kImproveSpan);
  if (!stands_still(count)) return;
  const float near = averaged_ < kYoungFrames ? kNearYoungRest : kNearRest;
  for (const std::size_t age : {std::size_t{0}, count - 1}) {
    const MotionAngles angles = motion_angles(recent(age).skeleton, *rest_);
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      if (std::abs(motions_.curve(m).true_angle(angles.angle_rad[m])) > near * motions_.range_rad[m]) return;
    }
  }
  averaged_ = std::min(averaged_ + 1, kAveragedFrames);
  const Skeleton mean = blended(rest_->skeleton, recent(0).skeleton, 1.0F / static_cast<float>(averaged_));
  rest_ = RestPose{mean, user_frame(mean, up)};
  measure_noise(count);
}

void RestEstimator::measure_noise(std::size_t count) noexcept {
  const float distance_m = rest_->skeleton[JointId::Waist].position.norm();
  PerMotion<OneEuro> filters;
  PerMotion<float> sum{}, square{};
  for (std::size_t age = count; age-- > 0;) {
    const MotionAngles angles = motion_angles(recent(age).skeleton, *rest_);
    const float dt_s =
        age + 1 < count ? std::chrono::duration<float>(recent(age).time - recent(age + 1).time).count() : 1.0F;
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      const float angle =
          filters[m].filter(motions_.curve(m).true_angle(angles.angle_rad[m]), std::max(dt_s, 1e-3F), motions_.filter);
      sum[m] += angle;
      square[m] += angle * angle;
    }
  }
  const auto n = static_cast<float>(count);
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    const float mean = sum[m] / n;
    const float seen = std::sqrt(std::max(0.0F, square[m] / n - mean * mean));
    const float known =
        motions_.gain[m] * std::numbers::sqrt2_v<float> * kJointNoiseAt1m * distance_m * distance_m / kBaseline[m];
    sigma_rad_[m] = std::max(seen, known);
  }
}

void RestEstimator::observe(const Skeleton& skeleton, const Vector3f& up, std::chrono::nanoseconds time) noexcept {
  if (options_.mode == RestMode::Fixed) {
    if (!rest_ && options_.fixed) {
      rest_ = options_.fixed;
      progress_ = 1;
      seen_ = 0;
    }
    return;
  }
  if (seen_ > 0 && time == recent(0).time) return;
  if (seen_ > 0 && time < recent(0).time) seen_ = 0;  // a sensor that was opened anew counts from zero
  window_[seen_ % kWindow] = Sample{skeleton, time};
  ++seen_;

  if (options_.mode == RestMode::Stillness) {
    if (rest_) return improve(up);
    const std::size_t count = samples_within(options_.stillness);
    const auto span = recent(0).time - recent(count - 1).time;
    // Half a frame of tolerance: thirty frames at 30 Hz span 29 intervals.
    const auto frame = count > 1 ? span / static_cast<long>(count - 1) : std::chrono::nanoseconds(0);
    // How long she has stood still up to now, in eighths.
    constexpr int kParts = 8;
    progress_ = 0;
    for (int part = kParts; part > 0 && progress_ == 0; --part) {
      const std::size_t last = samples_within(options_.stillness * part / kParts);
      if (!stands_still(last)) continue;
      progress_ = std::min(1.0F, std::chrono::duration<float>(recent(0).time - recent(last - 1).time + frame).count() /
                                     std::chrono::duration<float>(options_.stillness).count());
    }
    if (stands_still(count) && seen_ > count && span + frame >= options_.stillness) adopt(count, up);
    return;
  }

  const auto wanted = static_cast<std::size_t>(std::clamp(options_.first_frames, 1, static_cast<int>(kWindow)));
  if (!rest_) {
    progress_ = std::min(1.0F, static_cast<float>(seen_) / static_cast<float>(wanted));
    if (seen_ >= wanted) adopt(wanted, up);
    return;
  }
  if (options_.mode == RestMode::Auto) improve(up);
}

}  // namespace armature
