#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "firmware_host/clock.h"
#include "firmware_host/depth_frame.h"
#include "tracker/engagement/engagement.h"
#include "tracker/forest/part_classifier.h"
#include "tracker/joints/joint_estimator.h"
#include "tracker/navigator.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

/// What the whole tracker is set up with. Every default is ours (the source publishes none).
struct TrackerOptions {
  SegmentationOptions segmentation;
  ClassifierOptions forest;
  JointOptions joints;
  RestOptions rest;
  NavigationOptions navigation;
  EngagementOptions engagement;
};

/// In the order in which a frame walks through them; engagement is what is left: who steers, and what to say of it.
enum class StageId : std::uint8_t { Segmentation, Forest, Joints, Motions, Transfer, Engagement };
inline constexpr int kStageCount = 6;
inline constexpr std::array<std::string_view, kStageCount> kStageNames = {"segmentation", "forest",   "joints",
                                                                          "motions",      "transfer", "engagement"};

enum class TrackerEventKind : std::uint8_t {
  UserEntered,
  UserLeft,
  RestCaptured,
  Engaged,
  Released,  ///< steers no more; anybody may be next
  TrackingLost,
  TrackingRegained,
  MotionTooNoisy,
};
struct TrackerEvent {
  TrackerEventKind kind = TrackerEventKind::UserEntered;
  std::uint8_t user = 0;
  MotionId motion = MotionId::RotateShoulders;  ///< MotionTooNoisy: which
};

/// All that is known after a frame.
struct TrackerOutput {
  std::uint64_t sequence = 0;
  Timestamp sensor, host;
  bool tracking = false;  ///< a skeleton is there, whoever is engaged
  std::uint8_t user = 0;  ///< the active user, 0 = none
  Skeleton skeleton;      ///< of the active user, filtered; all lost where not tracking
  UserFrame user_frame;   ///< of the rest pose, once known
  EngagementState state = EngagementState::Absent;
  StopReason stop = StopReason::NoUser;
  float rest_progress = 0;  ///< in [0, 1]
  Navigation navigation;
  std::array<std::chrono::nanoseconds, kStageCount> stage_time{};
  std::span<const TrackerEvent> events;         ///< of this frame
  std::span<const std::uint8_t> user_of_pixel;  ///< [height][width], as Segmentation has it
};

/// Composes the stages: segmentation -> forest -> joints -> motions, transfer and actuator. Owns all their memory.
/// Deterministic: the same frames give the same output (stage_time aside), since time is that of the frames.
/// Thread-safe: no. Realtime-safe: process() yes, after the first frame of a resolution.
class Pipeline {
 public:
  /// `stage_clock` times the stages and nothing else.
  Pipeline(std::shared_ptr<const Forest> forest, const TrackerOptions& options,
           std::shared_ptr<Clock> stage_clock = std::make_shared<SteadyClock>());
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Takes the memory that frames of this size need, and forgets background and users. process() does it by itself
  /// where a frame has another size than the last one; calling it before keeps the first frame free of allocations.
  void reset(const Intrinsics& intrinsics);

  /// The result is valid until the next call.
  const TrackerOutput& process(DepthView frame) noexcept;

  /// Lets whoever is there go, as a long gap between frames does: the next frame chooses anew. The background stays.
  /// What is to be said of it is valid until the next call.
  std::span<const TrackerEvent> release() noexcept;

  /// Says that a velocity of zero was published between frames: the next frame speeds up from a standstill. Rest pose,
  /// filters and who steers stay. Realtime-safe: yes.
  void halt() noexcept;

  /// The active user's rest pose is captured anew.
  void capture_rest() noexcept;

  /// Takes effect with the next frame; the rest pose stays.
  void set_navigation(const NavigationOptions& options) noexcept;
  [[nodiscard]] const NavigationOptions& navigation_options() const noexcept;

  /// The rest pose in force and how noisy each motion is there; nothing before it is captured.
  [[nodiscard]] const RestEstimator& rest() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A skeleton is there: head or neck, both shoulders and the waist are known, and most of them from this frame.
[[nodiscard]] bool tracked(const Skeleton& skeleton) noexcept;

}  // namespace armature
