#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "tools/json_lines.h"
#include "tracker/pipeline.h"

namespace armature::tools {

/// What `armature replay --json` says of one frame: every key always there, numbers zero before the rest pose.
/// Lengths in metres, camera frame x right, y down, z forward; angles in radians. `stage_us` only with timings, since
/// those differ from run to run.
[[nodiscard]] Json frame_json(const TrackerOutput& output, std::uint64_t frame, std::chrono::nanoseconds since_start,
                              bool timings);

/// Where two JSON values differ first, in the order of the first one: `joints.head.xyz[0]: 0.12 here, 0.13 there`.
/// Nothing where they are equal.
[[nodiscard]] std::optional<std::string> first_difference(const Json& here, const Json& there);

/// A rest pose as a JSON file: joints, user position and the floor's normal.
[[nodiscard]] Expected<RestPose> read_rest(const std::filesystem::path& path);
[[nodiscard]] Expected<void> write_rest(const std::filesystem::path& path, const RestPose& rest);

}  // namespace armature::tools
