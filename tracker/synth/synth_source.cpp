#include "tracker/synth/synth_source.h"

#include <algorithm>
#include <cmath>

#include "tracker/body/kinematics.h"
#include "tracker/synth/wheelchair.h"

namespace armature {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Streams of random numbers that one seed gives.
enum class Stream : std::uint64_t { Person = 1, Room, Camera, Habits, Noise };
std::uint64_t stream(std::uint64_t seed, Stream which, std::uint64_t number = 0) {
  return scrambled(scrambled(seed) ^ (static_cast<std::uint64_t>(which) << 32) ^ number) | (seed & kHeldOut);
}

/// The height at which the camera looks: the middle of the user, or higher where she is so near that not all of her is
/// in view, so that her head is.
double looked_at(double stature, double distance) {
  constexpr double kHalfView = 0.42, kAboveHead_m = 0.12;
  const double middle = 0.48 * stature;
  return distance > 1.4 * stature ? middle : std::max(middle, stature + kAboveHead_m - kHalfView * distance);
}

}  // namespace

SynthSource::SynthSource(const Script& script, const SynthOptions& synth, const OpenOptions& options)
    : script_(script), synth_(synth), clock_(options.clock), pacer_(options) {
  info_.intrinsics = kinect_intrinsics(synth_.width, synth_.height);
  info_.frames_per_second = synth_.fps;
  info_.frame_count = std::lround(script_.duration_s * synth_.fps);
  place_actors();
  calibrate();
}

void SynthSource::place_actors() {
  Random room_random(stream(synth_.seed, Stream::Room));
  Random camera_random(stream(synth_.seed, Stream::Camera));
  for (std::size_t i = 0; i < script_.actors.size(); ++i) {
    Random random(stream(synth_.seed, Stream::Person, i));
    Person person = random_person(random, i == 0 ? synth_.wish : PersonWish{});
    if (i == 0) {
      person.outfit.bag = synth_.carry;
      person.outfit.bag_side = synth_.carry_side;
      const double slack = camera_random.uniform(0.1, 0.5);
      const double distance = synth_.distance_m > 0 ? synth_.distance_m : 1.40 * person.shape.stature + slack;
      const double height = camera_random.uniform(0.7, 1.8);
      const double tilt = std::atan2(height - looked_at(person.shape.stature, distance), distance);
      camera_from_world_ = camera_from_world(height, on_grid(tilt), 0.01 * camera_random.normal());
      where_ = world_from_body(0, distance, synth_.turned_deg * (3.14159265358979323846 / 180));
      place_room(room_random, person.shape.stature, distance, height);
    }
    // Only the user is turned away; the others keep to their paths in the room.
    const RigidTransform where = i == 0 ? where_ : RigidTransform{Eigen::Matrix3d::Identity(), where_.translation};
    actors_.emplace_back(person, script_.actors[i], where, stream(synth_.seed, Stream::Habits, i));
    place_seat(actors_.back(), script_.actors[i].posture, where);
  }
}

void SynthSource::place_room(Random& random, double stature, double distance, double camera_height) {
  Room room = random_room(random, 1.1, distance + 1.1);
  if (!synth_.furnished) room.furniture.clear();
  if (synth_.occluded > 0) {
    // What hides a share of her lies on the lines from the camera through the end of that share.
    const double before = std::max(0.8, distance - 0.75);
    const double nearer = before / distance;
    constexpr double kHalfDepth = 0.15;
    if (synth_.occluded_below) {
      const double hidden = synth_.occluded * stature;
      const double half_height = 0.5 * std::max(0.1, camera_height + (hidden - camera_height) * nearer);
      room.furniture.push_back(
          {{Eigen::Matrix3d::Identity(), {0, half_height, -before}}, {0.7, half_height, kHalfDepth}});
    } else {
      const double half_body = 0.15 * stature, side = random.sign(), half_width = 0.2;
      const double edge = half_body * (1 - 2 * synth_.occluded) * nearer;
      room.furniture.push_back({{Eigen::Matrix3d::Identity(), {side * (edge + half_width), 0.5 * stature, -before}},
                                {half_width, 0.5 * stature, kHalfDepth}});
    }
  }
  empty_room_.reset(info_.intrinsics);
  render_room(room, camera_from_world_, empty_room_);
}

void SynthSource::place_seat(const Actor& actor, Posture posture, const RigidTransform& where) {
  if (posture == Posture::Chair) {
    const RigidTransform under = where * RigidTransform{Eigen::Matrix3d::Identity(), Vector3d(0, 0, 0.06)};
    render_boxes(chair(under, actor.seat_height(), 0.23, 0.45), camera_from_world_, empty_room_);
  } else if (posture == Posture::Wheelchair) {
    const RigidTransform camera_from_chair = camera_from_world_ * where;
    wheelchair(actor.seat_height(), actor.person().shape.thigh, edges_);
    for (SurfaceEdge& edge : edges_) edge = moved(edge, camera_from_chair.rotation, camera_from_chair.translation);
    render_edges(edges_, 0, empty_room_);
  }
}

Skeleton SynthSource::true_skeleton(const PosedBody& body, const RigidTransform& camera_from_body) const {
  Skeleton skeleton;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    skeleton.joints[j] = {(camera_from_body * body.joints[j]).cast<float>(), 1, JointState::Observed};
  }
  return skeleton;
}

void SynthSource::render_actor(const Actor& actor, const Pose& pose, const RigidTransform& world_from_body,
                               std::uint8_t owner) {
  const Person& person = actor.person();
  const RigidTransform camera_from_body = camera_from_world_ * world_from_body;
  body_surface(person.shape, pose_body(person.shape, pose), person.outfit, edges_);
  for (SurfaceEdge& edge : edges_) edge = moved(edge, camera_from_body.rotation, camera_from_body.translation);
  render_edges(edges_, owner, image_);
}

Vector3f SynthSource::torso_centre() const {
  const Intrinsics& k = image_.intrinsics;
  Vector3d sum = Vector3d::Zero();
  long count = 0;
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
      if (image_.owner[pixel] != 1 || image_.part[pixel] == kNoPart) continue;
      if (!is_torso(static_cast<PartLabel>(image_.part[pixel]))) continue;
      const auto z = static_cast<double>(image_.depth_m[pixel]);
      sum += Vector3d((u - k.centre_x_px) / k.focal_x_px * z, (v - k.centre_y_px) / k.focal_y_px * z, z);
      ++count;
    }
  }
  return count > 0 ? Vector3f((sum / static_cast<double>(count)).cast<float>()) : Vector3f(Vector3f::Zero());
}

void SynthSource::calibrate() {
  Actor& user = actors_.front();
  const BodyShape& shape = user.person().shape;
  const RigidTransform world_from_user = user.world_from_body_at(script_.rest_s);
  const RigidTransform camera_from_user = camera_from_world_ * world_from_user;
  image_.reset(info_.intrinsics);
  render_actor(user, user.resting(), world_from_user, 1);
  rest_.skeleton = true_skeleton(pose_body(shape, user.resting()), camera_from_user);
  rest_.skeleton.user_position = torso_centre();
  rest_.frame = user_frame(rest_.skeleton, camera_from_world_.rotation.col(1).cast<float>());

  for (std::size_t m = 0; m < kMotionCount; ++m) {
    const auto motion = static_cast<MotionId>(m);
    const auto range = static_cast<double>(motion_options_.range_rad[m]);
    MotionCalibration calibration;
    for (int i = 0; i < 9; ++i) {
      const double amount = 0.4 * (i - 4) * range;
      const Skeleton performed = true_skeleton(pose_body(shape, user.performing(motion, amount)), camera_from_user);
      const auto at = static_cast<std::size_t>(i);
      calibration.amounts[at] = amount;
      calibration.values[at] = static_cast<double>(motion_angles(performed, rest_).angle_rad[m]) / range;
    }
    user.set_calibration(motion, calibration);
  }
}

void SynthSource::judge_visibility() {
  const Intrinsics& k = info_.intrinsics;
  for (Joint& joint : truth_.skeleton.joints) {
    const Vector3f& p = joint.position;
    joint.state = JointState::Inferred;
    if (p.z() < static_cast<float>(kNearest)) continue;
    const auto u = std::lround(k.centre_x_px + k.focal_x_px * static_cast<double>(p.x() / p.z()));
    const auto v = std::lround(k.centre_y_px + k.focal_y_px * static_cast<double>(p.y() / p.z()));
    if (u < 0 || v < 0 || u >= k.width || v >= k.height) continue;
    const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
    // Seen where the surface before the joint is the user's and no farther before it than her body is thick.
    constexpr float kThickness = 0.2F;
    if (image_.owner[pixel] == 1 && p.z() - image_.depth_m[pixel] < kThickness) joint.state = JointState::Observed;
  }
}

Expected<ReadStatus> SynthSource::read(DepthFrame& frame, std::chrono::milliseconds timeout) {
  if (next_frame_ >= info_.frame_count) return ReadStatus::EndOfStream;
  const double time_s = static_cast<double>(next_frame_) / synth_.fps;
  const std::chrono::nanoseconds time(std::llround(time_s * 1e9));
  if (!pacer_.wait_until_due(time, timeout)) return ReadStatus::Timeout;

  image_ = empty_room_;
  truth_ = FrameTruth{};
  for (std::size_t i = actors_.size(); i-- > 0;) {
    const Actor& actor = actors_[i];
    if (!actor.present(time_s)) continue;
    const Pose pose = actor.pose_at(time_s);
    const RigidTransform world_from_body = actor.world_from_body_at(time_s);
    render_actor(actor, pose, world_from_body, static_cast<std::uint8_t>(i + 1));
    if (i == 0) {
      truth_.present = true;
      truth_.skeleton = true_skeleton(pose_body(actor.person().shape, pose), camera_from_world_ * world_from_body);
    }
  }
  if (truth_.present) {
    truth_.skeleton.user_position = torso_centre();
    judge_visibility();
    truth_.motions = motion_angles(truth_.skeleton, rest_);
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      truth_.normalized[m] = std::clamp(truth_.motions.angle_rad[m] / motion_options_.range_rad[m], -1.0F, 1.0F);
    }
  }

  sensor_.sense(image_, {.strength = synth_.noise},
                stream(synth_.seed, Stream::Noise, static_cast<std::uint64_t>(next_frame_) + 1),
                stream(synth_.seed, Stream::Noise), sensed_);
  const std::size_t count = sensed_.source.size();
  part_.resize(count);
  owner_.resize(count);
  for (std::size_t pixel = 0; pixel < count; ++pixel) {
    const bool seen = sensed_.depth_mm[pixel] != 0;
    owner_[pixel] = seen ? image_.owner[sensed_.source[pixel]] : std::uint8_t{0};
    part_[pixel] = owner_[pixel] == 1 ? image_.part[sensed_.source[pixel]] : kNoPart;
  }
  truth_.part = part_;
  truth_.owner = owner_;

  frame.depth_mm = sensed_.depth_mm;
  frame.intrinsics = info_.intrinsics;
  frame.sequence = static_cast<std::uint64_t>(next_frame_);
  frame.sensor = {time, ClockId::Synthetic};
  frame.host = {clock_->now(), ClockId::HostMonotonic};
  ++next_frame_;
  return ReadStatus::Frame;
}

}  // namespace armature
