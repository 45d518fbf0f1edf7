#pragma once

#include <chrono>

#include "tracker/motions/motion_meter.h"
#include "tracker/motions/range_adapter.h"
#include "tracker/motions/rest_estimator.h"
#include "tracker/transfer/actuator.h"
#include "tracker/transfer/steering_pair.h"
#include "tracker/transfer/transfer_function.h"

namespace armature {

struct NavigationOptions {
  SteeringPair pair;
  bool allow_correlated = false;
  MotionOptions motions;
  /// Ours, as all of this. Real people who only move their arms shift their weight and turn their hips a little: knees
  /// by up to a third of the range, hips by a fifth.
  PerMotion<TransferOptions> transfer = {{{.alpha = 0.20F},
                                          {.alpha = 0.25F},
                                          {.alpha = 0.20F},
                                          {.alpha = 0.25F},
                                          {.alpha = 0.20F},
                                          {.alpha = 0.25F},
                                          {.alpha = 0.35F},
                                          {.alpha = 0.35F}}};
  ActuatorOptions actuator;
  AdaptationOptions adaptation;
};

/// One motion on its way from an angle to a share of the maximum speed.
struct MotionOutput {
  float angle_rad = 0;   ///< signed, against the rest pose, filtered
  float normalized = 0;  ///< in [-1, 1]
  float shaped = 0;      ///< after dead zone and slope, in [-1, 1]
  float confidence = 0;  ///< in [0, 1]
  float dead_zone = 0;   ///< in force here and now, share of the range; above kMaxDeadZone: too noisy to steer with
};

struct Navigation {
  PerMotion<MotionOutput> motions{};
  float walk = 0;  ///< shaped value of the walking motion, in [-1, 1], forward positive
  float turn = 0;  ///< shaped value of the turning motion, in [-1, 1], to the left positive
  CameraVelocity velocity;
  bool too_noisy = false;  ///< one of the two steering motions cannot be steered with here and now
};

/// Skeletons of one user -> two velocities: rest pose, motion receptors, transfer functions and actuator of section
/// 3.4, whoever made the skeletons. Owns its memory. Deterministic: time is that of the frames. Thread-safe: no.
/// Realtime-safe: yes.
class Navigator {
 public:
  Navigator(const NavigationOptions& navigation, const RestOptions& rest);

  void set_options(const NavigationOptions& navigation) noexcept;
  [[nodiscard]] const NavigationOptions& options() const noexcept { return options_; }

  /// Another user, or the same one wants a new rest pose.
  void start_over() noexcept;

  /// A frame in which the user was tracked: measure(), then drive(). `up` is the floor's normal, camera frame.
  const Navigation& process(const Skeleton& skeleton, const Eigen::Vector3f& up,
                            std::chrono::nanoseconds time) noexcept {
    measure(skeleton, up, time);
    return drive();
  }

  /// The first half: rest pose and motion receptors.
  void measure(const Skeleton& skeleton, const Eigen::Vector3f& up, std::chrono::nanoseconds time) noexcept;
  /// The second half: transfer functions and actuator.
  const Navigation& drive() noexcept;

  /// The camera stands. Instead of the second half, or between frames where whoever publishes has said so; what is
  /// measured goes on. The next drive() speeds up from a standstill, by one frame's step however long it stood.
  void hold() noexcept;

  /// A frame in which she was not tracked: the camera stops at once.
  const Navigation& stop() noexcept;

  [[nodiscard]] const Navigation& navigation() const noexcept { return out_; }
  [[nodiscard]] const RestEstimator& rest() const noexcept { return rest_; }

 private:
  NavigationOptions options_;
  RestEstimator rest_;
  MotionMeter meter_;
  RangeAdapter adapter_;
  PerMotion<float> range_rad_{};  // in force
  PerMotion<ShapedMotion> shapes_;
  Actuator actuator_;
  std::optional<std::chrono::nanoseconds> last_time_;
  std::chrono::nanoseconds dt_{0};  // between the last two tracked frames
  bool held_ = false;               // since the last drive()
  RestOptions rest_options_;
  Navigation out_;
};

}  // namespace armature
