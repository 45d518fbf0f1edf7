#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "firmware_host/depth_source.h"

namespace armature {

/// `fakenect:DIR`: a dump that libfreenect's `fakenect-record` made of a Kinect v1. DIR/INDEX.txt names a file a line,
/// in the order of time; those called `d-SECONDS-TICKS.pgm` are depth: one header line `P5 640 480 65535`, then 640 x
/// 480 little-endian 16-bit values. The tool records the sensor's raw 11-bit values, which become millimetres here; a
/// dump whose first image holds values above 2047 is taken for one in millimetres. Other files (colour, accelerometer)
/// are passed over. Time is the host's time in the file names, from the first depth image on. The intrinsics are the
/// ones libfreenect projects with: focal length 575.8 px, centre (320, 240).
///
/// Read by ourselves, not by libfreenect's fakenect: that one ends the process when a file is missing.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_fakenect(const std::filesystem::path& directory,
                                                                   const OpenOptions& options);

/// Millimetres for the sensor's raw 11-bit values (libfreenect, registration.c, with its default calibration); 0 for
/// 2047, "no depth", and for what lies beyond 10 m.
[[nodiscard]] std::array<std::uint16_t, 2048> kinect_raw_to_mm();

/// Where one depth image of a dump lies: a name and its time.
struct FakenectEntry {
  std::string file;
  std::chrono::microseconds time{0};  ///< since the first depth image, never running backwards
};

/// The depth images that INDEX.txt names. `name` opens the message of every failure.
[[nodiscard]] Expected<std::vector<FakenectEntry>> parse_fakenect_index(std::string_view text, std::string_view name);

}  // namespace armature
