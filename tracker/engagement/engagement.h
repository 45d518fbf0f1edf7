#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "tracker/body/skeleton.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

enum class EngagementState : std::uint8_t {
  Absent,       ///< nobody who may steer is in the active zone
  Waiting,      ///< somebody is there who does not stand still, or does not face the sensor
  Calibrating,  ///< somebody stands still; her rest pose is being captured
  Engaged,      ///< she steers
  Lost,         ///< she was steering and has left her place, or cannot be tracked at the moment
};

/// Why the velocities are zero although someone might expect otherwise.
enum class StopReason : std::uint8_t {
  None,  ///< they are what the motions say (which may be zero: at rest)
  NoUser,
  NotEngaged,  ///< somebody is there and does not steer yet
  TrackingLost,
  TooNoisy,  ///< both stand, and a steering motion would need too wide a dead zone to be steered with
};

/// The active zone is a rectangle on the floor before the sensor; distances are measured along the floor. Every default
/// is ours.
struct EngagementOptions {
  float near_m = 0.5F;       ///< the zone begins so far before the sensor
  float far_m = 4.5F;        ///< and ends so far
  float half_width_m = 2;    ///< to either side
  float place_radius_m = 1;  ///< whoever steers and moves farther from where she stood still has left her place
  float facing_rad = 1.1F;   ///< whose shoulders look as narrow as if turned farther does not face the sensor
  std::chrono::milliseconds lost_timeout{2000};  ///< a user who has left or is lost for longer is released
};

/// Decides who steers.
///
/// | state       | goes on to  | when |
/// |-------------|-------------|------|
/// | Absent      | Waiting     | a person stands in the zone, and nobody stands in front of her |
/// | Waiting     | Calibrating | the candidate faces the sensor and stands still |
/// | Calibrating | Waiting     | she moves or turns away |
/// | Calibrating | Engaged     | her rest pose is known: after a second of standing still |
/// | Engaged     | Lost        | in the frame in which she cannot be tracked, leaves her place or the zone |
/// | Lost        | Engaged     | she, or somebody who stands where she stood, is tracked there again |
/// | Lost        | Absent      | after `lost_timeout` |
///
/// The candidate is the closest of those who stand still, or else the closest. She stays the candidate while she stands
/// still, for as long as her patience lasts, so that who stands there first is not overtaken by who comes closer. From
/// Engaged until she is released nobody takes over. A gap in time counts as time that passed; a jump back does not.
/// Fixed memory. Thread-safe: no. Realtime-safe: yes.
class Engagement {
 public:
  explicit Engagement(const EngagementOptions& options) : options_(options) {}

  void set_options(const EngagementOptions& options) noexcept { options_ = options; }

  /// The active user's or candidate's id in this frame, 0 = not visible. `up` is the floor's normal, camera frame.
  std::uint8_t choose(std::span<const User> users, const Eigen::Vector3f& up, std::chrono::nanoseconds time) noexcept;

  /// After the skeleton of whom choose() named: was she tracked, does she face the sensor, is her rest pose known, and
  /// how far is it (RestEstimator::progress)?
  struct Seen {
    bool tracked = false;
    bool facing = false;
    bool rest_known = false;
    float rest_progress = 0;
  };
  EngagementState update(const Seen& seen) noexcept;

  /// Whether these shoulders are turned to the sensor: as wide, seen from there, as those of somebody turned by
  /// facing_rad are.
  [[nodiscard]] bool faces_sensor(const Skeleton& skeleton) const noexcept;

  /// Lets the active user go and forgets everybody: the next frame chooses anew.
  void release() noexcept;

  [[nodiscard]] EngagementState state() const noexcept { return state_; }
  [[nodiscard]] std::uint8_t user() const noexcept { return user_; }
  /// Nobody else may take over: she steers, has a new rest pose taken, or has been away for less than lost_timeout.
  [[nodiscard]] bool locked() const noexcept { return locked_; }

  /// True in the frame in which choose() took on another user or let one go: what was known of her is void.
  [[nodiscard]] bool user_changed() const noexcept { return user_changed_; }

 private:
  using Time = std::chrono::nanoseconds;
  /// Where somebody is on the floor: x to the camera's right, y away from it, metres.
  struct Person {
    std::uint8_t id = 0;  ///< 0 = this place is free
    Eigen::Vector2f place = Eigen::Vector2f::Zero();
    Eigen::Vector2f anchor = Eigen::Vector2f::Zero();  ///< about where she has stood since still_since
    Time still_since{0};
    Time last_seen{0};
    Time passed_over_until{0};  ///< others get their chance until then
  };
  static constexpr std::size_t kMaxPersons = 8;

  void follow(std::span<const User> users, const Eigen::Vector3f& up, Time time) noexcept;
  [[nodiscard]] Person* person(std::uint8_t id) noexcept;
  [[nodiscard]] bool seen_now(const Person& p) const noexcept { return p.id != 0 && p.last_seen == now_; }
  [[nodiscard]] bool still(const Person& p) const noexcept;
  [[nodiscard]] bool in_zone(const Person& p, float margin) const noexcept;
  [[nodiscard]] bool passed_over(const Person& p) const noexcept { return now_ < p.passed_over_until; }
  [[nodiscard]] bool somebody_before(const Person& p) const noexcept;
  [[nodiscard]] bool better(const Person& a, const Person& b) const noexcept;
  [[nodiscard]] Person* user_again() noexcept;
  std::uint8_t stay_with_user() noexcept;
  std::uint8_t pick_candidate() noexcept;
  void take(std::uint8_t id) noexcept;

  EngagementOptions options_;
  EngagementState state_ = EngagementState::Absent;
  std::array<Person, kMaxPersons> persons_{};
  std::uint8_t user_ = 0;
  bool locked_ = false;
  bool away_ = false;  ///< locked, visible, and not at her place
  bool user_changed_ = false;
  Time now_{0}, shift_{0}, last_frame_{0};
  bool began_ = false;
  Time taken_{0};         ///< when the candidate became one
  Time last_visible_{0};  ///< the active user
  Time last_steered_{0};
  Eigen::Vector2f user_place_ = Eigen::Vector2f::Zero();  ///< where she was last seen
  Eigen::Vector2f home_ = Eigen::Vector2f::Zero();        ///< where she stood still
};

}  // namespace armature
