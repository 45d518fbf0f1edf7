#include "tracker/engagement/engagement.h"

#include <cmath>

namespace armature {
namespace {

/// Smaller is more likely to be the one who wants to steer: near, and in front of the sensor.
float distance_to_steering_place(const User& user) {
  return user.centre.z() + 2 * std::abs(user.centre.x());
}

/// How far a user may have moved while the segmentation had her under no id or another one, metres.
constexpr float kSamePerson = 0.4F;

}  // namespace

std::uint8_t Engagement::choose(std::span<const User> users, std::chrono::nanoseconds time) noexcept {
  user_changed_ = false;
  const User* chosen = nullptr;
  for (const User& user : users) {
    if (user_ != 0 && user.id == user_) chosen = &user;
  }
  if (chosen == nullptr && user_ != 0) {
    // Not under her id. Somebody who stands just where she stood is her; otherwise she keeps her turn for a while.
    for (const User& user : users) {
      if ((user.centre - last_centre_).norm() < kSamePerson) chosen = &user;
    }
    if (chosen == nullptr && time - last_seen_ <= options_.lost_timeout) return 0;
  }
  if (chosen == nullptr) {
    for (const User& user : users) {
      if (chosen == nullptr || distance_to_steering_place(user) < distance_to_steering_place(*chosen)) chosen = &user;
    }
    user_changed_ = user_ != 0 || chosen != nullptr;
    if (chosen == nullptr) {
      release();
      return 0;
    }
    state_ = EngagementState::Calibrating;
  }
  user_ = chosen->id;
  last_seen_ = time;
  last_centre_ = chosen->centre;
  return user_;
}

EngagementState Engagement::update(bool tracked, bool rest_known) noexcept {
  if (user_ == 0) return state_;
  if (!rest_known) {
    state_ = EngagementState::Calibrating;
  } else {
    state_ = tracked ? EngagementState::Engaged : EngagementState::Lost;
  }
  return state_;
}

void Engagement::release() noexcept {
  user_ = 0;
  state_ = EngagementState::Absent;
}

}  // namespace armature
