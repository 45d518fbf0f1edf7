#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string_view>

#include "tracker/motions/motion_options.h"
#include "tracker/motions/receptors.h"

namespace armature {

/// Where the rest pose comes from (section 3.5.1: no T-pose is asked for).
enum class RestMode {
  Stillness,  ///< live: the mean over the first second in which the user stands still, improved as Auto does
  Auto,       ///< offline: provisional from the first frames, improved whenever the user stands still near it
  First,      ///< offline: the mean over the first `first_frames` tracked frames
  Fixed,      ///< given
};
/// As configuration spells those that can be configured.
inline constexpr std::array<std::string_view, 3> kRestModeNames = {"stillness", "auto", "first"};

struct RestOptions {
  RestMode mode = RestMode::Stillness;
  std::chrono::milliseconds stillness{1000};  ///< Stillness: how long the user has to stand still
  int first_frames = 10;                      ///< Auto: frames of the provisional rest. First: all of it
  float still_spread_m = 0.015F;  ///< a joint counts as still below this standard deviation at 2 m; grows with distance
  float still_drift_m = 0.010F;   ///< and below this difference between the means of both halves of the window
  std::optional<RestPose> fixed{};  ///< Fixed: the pose
};

/// Watches a tracked skeleton until it knows the rest pose and, per motion, how noisy the filtered angle is there.
/// Fixed memory. Realtime-safe: yes. Thread-safe: no.
class RestEstimator {
 public:
  RestEstimator(const RestOptions& rest, const MotionOptions& motions);

  void set_options(const RestOptions& rest, const MotionOptions& motions) noexcept;

  /// Forgets the rest pose: another user, or the same one asked for a new one.
  void reset() noexcept;

  /// One tracked frame. `up` is the floor's normal. A `time` that runs backwards is that of a sensor that was opened
  /// anew: stillness is looked for from there on.
  void observe(const Skeleton& skeleton, const Eigen::Vector3f& up, std::chrono::nanoseconds time) noexcept;

  [[nodiscard]] const std::optional<RestPose>& rest() const noexcept { return rest_; }

  /// Standard deviation per motion of the filtered angle at rest, radians: what was seen, and at least what the sensor
  /// is known to do at the user's distance.
  [[nodiscard]] const PerMotion<float>& sigma_rad() const noexcept { return sigma_rad_; }

  /// How much of the rest pose has been captured, in [0, 1].
  [[nodiscard]] float progress() const noexcept { return progress_; }

 private:
  struct Sample {
    Skeleton skeleton;
    std::chrono::nanoseconds time{0};
  };
  static constexpr std::size_t kWindow = 128;  // a second at up to 120 Hz

  [[nodiscard]] const Sample& recent(std::size_t age) const noexcept;
  [[nodiscard]] std::size_t samples_within(std::chrono::nanoseconds span) const noexcept;
  [[nodiscard]] bool stands_still(std::size_t count) const noexcept;
  void adopt(std::size_t count, const Eigen::Vector3f& up) noexcept;
  void improve(const Eigen::Vector3f& up) noexcept;
  void measure_noise(std::size_t count) noexcept;

  RestOptions options_;
  MotionOptions motions_;
  std::array<Sample, kWindow> window_;
  std::size_t seen_ = 0;  // samples ever put into the window
  int averaged_ = 0;      // frames that went into rest_
  std::optional<RestPose> rest_;
  PerMotion<float> sigma_rad_{};
  float progress_ = 0;
};

}  // namespace armature
