#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "firmware_host/depth_frame.h"
#include "firmware_host/error.h"

namespace armature {

/// What an `.oni` file has no place for. It travels in `FILE.oni.toml` beside the recording.
struct RecordingFacts {
  Intrinsics intrinsics;
  double frames_per_second = 30;  ///< nominal; the recording itself holds a whole number
  std::string origin;             ///< where the frames came from, for people

  friend bool operator==(const RecordingFacts&, const RecordingFacts&) = default;
};

[[nodiscard]] std::filesystem::path sidecar_path(const std::filesystem::path& recording);

/// The text of a side-car; format_sidecar and parse_sidecar are each other's inverse, to the last bit.
[[nodiscard]] std::string format_sidecar(const RecordingFacts& facts);

/// `name` opens the message of every failure: an unknown or missing key, a wrong type, a value out of range, each with
/// its line.
[[nodiscard]] Expected<RecordingFacts> parse_sidecar(std::string_view text, std::string_view name);

[[nodiscard]] Expected<RecordingFacts> read_sidecar(const std::filesystem::path& path);

}  // namespace armature
