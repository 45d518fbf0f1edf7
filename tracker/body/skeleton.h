#pragma once

#include <array>
#include <cstdint>

#include <Eigen/Core>

#include "tracker/body/body_parts.h"

namespace armature {

enum class JointState : std::uint8_t {
  Lost,      ///< no idea; the position is the last one known
  Inferred,  ///< from neighbours, the past or the body's proportions
  Observed,  ///< from this frame's pixels
};

struct Joint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< metres, camera frame (x right, y down, z forward)
  float confidence = 0;                                ///< in [0, 1]
  JointState state = JointState::Lost;
};

/// One person's joints at one moment, and the user position P: the centre of mass of the torso's visible pixels.
struct Skeleton {
  std::array<Joint, kJointCount> joints{};
  Eigen::Vector3f user_position = Eigen::Vector3f::Zero();  ///< metres, camera frame

  [[nodiscard]] const Joint& operator[](JointId id) const noexcept { return joints[index(id)]; }
  [[nodiscard]] Joint& operator[](JointId id) noexcept { return joints[index(id)]; }
};

/// The same in a mirror: x changes its sign, left and right their places.
[[nodiscard]] inline Skeleton mirrored(const Skeleton& skeleton) noexcept {
  Skeleton out;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    out.joints[j] = skeleton[mirrored(static_cast<JointId>(j))];
    out.joints[j].position.x() *= -1;
  }
  out.user_position = {-skeleton.user_position.x(), skeleton.user_position.y(), skeleton.user_position.z()};
  return out;
}

}  // namespace armature
