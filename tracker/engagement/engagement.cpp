#include "tracker/engagement/engagement.h"

#include <cmath>

#include <Eigen/Geometry>

namespace armature {
namespace {

using namespace std::chrono_literals;
using Eigen::Vector2f;
using Eigen::Vector3f;

/// Who stays this close to one place stands still. Leaning and bending move the middle of a body by more, but nobody
/// does that before she steers.
constexpr float kStillRadius_m = 0.10F;
constexpr std::chrono::nanoseconds kSettled = 300ms;
/// A candidate who stands about but whose rest pose does not come: a chair, a ghost, a child that hops.
constexpr std::chrono::nanoseconds kPatience = 4s;
/// A candidate or user who is hidden for so long has not gone.
constexpr std::chrono::nanoseconds kHidden = 500ms;
/// The same person under another id: at once where she was a moment ago; later near where she was, once she stands.
constexpr std::chrono::nanoseconds kMoment = 150ms;
constexpr float kSamePlace_m = 0.25F;
constexpr float kNearPlace_m = 0.40F;
constexpr std::chrono::nanoseconds kStandsAgain = 200ms;
/// Who steers may stand so far outside the zone's edge.
constexpr float kZoneMargin_m = 0.20F;
/// Somebody in front: so much nearer, so far to the side.
constexpr float kRowDepth_m = 0.40F;
constexpr float kRowHalfWidth_m = 0.35F;
/// Between the shoulder joints over from the waist to the neck.
constexpr float kShouldersOverTorso = 0.85F;
constexpr float kLeastTorso_m = 0.20F;  // no child who stands has a shorter one

Vector2f on_floor(const Vector3f& point, const Vector3f& up) noexcept {
  const Vector3f ahead = (Vector3f::UnitZ() - up.z() * up).normalized();
  const Vector3f right = ahead.cross(up);
  return {point.dot(right), point.dot(ahead)};
}

}  // namespace

std::uint8_t Engagement::choose(std::span<const User> users, const Vector3f& up, Time time) noexcept {
  user_changed_ = false;
  // Our own time never runs backwards: what a sensor's clock jumps back by is added from then on.
  if (began_ && time <= last_frame_) shift_ += last_frame_ - time + 1ms;
  began_ = true;
  last_frame_ = time;
  now_ = time + shift_;
  follow(users, up, now_);
  if (locked_ && now_ - last_steered_ > options_.lost_timeout) {
    locked_ = false;
    away_ = false;
    user_ = 0;
    user_changed_ = true;
    state_ = EngagementState::Absent;
  }
  return locked_ ? stay_with_user() : pick_candidate();
}

void Engagement::follow(std::span<const User> users, const Vector3f& up, Time time) noexcept {
  for (const User& user : users) {
    Person* p = person(user.id);
    const bool known = p != nullptr;
    if (!known) {
      p = &persons_.front();
      for (Person& other : persons_) {
        if (other.id == 0 || (p->id != 0 && other.last_seen < p->last_seen)) p = &other;
        if (p->id == 0) break;
      }
      *p = Person{.id = user.id};
    }
    p->place = on_floor(user.centre, up);
    if (!known || time - p->last_seen > kHidden || (p->place - p->anchor).norm() > kStillRadius_m) {
      p->anchor = p->place;
      p->still_since = time;
    }
    p->last_seen = time;
  }
  for (Person& p : persons_) {
    if (p.id != 0 && time - p.last_seen > 10s) p = Person{};
  }
}

Engagement::Person* Engagement::person(std::uint8_t id) noexcept {
  for (Person& p : persons_) {
    if (id != 0 && p.id == id) return &p;
  }
  return nullptr;
}

bool Engagement::still(const Person& p) const noexcept {
  return now_ - p.still_since >= kSettled;
}

bool Engagement::in_zone(const Person& p, float margin) const noexcept {
  return p.place.y() >= options_.near_m - margin && p.place.y() <= options_.far_m + margin &&
         std::abs(p.place.x()) <= options_.half_width_m + margin;
}

bool Engagement::somebody_before(const Person& p) const noexcept {
  for (const Person& other : persons_) {
    if (!seen_now(other) || other.id == p.id || passed_over(other) || !in_zone(other, 0)) continue;
    if (other.place.y() + kRowDepth_m > p.place.y() || other.place.y() <= 0) continue;
    const float aside = p.place.x() - other.place.x() * p.place.y() / other.place.y();
    if (std::abs(aside) < kRowHalfWidth_m) return true;
  }
  return false;
}

bool Engagement::better(const Person& a, const Person& b) const noexcept {
  if (passed_over(a) != passed_over(b)) return !passed_over(a);
  if (still(a) != still(b)) return still(a);
  return a.place.norm() < b.place.norm();
}

Engagement::Person* Engagement::user_again() noexcept {
  Person* found = person(user_);
  if (found != nullptr && seen_now(*found)) return found;
  for (Person& p : persons_) {
    if (!seen_now(p)) continue;
    const float away = (p.place - user_place_).norm();
    const bool just_now = now_ - last_visible_ <= kMoment && away < kSamePlace_m;
    const bool again = away < kNearPlace_m && now_ - p.still_since >= kStandsAgain;
    if (just_now || again) return &p;
  }
  return nullptr;
}

std::uint8_t Engagement::stay_with_user() noexcept {
  const Person* p = user_again();
  if (p == nullptr) return 0;
  user_ = p->id;
  last_visible_ = now_;
  user_place_ = p->place;
  away_ = (p->place - home_).norm() > options_.place_radius_m || !in_zone(*p, kZoneMargin_m);
  return user_;
}

std::uint8_t Engagement::pick_candidate() noexcept {
  Person* candidate = user_ == 0 ? nullptr : user_again();
  if (user_ != 0 && candidate == nullptr && now_ - last_visible_ <= kHidden) return 0;
  if (candidate != nullptr && now_ - taken_ > kPatience) {
    candidate->passed_over_until = now_ + kPatience;
    taken_ = now_;
  }
  const Person* best = nullptr;
  for (const Person& p : persons_) {
    if (!seen_now(p) || !in_zone(p, &p == candidate ? kZoneMargin_m : 0) || somebody_before(p)) continue;
    if (best == nullptr || better(p, *best)) best = &p;
    if (&p == candidate && still(p) && !passed_over(p)) {
      best = &p;  // she was there first
      break;
    }
  }
  if (candidate != nullptr && best == candidate) user_ = candidate->id;
  take(best == nullptr ? 0 : best->id);
  if (best == nullptr) return 0;
  last_visible_ = now_;
  user_place_ = best->place;
  return user_;
}

void Engagement::take(std::uint8_t id) noexcept {
  if (id == user_) return;
  user_ = id;
  user_changed_ = true;
  taken_ = now_;
  state_ = id == 0 ? EngagementState::Absent : EngagementState::Waiting;
}

EngagementState Engagement::update(const Seen& seen) noexcept {
  if (user_ == 0) return state_ = EngagementState::Absent;
  Person* p = person(user_);
  const bool visible = p != nullptr && seen_now(*p);
  if (locked_) {
    const bool here = visible && seen.tracked && !away_;
    if (here) last_steered_ = now_;
    if (!here) return state_ = EngagementState::Lost;
    if (seen.rest_known && state_ == EngagementState::Calibrating) home_ = p->place;
    return state_ = seen.rest_known ? EngagementState::Engaged : EngagementState::Calibrating;
  }
  if (seen.rest_known && seen.tracked && visible) {
    locked_ = true;
    away_ = false;
    home_ = p->place;
    last_steered_ = now_;
    return state_ = EngagementState::Engaged;
  }
  if (visible && seen.tracked && !seen.facing) p->passed_over_until = now_ + kHidden;
  return state_ = seen.rest_progress > 0 ? EngagementState::Calibrating : EngagementState::Waiting;
}

bool Engagement::faces_sensor(const Skeleton& skeleton) const noexcept {
  const Joint& left = skeleton[JointId::LeftShoulder];
  const Joint& right = skeleton[JointId::RightShoulder];
  const Joint& neck = skeleton[JointId::Neck];
  const Joint& waist = skeleton[JointId::Waist];
  for (const Joint* joint : {&left, &right, &neck, &waist}) {
    if (joint->state == JointState::Lost) return false;
  }
  // Seen from above: a person's left is to the camera's right when she faces it.
  const Vector3f across = left.position - right.position;
  const Vector3f middle = (left.position + right.position) / 2;
  const Vector2f to_the_right = Vector2f(middle.z(), -middle.x()).normalized();
  const float seen_m = Vector2f(across.x(), across.z()).dot(to_the_right);
  // Joints know less and less how far somebody is turned, but that her shoulders look narrow.
  const float torso_m = (neck.position - waist.position).norm();
  return torso_m > kLeastTorso_m && seen_m > std::cos(options_.facing_rad) * kShouldersOverTorso * torso_m;
}

void Engagement::release() noexcept {
  const EngagementOptions options = options_;
  *this = Engagement(options);
}

}  // namespace armature
