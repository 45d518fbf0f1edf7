#include "tools/commands/listen_json.h"

namespace armature::tools {
namespace {

Json begin(const char* type, const navproto::Header& header) {
  return {{"type", type}, {"session", header.session_id}, {"sequence", header.sequence}, {"replayed", header.replayed}};
}

void add_times(Json& json, const navproto::FrameTimes& times) {
  json["frame"] = times.frame;
  json["sensor_ns"] = times.sensor.count();
  json["sensor_clock"] = navproto::name(times.sensor_clock);
  json["received_ns"] = times.received.count();
  json["published_ns"] = times.published.count();
}

Json point(const navproto::Vec3& v) {
  return Json::array({number(v.x), number(v.y), number(v.z)});
}

}  // namespace

Json to_json(const navproto::NavigationMessage& message) {
  Json json = begin("navigation", message.header);
  add_times(json, message.times);
  json["user"] = message.user_id;
  json["engagement"] = navproto::name(message.engagement);
  json["stop_reason"] = navproto::name(message.stop_reason);
  json["walk"] = number(message.walk);
  json["turn"] = number(message.turn);
  json["linear_m_s"] = number(message.velocity.linear_m_s);
  json["angular_rad_s"] = number(message.velocity.angular_rad_s);
  json["walk_motion"] = navproto::name(message.walk_motion);
  json["turn_motion"] = navproto::name(message.turn_motion);
  Json& motions = json["motions"];
  for (std::size_t m = 0; m < navproto::kMotionCount; ++m) {
    const auto& value = message.motions[m];
    motions[std::string(navproto::kMotionNames[m])] = {{"angle_rad", number(value.angle_rad)},
                                                       {"normalized", number(value.normalised)},
                                                       {"shaped", number(value.shaped)},
                                                       {"confidence", number(value.confidence)}};
  }
  Json& stages = json["stage_us"];
  for (std::size_t s = 0; s < navproto::kStageCount; ++s) {
    stages[std::string(navproto::kStageNames[s])] = number(message.stage_us[s]);
  }
  return json;
}

Json to_json(const navproto::SkeletonMessage& message) {
  Json json = begin("skeleton", message.header);
  add_times(json, message.times);
  json["user"] = message.user_id;
  json["tracking"] = message.tracking;
  json["user_position"] = point(message.user_position);
  json["user_up"] = point(message.user_up);
  json["user_left"] = point(message.user_left);
  json["user_forward"] = point(message.user_forward);
  Json& joints = json["joints"];
  for (std::size_t j = 0; j < navproto::kJointCount; ++j) {
    const auto& joint = message.joints[j];
    joints[std::string(navproto::kJointNames[j])] = {{"xyz", point(joint.position)},
                                                     {"confidence", number(joint.confidence)},
                                                     {"state", navproto::name(joint.state)}};
  }
  return json;
}

Json to_json(const navproto::EventMessage& message) {
  Json json = begin("event", message.header);
  json["event"] = navproto::name(message.kind);
  json["time_ns"] = message.time.count();
  json["user"] = message.user_id;
  json["text"] = message.text;
  return json;
}

Json to_json(const navproto::HealthMessage& message) {
  Json json = begin("health", message.header);
  json["time_ns"] = message.time.count();
  json["uptime_s"] = number(message.uptime_s);
  json["version"] = message.version;
  json["source"] = message.source;
  json["source_alive"] = message.source_alive;
  json["source_trouble"] = message.source_trouble;
  json["frames_received"] = message.frames_received;
  json["frames_dropped"] = message.frames_dropped;
  json["frames_processed"] = message.frames_processed;
  json["frames_per_second"] = number(message.frames_per_second);
  json["latency_p50_us"] = number(message.latency_p50_us);
  json["latency_p99_us"] = number(message.latency_p99_us);
  json["resident_bytes"] = message.resident_bytes;
  return json;
}

}  // namespace armature::tools
