#include "tracker/navigator.h"

#include <algorithm>
#include <utility>

namespace armature {
namespace {

using namespace std::chrono_literals;

/// After a longer gap between tracked frames the past says nothing about the present.
constexpr std::chrono::nanoseconds kForgetAfter = 500ms;
constexpr std::chrono::nanoseconds kFirstStep = 33ms;

}  // namespace

Navigator::Navigator(const NavigationOptions& navigation, const RestOptions& rest)
    : options_(navigation),
      rest_(rest, navigation.motions),
      meter_(navigation.motions),
      range_rad_(navigation.motions.range_rad),
      actuator_(navigation.actuator),
      rest_options_(rest) {}

void Navigator::set_options(const NavigationOptions& navigation) noexcept {
  options_ = navigation;
  rest_.set_options(rest_options_, navigation.motions);
  meter_.set_options(navigation.motions);
  actuator_.set_options(navigation.actuator);
}

void Navigator::start_over() noexcept {
  rest_.reset();
  adapter_.reset();
  meter_.set_options(options_.motions);
  stop();
}

const Navigation& Navigator::stop() noexcept {
  meter_.reset();
  for (ShapedMotion& shape : shapes_) shape.reset();
  last_time_.reset();
  out_ = Navigation{};
  out_.velocity = actuator_.stop();
  return out_;
}

void Navigator::hold() noexcept {
  held_ = true;
  for (ShapedMotion& shape : shapes_) shape.reset();
  out_.walk = 0;
  out_.turn = 0;
  out_.velocity = actuator_.stop();
}

void Navigator::measure(const Skeleton& skeleton, const Eigen::Vector3f& up, std::chrono::nanoseconds time) noexcept {
  if (last_time_ && (time <= *last_time_ || time - *last_time_ > kForgetAfter)) stop();
  dt_ = last_time_ ? time - *last_time_ : kFirstStep;
  last_time_ = time;

  rest_.observe(skeleton, up, time);
  if (!rest_.rest()) return;

  const PerMotion<MotionReading>& readings = meter_.measure(skeleton, *rest_.rest(), dt_);
  range_rad_ = adapter_.adapt(readings, options_.motions.range_rad, skeleton, dt_, options_.adaptation);
  if (options_.adaptation.enabled) {
    MotionOptions now = options_.motions;
    now.range_rad = range_rad_;
    meter_.set_options(now);  // from the next frame on
  }
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    out_.motions[m].angle_rad = readings[m].angle_rad;
    out_.motions[m].normalized = readings[m].normalized;
    out_.motions[m].confidence = readings[m].confidence;
  }
}

const Navigation& Navigator::drive() noexcept {
  if (!rest_.rest()) return out_;
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    MotionOutput& motion = out_.motions[m];
    motion.dead_zone = dead_zone(options_.transfer[m].alpha, rest_.sigma_rad()[m] / range_rad_[m]);
    motion.shaped = shapes_[m].shape(motion.normalized, motion.dead_zone, options_.transfer[m].beta);
  }
  const MotionOutput& walking = out_.motions[index(options_.pair.walk)];
  const MotionOutput& turning = out_.motions[index(options_.pair.turn)];
  out_.walk = walking.shaped;
  out_.turn = turning.shaped;
  out_.too_noisy = walking.dead_zone > kMaxDeadZone || turning.dead_zone > kMaxDeadZone;
  const auto speeding_up = std::exchange(held_, false) ? std::min(dt_, kFirstStep) : dt_;
  out_.velocity = actuator_.drive(out_.walk, out_.turn, speeding_up);
  return out_;
}

}  // namespace armature
