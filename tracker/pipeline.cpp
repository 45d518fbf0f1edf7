#include "tracker/pipeline.h"

#include "tracker/joints/occlusion.h"
#include "tracker/joints/skeleton_filter.h"

namespace armature {
namespace {

/// Times one stage after another.
class StageTimer {
 public:
  StageTimer(const Clock& clock, std::array<std::chrono::nanoseconds, kStageCount>& times) noexcept
      : clock_(clock), times_(times), last_(clock.now()) {
    times_.fill(std::chrono::nanoseconds(0));
  }

  void done(StageId stage) noexcept {
    const auto now = clock_.now();
    times_[static_cast<std::size_t>(stage)] += now - last_;
    last_ = now;
  }

 private:
  const Clock& clock_;
  std::array<std::chrono::nanoseconds, kStageCount>& times_;
  std::chrono::nanoseconds last_;
};

bool stands(const CameraVelocity& velocity) noexcept {
  return velocity.linear_m_s == 0 && velocity.angular_rad_s == 0;
}

constexpr std::size_t kMaxEvents = 5 + kMotionCount;

}  // namespace

bool tracked(const Skeleton& skeleton) noexcept {
  using enum JointId;
  const auto known = [&](JointId joint) { return skeleton[joint].state != JointState::Lost; };
  const auto seen = [&](JointId joint) { return skeleton[joint].state == JointState::Observed ? 1 : 0; };
  if (!(known(Head) || known(Neck)) || !known(LeftShoulder) || !known(RightShoulder) || !known(Waist)) return false;
  return seen(Head) + seen(Neck) + seen(LeftShoulder) + seen(RightShoulder) + seen(Waist) >= 3;
}

struct Pipeline::State {
  State(std::shared_ptr<const Forest> forest, const TrackerOptions& all, std::shared_ptr<Clock> clock)
      : options(all),
        stage_clock(std::move(clock)),
        segmenter(all.segmentation),
        classifier(forest, all.forest),
        joints(std::move(forest), all.joints),
        engagement(all.engagement),
        navigator(all.navigation, all.rest) {}

  void say(TrackerEventKind kind, std::uint8_t user, MotionId motion = MotionId::RotateShoulders) noexcept {
    if (event_count < kMaxEvents) events[event_count++] = {kind, user, motion};
  }
  void say_gone(std::uint8_t user, bool was_locked) noexcept {
    if (was_locked) say(TrackerEventKind::Released, user);
    if (user != 0) say(TrackerEventKind::UserLeft, user);
  }
  void start_over() noexcept {
    navigator.start_over();
    joints.reset();
    filter.reset();
    too_noisy = {};
    was_engaged = false;
  }
  void watch_noise(std::uint8_t user) noexcept {
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      const bool noisy = navigator.navigation().motions[m].dead_zone > kMaxDeadZone;
      if (noisy && !too_noisy[m]) say(TrackerEventKind::MotionTooNoisy, user, static_cast<MotionId>(m));
      too_noisy[m] = noisy;
    }
  }

  TrackerOptions options;
  std::shared_ptr<Clock> stage_clock;
  Intrinsics intrinsics;
  Segmenter segmenter;
  PartClassifier classifier;
  JointEstimator joints;
  SkeletonFilter filter;
  Engagement engagement;
  Navigator navigator;
  std::array<TrackerEvent, kMaxEvents> events{};
  std::size_t event_count = 0;
  PerMotion<bool> too_noisy{};
  bool was_engaged = false;
  TrackerOutput out;
};

Pipeline::Pipeline(std::shared_ptr<const Forest> forest, const TrackerOptions& options,
                   std::shared_ptr<Clock> stage_clock)
    : state_(std::make_unique<State>(std::move(forest), options, std::move(stage_clock))) {}
Pipeline::~Pipeline() = default;

void Pipeline::reset(const Intrinsics& intrinsics) {
  State& s = *state_;
  s.intrinsics = intrinsics;
  s.segmenter.reset(intrinsics);
  s.classifier.reset(intrinsics);
  s.engagement.release();
  s.start_over();
}

const TrackerOutput& Pipeline::process(DepthView frame) noexcept {
  State& s = *state_;
  s.event_count = 0;
  if (frame.intrinsics != s.intrinsics) {
    release();
    reset(frame.intrinsics);
  }
  TrackerOutput& out = s.out;
  out.sequence = frame.sequence;
  out.sensor = frame.sensor;
  out.host = frame.host;
  const auto time = frame.sensor.time;
  StageTimer timer(*s.stage_clock, out.stage_time);

  const Segmentation& segmentation = s.segmenter.process(frame);
  timer.done(StageId::Segmentation);

  const std::uint8_t last_user = s.engagement.user();
  const bool was_locked = s.engagement.locked();
  const EngagementState last_state = s.engagement.state();
  const std::uint8_t visible_user = s.engagement.choose(segmentation.users, segmentation.up, time);
  if (s.engagement.user_changed()) {
    s.say_gone(last_user, was_locked);
    if (visible_user != 0) s.say(TrackerEventKind::UserEntered, visible_user);
    s.start_over();
  }
  timer.done(StageId::Engagement);

  out.tracking = false;
  if (visible_user != 0) {
    const PartVotes& votes = s.classifier.classify(frame, segmentation.user_of_pixel, visible_user);
    timer.done(StageId::Forest);
    s.joints.estimate(votes, out.skeleton);
    doubt_hidden_joints(frame, segmentation, visible_user, out.skeleton);
    out.tracking = tracked(out.skeleton);
    timer.done(StageId::Joints);
  }

  const RestEstimator& rest = s.navigator.rest();
  const bool rest_was_known = rest.rest().has_value();
  // Who stands sideways may look narrow to the votes alone: corrections know people from the front only.
  const bool facing =
      out.tracking && s.engagement.faces_sensor(out.skeleton) && s.engagement.faces_sensor(s.joints.voted());
  if (out.tracking && (facing || rest_was_known)) {
    s.navigator.measure(out.skeleton, segmentation.up, time);
  } else if (!rest_was_known) {
    s.navigator.start_over();  // a rest pose is one of standing still and facing the sensor
  }
  const bool rest_known = rest.rest().has_value();
  s.joints.keep_build(rest_known);
  out.state = s.engagement.update({out.tracking, facing, rest_known, rest.progress()});
  out.user = s.engagement.user();
  if (out.tracking) s.filter.filter(out.skeleton, time);  // motions have their own: two in a row would only be late
  timer.done(StageId::Motions);
  if (out.state == EngagementState::Engaged) {
    out.navigation = s.navigator.drive();
  } else if (out.tracking) {
    s.navigator.hold();
    out.navigation = s.navigator.navigation();
  } else {
    out.skeleton = Skeleton{};
    out.navigation = s.navigator.stop();
  }
  timer.done(StageId::Transfer);
  out.rest_progress = rest.progress();
  if (rest_known) out.user_frame = rest.rest()->frame;

  if (rest_known && !rest_was_known) s.say(TrackerEventKind::RestCaptured, out.user);
  if (out.state == EngagementState::Engaged && last_state != EngagementState::Engaged) {
    s.say(s.was_engaged ? TrackerEventKind::TrackingRegained : TrackerEventKind::Engaged, out.user);
    s.was_engaged = true;
  }
  if (out.state == EngagementState::Lost && last_state == EngagementState::Engaged) {
    s.say(TrackerEventKind::TrackingLost, out.user);
  }
  if (out.state == EngagementState::Engaged) s.watch_noise(out.user);

  switch (out.state) {
    case EngagementState::Absent: out.stop = StopReason::NoUser; break;
    case EngagementState::Waiting:
    case EngagementState::Calibrating: out.stop = StopReason::NotEngaged; break;
    case EngagementState::Lost: out.stop = StopReason::TrackingLost; break;
    case EngagementState::Engaged:
      out.stop = out.navigation.too_noisy && stands(out.navigation.velocity) ? StopReason::TooNoisy : StopReason::None;
      break;
  }
  out.events = {s.events.data(), s.event_count};
  out.user_of_pixel = segmentation.user_of_pixel;
  timer.done(StageId::Engagement);
  return out;
}

std::span<const TrackerEvent> Pipeline::release() noexcept {
  State& s = *state_;
  s.event_count = 0;
  s.say_gone(s.engagement.user(), s.engagement.locked());
  s.engagement.release();
  s.start_over();
  return {s.events.data(), s.event_count};
}

void Pipeline::halt() noexcept {
  state_->navigator.hold();
}

void Pipeline::capture_rest() noexcept {
  state_->navigator.start_over();
}

void Pipeline::set_navigation(const NavigationOptions& options) noexcept {
  state_->navigator.set_options(options);
}

const NavigationOptions& Pipeline::navigation_options() const noexcept {
  return state_->navigator.options();
}

const RestEstimator& Pipeline::rest() const noexcept {
  return state_->navigator.rest();
}

}  // namespace armature
