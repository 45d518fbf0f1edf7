#pragma once

#include <chrono>
#include <cstdint>
#include <span>

#include "tracker/segmentation/segmenter.h"

namespace armature {

enum class EngagementState : std::uint8_t {
  Absent,       ///< nobody in the active zone
  Calibrating,  ///< somebody is there; her rest pose is being captured
  Engaged,      ///< she steers
  Lost,         ///< she was steering and cannot be tracked at the moment
};

/// Why the velocities are zero although someone might expect otherwise.
enum class StopReason : std::uint8_t {
  None,  ///< they are what the motions say (which may be zero: at rest)
  NoUser,
  Calibrating,
  TrackingLost,
  TooNoisy,  ///< both stand, and a steering motion would need too wide a dead zone to be steered with
};

struct EngagementOptions {
  std::chrono::milliseconds lost_timeout{1500};  ///< a user out of sight for longer has to calibrate again
};

/// Decides who steers: whoever is engaged keeps steering for as long as she is there; otherwise the user nearest to
/// the optical axis and the sensor. Realtime-safe: yes.
class Engagement {
 public:
  explicit Engagement(const EngagementOptions& options) : options_(options) {}

  void set_options(const EngagementOptions& options) noexcept { options_ = options; }

  /// The active user's id in this frame, 0 = not visible.
  std::uint8_t choose(std::span<const User> users, std::chrono::nanoseconds time) noexcept;

  /// After the skeleton: was she tracked, and is her rest pose known?
  EngagementState update(bool tracked, bool rest_known) noexcept;

  /// Lets the active user go: the next frame chooses anew.
  void release() noexcept;

  [[nodiscard]] EngagementState state() const noexcept { return state_; }
  [[nodiscard]] std::uint8_t user() const noexcept { return user_; }

  /// True in the frame in which choose() took on another user or let one go: what was known of her is void.
  [[nodiscard]] bool user_changed() const noexcept { return user_changed_; }

 private:
  EngagementOptions options_;
  EngagementState state_ = EngagementState::Absent;
  std::uint8_t user_ = 0;
  bool user_changed_ = false;
  std::chrono::nanoseconds last_seen_{0};
  Eigen::Vector3f last_centre_ = Eigen::Vector3f::Zero();
};

}  // namespace armature
