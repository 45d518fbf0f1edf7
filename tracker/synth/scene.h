#pragma once

#include <vector>

#include <Eigen/Core>

#include "firmware_host/depth_frame.h"
#include "tracker/synth/random.h"

namespace armature {

/// p_to = rotation p_from + translation.
struct RigidTransform {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return rotation * p + translation; }
  [[nodiscard]] RigidTransform operator*(const RigidTransform& first) const {
    return {rotation * first.rotation, rotation * first.translation + translation};
  }
};

/// World frame of synthetic scenes: origin on the floor below the camera, x to the camera's right, y up, z from the
/// scene towards the camera (a person who faces the camera has her left along +x). Metres.

/// A camera `height` above the floor, looking down by `tilt` (radians) and rolled clockwise by `roll`.
[[nodiscard]] RigidTransform camera_from_world(double height, double tilt, double roll = 0);

/// A body (its own frame, body/pose.h) that stands at `x`, `distance` before the camera, turned to its left by
/// `heading` from facing straight along +z.
[[nodiscard]] RigidTransform world_from_body(double x, double distance, double heading);

/// A box on the world's floor or anywhere above it.
struct Box {
  RigidTransform world_from_box;
  Eigen::Vector3d half_size;
};

struct Room {
  double left = -2.5, right = 2.5;  ///< walls, x
  double back = 4.5;                ///< wall, distance before the camera
  double front = 2;                 ///< wall behind the camera
  double height = 2.8;
  std::vector<Box> furniture;
};

/// A room with a few pieces of furniture (cupboards, tables, chairs) that leave the middle free: nothing within
/// `clear_half_width` of the line before the camera, from the camera to `clear_distance`.
[[nodiscard]] Room random_room(Random& random, double clear_half_width = 0.9, double clear_distance = 3.8);

/// The boxes of a chair (or, `back_height` 0, a stool) whose seat's centre is over the origin, facing +z.
[[nodiscard]] std::vector<Box> chair(const RigidTransform& world_from_chair, double seat_height, double half_width,
                                     double back_height);
/// The boxes of a table centred over the origin.
[[nodiscard]] std::vector<Box> table(const RigidTransform& world_from_table, double height, double half_width,
                                     double half_depth);

/// The nominal intrinsics of a Kinect v1 at this resolution (58.5 degrees across 640 pixels).
[[nodiscard]] Intrinsics kinect_intrinsics(int width, int height);

}  // namespace armature
