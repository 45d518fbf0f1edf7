#include <bit>
#include <cstring>

#include <zstd.h>

#include "navproto/src/wire.h"

namespace armature::navproto {
namespace {

static_assert(std::endian::native == std::endian::little, "the feed's depth travels in little-endian order");

std::chrono::nanoseconds nanoseconds(std::int64_t count) {
  return std::chrono::nanoseconds(count);
}

Vec3 unpack(const wire::Vec3& v) {
  return {v.x(), v.y(), v.z()};
}

FrameTimes unpack(const wire::FrameTimes& times) {
  return {times.frame(), nanoseconds(times.sensor_ns()), static_cast<SensorClock>(times.sensor_clock()),
          nanoseconds(times.received_ns()), nanoseconds(times.published_ns())};
}

template <class T>
std::optional<T> optional_of(const flatbuffers::Optional<T>& value) {
  return value.has_value() ? std::optional<T>(*value) : std::nullopt;
}

std::optional<MotionId> optional_of(const flatbuffers::Optional<wire::Motion>& value) {
  return value.has_value() ? std::optional(static_cast<MotionId>(*value)) : std::nullopt;
}

Expected<ControlSettings> unpack_settings(const wire::Settings* body) {
  ControlSettings settings;
  if (body == nullptr) return settings;
  settings.turn_motion = optional_of(body->turn_motion());
  settings.walk_motion = optional_of(body->walk_motion());
  settings.max_walk_m_s = optional_of(body->max_walk_m_s());
  settings.max_turn_rad_s = optional_of(body->max_turn_rad_s());
  settings.walk_acceleration_m_s2 = optional_of(body->walk_acceleration_m_s2());
  settings.turn_acceleration_rad_s2 = optional_of(body->turn_acceleration_rad_s2());
  if (body->motions() == nullptr) return settings;
  if (body->motions()->size() > kMotionCount) return fail("settings.motions: more entries than motions");
  for (const wire::MotionSetting* motion : *body->motions()) {
    settings.motions.push_back({static_cast<MotionId>(motion->motion()), optional_of(motion->range_rad()),
                                optional_of(motion->alpha()), optional_of(motion->beta())});
  }
  return settings;
}

/// Fills `plane` from a zstd frame that says it holds exactly that many bytes.
template <class Pixel>
bool decompress(const flatbuffers::Vector<std::uint8_t>& zstd, std::size_t count, std::vector<Pixel>& plane) {
  const std::size_t bytes = count * sizeof(Pixel);
  if (ZSTD_getFrameContentSize(zstd.data(), zstd.size()) != bytes) return false;
  plane.resize(count);
  return ZSTD_decompress(plane.data(), bytes, zstd.data(), zstd.size()) == bytes;
}

}  // namespace

Header unpack(const wire::Header& header) {
  return {header.session_id(), header.sequence(), nanoseconds(header.sent_ns()), header.replayed()};
}

Expected<NavigationMessage> unpack(const wire::Navigation& body) {
  if (body.motions()->size() != kMotionCount) return fail("motions: not one for each motion");
  if (body.stage_us()->size() != kStageCount) return fail("stage_us: not one for each stage");
  NavigationMessage message;
  message.times = unpack(*body.times());
  message.user_id = body.user_id();
  message.engagement = static_cast<Engagement>(body.engagement());
  message.stop_reason = static_cast<StopReason>(body.stop_reason());
  message.velocity = {body.linear_m_s(), body.angular_rad_s()};
  message.walk = body.walk();
  message.turn = body.turn();
  message.walk_motion = static_cast<MotionId>(body.walk_motion());
  message.turn_motion = static_cast<MotionId>(body.turn_motion());
  for (std::size_t i = 0; i < kMotionCount; ++i) {
    const wire::MotionValue& motion = *body.motions()->Get(static_cast<flatbuffers::uoffset_t>(i));
    message.motions[i] = {motion.angle_rad(), motion.normalised(), motion.shaped(), motion.confidence()};
  }
  for (std::size_t i = 0; i < kStageCount; ++i) {
    message.stage_us[i] = body.stage_us()->Get(static_cast<flatbuffers::uoffset_t>(i));
  }
  return message;
}

Expected<SkeletonMessage> unpack(const wire::Skeleton& body) {
  if (body.joints()->size() != kJointCount) return fail("joints: not one for each joint");
  SkeletonMessage message;
  message.times = unpack(*body.times());
  message.user_id = body.user_id();
  message.tracking = body.tracking();
  for (std::size_t i = 0; i < kJointCount; ++i) {
    const wire::JointValue& joint = *body.joints()->Get(static_cast<flatbuffers::uoffset_t>(i));
    message.joints[i] = {unpack(joint.position()), joint.confidence(), static_cast<JointState>(joint.state())};
  }
  message.user_position = unpack(*body.user_position());
  message.user_up = unpack(*body.user_up());
  message.user_left = unpack(*body.user_left());
  message.user_forward = unpack(*body.user_forward());
  return message;
}

Expected<EventMessage> unpack(const wire::Event& body) {
  EventMessage message;
  message.kind = static_cast<EventKind>(body.kind());
  message.time = nanoseconds(body.time_ns());
  message.user_id = body.user_id();
  message.text = body.text()->str();
  return message;
}

Expected<HealthMessage> unpack(const wire::Health& body) {
  HealthMessage message;
  message.time = nanoseconds(body.time_ns());
  message.uptime_s = body.uptime_s();
  message.version = body.version()->str();
  message.source = body.source()->str();
  message.source_alive = body.source_alive();
  message.frames_received = body.frames_received();
  message.frames_dropped = body.frames_dropped();
  message.frames_processed = body.frames_processed();
  message.frames_per_second = body.frames_per_second();
  message.latency_p50_us = body.latency_p50_us();
  message.latency_p99_us = body.latency_p99_us();
  message.resident_bytes = body.resident_bytes();
  if (body.source_trouble() != nullptr) message.source_trouble = body.source_trouble()->str();
  return message;
}

Expected<FeedMessage> unpack(const wire::Feed& body) {
  const int width = body.width();
  const int height = body.height();
  if (width < 1 || height < 1 || width > kMaxFeedSide || height > kMaxFeedSide) {
    return fail("image size " + std::to_string(width) + "x" + std::to_string(height) + ": sides must be from 1 to " +
                std::to_string(kMaxFeedSide));
  }
  FeedMessage message;
  message.times = unpack(*body.times());
  message.intrinsics = {width, height, body.focal_x_px(), body.focal_y_px(), body.centre_x_px(), body.centre_y_px()};
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  if (!decompress(*body.depth_zstd(), count, message.depth_mm)) return fail("depth: not an image of that size in zstd");
  if (!decompress(*body.user_mask_zstd(), count, message.user_mask)) {
    return fail("user mask: not an image of that size in zstd");
  }
  return message;
}

Expected<ControlRequest> unpack(const wire::Request& body) {
  auto settings = unpack_settings(body.settings());
  if (!settings) return tl::unexpected(std::move(settings).error());
  return ControlRequest{body.id(), static_cast<RequestKind>(body.kind()), *std::move(settings)};
}

Expected<ControlReply> unpack(const wire::Reply& body) {
  auto settings = unpack_settings(body.settings());
  if (!settings) return tl::unexpected(std::move(settings).error());
  ControlReply message;
  message.id = body.id();
  message.error = body.error()->str();
  message.engagement = static_cast<Engagement>(body.engagement());
  message.user_id = body.user_id();
  message.settings = *std::move(settings);
  if (body.health() != nullptr) message.health = *unpack(*body.health());
  return message;
}

}  // namespace armature::navproto
