#include "tools/tracking/frame_json.h"

#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "tools/output_file.h"

namespace armature::tools {
namespace {

constexpr std::array<std::string_view, 3> kStateNames = {"lost", "inferred", "observed"};

Json xyz(const Eigen::Vector3f& v) {
  return Json::array({number(v.x()), number(v.y()), number(v.z())});
}

std::optional<Eigen::Vector3f> vector_of(const Json& array) {
  if (!array.is_array() || array.size() != 3) return std::nullopt;
  Eigen::Vector3f v;
  for (int i = 0; i < 3; ++i) {
    if (!array[static_cast<std::size_t>(i)].is_number()) return std::nullopt;
    v[i] = array[static_cast<std::size_t>(i)].get<float>();
  }
  return v.allFinite() && v.norm() < 1000 ? std::optional(v) : std::nullopt;
}

std::string joined(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}

std::optional<std::string> difference(const Json& here, const Json& there, const std::string& path) {
  if (here.is_object() && there.is_object()) {
    for (const auto& [key, value] : here.items()) {
      if (!there.contains(key)) return joined(path, key) + ": missing there";
      if (auto found = difference(value, there[key], joined(path, key))) return found;
    }
    for (const auto& [key, value] : there.items()) {
      if (!here.contains(key)) return joined(path, key) + ": missing here";
    }
    return std::nullopt;
  }
  if (here.is_array() && there.is_array() && here.size() == there.size()) {
    for (std::size_t i = 0; i < here.size(); ++i) {
      if (auto found = difference(here[i], there[i], fmt::format("{}[{}]", path, i))) return found;
    }
    return std::nullopt;
  }
  if (here == there) return std::nullopt;
  return fmt::format("{}: {} here, {} there", path, here.dump(), there.dump());
}

}  // namespace

Json frame_json(const TrackerOutput& output, std::uint64_t frame, std::chrono::nanoseconds since_start, bool timings) {
  Json line;
  line["frame"] = frame;
  line["time_s"] = number(std::chrono::duration<double>(since_start).count());
  line["tracking"] = output.tracking;
  line["user"] = output.user;
  line["user_position"] = xyz(output.skeleton.user_position);
  Json& joints = line["joints"] = Json::object();
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const Joint& joint = output.skeleton.joints[j];
    joints[std::string(kJointNames[j])] = {{"xyz", xyz(joint.position)},
                                           {"confidence", number(joint.confidence)},
                                           {"state", kStateNames[static_cast<std::size_t>(joint.state)]}};
  }
  Json& motions = line["motions"] = Json::object();
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    const MotionOutput& motion = output.navigation.motions[m];
    motions[std::string(kMotionNames[m])] = {{"angle_rad", number(motion.angle_rad)},
                                             {"normalized", number(motion.normalized)},
                                             {"shaped", number(motion.shaped)}};
  }
  line["walk"] = number(output.navigation.walk);
  line["turn"] = number(output.navigation.turn);
  line["linear_m_s"] = number(output.navigation.velocity.linear_m_s);
  line["angular_rad_s"] = number(output.navigation.velocity.angular_rad_s);
  if (timings) {
    Json& stages = line["stage_us"] = Json::object();
    for (std::size_t s = 0; s < kStageCount; ++s) {
      stages[std::string(kStageNames[s])] =
          number(std::chrono::duration<double, std::micro>(output.stage_time[s]).count());
    }
  }
  return line;
}

std::optional<std::string> first_difference(const Json& here, const Json& there) {
  return difference(here, there, "");
}

Expected<RestPose> read_rest(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return fail(path.string() + ": no such rest pose; --rest takes auto, first:N or a file written by --save-rest");
  }
  std::ifstream in(path, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    return fail(path.string() + ": not a rest pose: expected a JSON object");
  const auto vector_at = [&](const Json& object, const std::string& key) -> Expected<Eigen::Vector3f> {
    if (object.is_object() && object.contains(key)) {
      if (const auto v = vector_of(object[key])) return *v;
    }
    return fail(fmt::format("{}: {}: expected [x, y, z] in metres", path.string(), key));
  };

  Skeleton skeleton;
  const Json joints = json.value("joints", Json::object());
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto position = vector_at(joints, std::string(kJointNames[j]));
    if (!position) return tl::unexpected(position.error());
    skeleton.joints[j] = {.position = *position, .confidence = 1, .state = JointState::Observed};
  }
  const auto user_position = vector_at(json, "user_position");
  if (!user_position) return tl::unexpected(user_position.error());
  skeleton.user_position = *user_position;
  const auto up = vector_at(json, "up");
  if (!up) return tl::unexpected(up.error());
  if (up->norm() < 0.5F) return fail(path.string() + ": up: expected a unit vector");
  return RestPose{skeleton, user_frame(skeleton, up->normalized())};
}

Expected<void> write_rest(const std::filesystem::path& path, const RestPose& rest) {
  Json json;
  json["up"] = xyz(rest.frame.up);
  json["user_position"] = xyz(rest.skeleton.user_position);
  Json& joints = json["joints"] = Json::object();
  for (std::size_t j = 0; j < kJointCount; ++j) {
    joints[std::string(kJointNames[j])] = xyz(rest.skeleton.joints[j].position);
  }
  return write_file(path.string(), json.dump(2) + '\n');
}

}  // namespace armature::tools
