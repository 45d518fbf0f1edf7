#include "tools/terminal/live_model.h"

#include <algorithm>
#include <cmath>

namespace armature::tools {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr double kPathSpacing = 0.05;  // metres
constexpr std::size_t kLongestPath = 20'000;

/// Share by which the point of view follows the user each frame: about one second at 30 Hz.
constexpr float kFollow = 0.03F;
/// Who is farther away than this from the point of view, metres, is somebody else or has just come.
constexpr float kJump = 0.8F;

float followed(float from, float to) {
  return std::abs(to - from) > kJump ? to : from + kFollow * (to - from);
}

}  // namespace

LiveModel::LiveModel(std::string endpoint, nanoseconds now) : start_(now), advanced_(now) {
  state_.endpoint = std::move(endpoint);
  state_.path.push_back(camera_.pose());
}

void LiveModel::take(const navproto::NavigationMessage& message, nanoseconds now) {
  state_.navigation = message;
  // A state sent again to a late joiner is as old as it is, and says nothing about rate and latency.
  if (message.header.replayed) return;
  arrived_ = now;
  arrivals_.push_back(now);
  const double latency = std::chrono::duration<double>(now - message.times.received).count();
  // A publisher on another machine has another clock.
  if (latency >= 0 && latency < 10) {
    const double before = state_.latency.count();
    state_.latency = std::chrono::duration<double>(before == 0 ? latency : before + 0.1 * (latency - before));
  }
}

void LiveModel::take(const navproto::SkeletonMessage& message) {
  state_.skeleton = message;
  if (!message.tracking) return;
  const auto& user = message.user_position;
  state_.anchor = {followed(state_.anchor.x, user.x), followed(state_.anchor.y, user.y),
                   followed(state_.anchor.z, user.z)};
  for (const auto foot : {navproto::JointId::LeftFoot, navproto::JointId::RightFoot}) {
    const auto& joint = message.joints[static_cast<std::size_t>(foot)];
    if (joint.state == navproto::JointState::Lost) continue;
    const auto& up = message.user_up;
    const float height = joint.position.x * up.x + joint.position.y * up.y + joint.position.z * up.z;
    // A lifted foot does not lift the floor.
    state_.floor_height =
        state_.floor_height ? followed(*state_.floor_height, std::min(height, *state_.floor_height + 0.1F)) : height;
  }
}

void LiveModel::take(const navproto::ControlSettings& settings) {
  for (const auto& motion : settings.motions) state_.alpha[static_cast<std::size_t>(motion.motion)] = motion.alpha;
}

void LiveModel::advance(const navproto::Velocity& velocity, nanoseconds now) {
  camera_.advance(velocity, std::chrono::duration<double>(now - advanced_));
  advanced_ = now;
  state_.elapsed = now - start_;
  state_.velocity = velocity;
  state_.fresh = arrived_ != 0ns && now - arrived_ <= 250ms;
  std::erase_if(arrivals_, [&](nanoseconds time) { return now - time > 1s; });
  state_.frames_per_second = static_cast<double>(arrivals_.size());

  const auto& pose = camera_.pose();
  state_.walked_m += std::hypot(pose.x_m - state_.camera.x_m, pose.y_m - state_.camera.y_m);
  state_.camera = pose;
  const auto& last = state_.path.back();
  if (std::hypot(pose.x_m - last.x_m, pose.y_m - last.y_m) >= kPathSpacing) {
    if (state_.path.size() == kLongestPath) state_.path.erase(state_.path.begin());
    state_.path.push_back(pose);
  }
}

}  // namespace armature::tools
