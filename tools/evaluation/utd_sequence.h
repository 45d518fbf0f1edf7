#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "firmware_host/depth_frame.h"
#include "firmware_host/error.h"

namespace armature::tools {

/// The joints of the Kinect SDK, in the order of the files of UTD-MHAD (Chen, Jafari and Kehtarnavaz 2015).
enum class SdkJoint : std::uint8_t {
  Head,
  ShoulderCenter,
  Spine,
  HipCenter,
  LeftShoulder,
  LeftElbow,
  LeftWrist,
  LeftHand,
  RightShoulder,
  RightElbow,
  RightWrist,
  RightHand,
  LeftHip,
  LeftKnee,
  LeftAnkle,
  LeftFoot,
  RightHip,
  RightKnee,
  RightAnkle,
  RightFoot,
};
inline constexpr std::size_t kSdkJointCount = 20;
using SdkJoints = std::array<Eigen::Vector3f, kSdkJointCount>;  ///< metres, camera frame

/// A recorded person whose background was removed: every pixel with a depth is hers.
struct UtdSequence {
  std::string name;  ///< aA_sS_tT
  int action = 0;
  int person = 0;
  Intrinsics intrinsics;
  std::vector<std::uint16_t> depth_mm;  ///< [frame][height][width]
  std::vector<SdkJoints> joints;        ///< [frame]

  [[nodiscard]] std::size_t frame_count() const noexcept { return joints.size(); }
  [[nodiscard]] std::span<const std::uint16_t> frame(std::size_t i) const noexcept;
};

/// The names of all sequences in a folder, in the order of the alphabet.
[[nodiscard]] Expected<std::vector<std::string>> list_utd_sequences(const std::filesystem::path& folder);

/// Reads NAME.u16.zst (zstd of uint16 little-endian [frame][240][320]) and NAME.joints.csv (a header line, then the
/// frame's number and x, y, z of 20 joints).
[[nodiscard]] Expected<UtdSequence> read_utd_sequence(const std::filesystem::path& folder, const std::string& name);

}  // namespace armature::tools
