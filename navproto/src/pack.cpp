#include "navproto/src/wire.h"

namespace armature::navproto {
namespace {

template <class To, class From>
constexpr To as(From value) noexcept {
  return static_cast<To>(value);
}

wire::Vec3 pack(const Vec3& v) {
  return {v.x, v.y, v.z};
}

wire::FrameTimes pack(const FrameTimes& times) {
  return {times.frame,
          times.sensor.count(),
          times.received.count(),
          times.published.count(),
          as<wire::SensorClock>(times.sensor_clock),
          0,
          0,
          0};
}

flatbuffers::Offset<wire::Settings> pack(Builder& builder, const ControlSettings& settings) {
  std::array<flatbuffers::Offset<wire::MotionSetting>, kMotionCount> entries{};
  assert(settings.motions.size() <= entries.size());
  for (std::size_t i = 0; i < settings.motions.size(); ++i) {
    const MotionSetting& motion = settings.motions[i];
    wire::MotionSettingBuilder entry(builder);
    entry.add_motion(as<wire::Motion>(motion.motion));
    if (motion.range_rad) entry.add_range_rad(*motion.range_rad);
    if (motion.alpha) entry.add_alpha(*motion.alpha);
    if (motion.beta) entry.add_beta(*motion.beta);
    entries[i] = entry.Finish();
  }
  const auto motions = builder.CreateVector(entries.data(), settings.motions.size());
  wire::SettingsBuilder body(builder);
  if (settings.turn_motion) body.add_turn_motion(as<wire::Motion>(*settings.turn_motion));
  if (settings.walk_motion) body.add_walk_motion(as<wire::Motion>(*settings.walk_motion));
  if (settings.max_walk_m_s) body.add_max_walk_m_s(*settings.max_walk_m_s);
  if (settings.max_turn_rad_s) body.add_max_turn_rad_s(*settings.max_turn_rad_s);
  if (settings.walk_acceleration_m_s2) body.add_walk_acceleration_m_s2(*settings.walk_acceleration_m_s2);
  if (settings.turn_acceleration_rad_s2) body.add_turn_acceleration_rad_s2(*settings.turn_acceleration_rad_s2);
  body.add_motions(motions);
  return body.Finish();
}

}  // namespace

wire::Header pack(const Header& header) {
  return {header.session_id, header.sequence, header.sent.count(), header.replayed, 0, 0, 0};
}

flatbuffers::Offset<wire::Navigation> pack(Builder& builder, const NavigationMessage& message) {
  std::array<wire::MotionValue, kMotionCount> values;
  for (std::size_t i = 0; i < kMotionCount; ++i) {
    const MotionValue& motion = message.motions[i];
    values[i] = {motion.angle_rad, motion.normalised, motion.shaped, motion.confidence};
  }
  const auto motions = builder.CreateVectorOfStructs(values.data(), values.size());
  const auto stage_us = builder.CreateVector(message.stage_us.data(), message.stage_us.size());
  const wire::FrameTimes times = pack(message.times);
  return wire::CreateNavigation(builder, &times, message.user_id, as<wire::Engagement>(message.engagement),
                                as<wire::StopReason>(message.stop_reason), message.velocity.linear_m_s,
                                message.velocity.angular_rad_s, message.walk, message.turn,
                                as<wire::Motion>(message.walk_motion), as<wire::Motion>(message.turn_motion), motions,
                                stage_us);
}

flatbuffers::Offset<wire::Skeleton> pack(Builder& builder, const SkeletonMessage& message) {
  std::array<wire::JointValue, kJointCount> values;
  for (std::size_t i = 0; i < kJointCount; ++i) {
    const JointValue& joint = message.joints[i];
    values[i] = {pack(joint.position), joint.confidence, as<wire::JointState>(joint.state), 0, 0};
  }
  const auto joints = builder.CreateVectorOfStructs(values.data(), values.size());
  const wire::FrameTimes times = pack(message.times);
  const wire::Vec3 position = pack(message.user_position);
  const wire::Vec3 up = pack(message.user_up);
  const wire::Vec3 left = pack(message.user_left);
  const wire::Vec3 forward = pack(message.user_forward);
  return wire::CreateSkeleton(builder, &times, message.user_id, message.tracking, joints, &position, &up, &left,
                              &forward);
}

flatbuffers::Offset<wire::Event> pack(Builder& builder, const EventMessage& message) {
  const auto text = builder.CreateString(message.text.data(), message.text.size());
  return wire::CreateEvent(builder, as<wire::EventKind>(message.kind), message.time.count(), message.user_id, text);
}

flatbuffers::Offset<wire::Health> pack(Builder& builder, const HealthMessage& message) {
  const auto version = builder.CreateString(message.version.data(), message.version.size());
  const auto source = builder.CreateString(message.source.data(), message.source.size());
  const auto trouble = message.source_trouble.empty() ? flatbuffers::Offset<flatbuffers::String>()
                                                      : builder.CreateString(message.source_trouble);
  return wire::CreateHealth(builder, message.time.count(), message.uptime_s, version, source, message.source_alive,
                            message.frames_received, message.frames_dropped, message.frames_processed,
                            message.frames_per_second, message.latency_p50_us, message.latency_p99_us,
                            message.resident_bytes, trouble);
}

flatbuffers::Offset<wire::Feed> pack(Builder& builder, const FeedView& view, std::span<const std::uint8_t> depth_zstd,
                                     std::span<const std::uint8_t> user_mask_zstd) {
  const auto depth = builder.CreateVector(depth_zstd.data(), depth_zstd.size());
  const auto mask = builder.CreateVector(user_mask_zstd.data(), user_mask_zstd.size());
  const wire::FrameTimes times = pack(view.times);
  const FeedIntrinsics& intrinsics = view.intrinsics;
  return wire::CreateFeed(builder, &times, as<std::uint16_t>(intrinsics.width), as<std::uint16_t>(intrinsics.height),
                          intrinsics.focal_x_px, intrinsics.focal_y_px, intrinsics.centre_x_px, intrinsics.centre_y_px,
                          depth, mask);
}

flatbuffers::Offset<wire::Request> pack(Builder& builder, const ControlRequest& message) {
  const auto settings = pack(builder, message.settings);
  return wire::CreateRequest(builder, message.id, as<wire::RequestKind>(message.kind), settings);
}

flatbuffers::Offset<wire::Reply> pack(Builder& builder, const ControlReply& message) {
  const auto error = builder.CreateString(message.error.data(), message.error.size());
  const auto settings = pack(builder, message.settings);
  const auto health = pack(builder, message.health);
  return wire::CreateReply(builder, message.id, error, as<wire::Engagement>(message.engagement), message.user_id,
                           settings, health);
}

}  // namespace armature::navproto
