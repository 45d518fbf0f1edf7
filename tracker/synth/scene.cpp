#include "tracker/synth/scene.h"

#include <cmath>

#include "tracker/body/rotation.h"

namespace armature {

using Eigen::Matrix3d;
using Eigen::Vector3d;

RigidTransform camera_from_world(double height, double tilt, double roll) {
  Matrix3d axes;  // a level camera's right, down and forward in the world
  axes << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  const double c = on_grid(std::cos(tilt)), s = on_grid(std::sin(tilt));
  // Looking down lifts what lies ahead towards the image's top: y' = c y - s z.
  const Matrix3d tilted{{1, 0, 0}, {0, c, -s}, {0, s, c}};
  const double cr = on_grid(std::cos(roll)), sr = on_grid(std::sin(roll));
  const Matrix3d rolled{{cr, sr, 0}, {-sr, cr, 0}, {0, 0, 1}};
  RigidTransform out;
  out.rotation = rolled * tilted * axes;
  out.translation = -(out.rotation * Vector3d(0, height, 0));
  return out;
}

RigidTransform world_from_body(double x, double distance, double heading) {
  return {turned_left(heading), Vector3d(x, 0, -distance)};
}

std::vector<Box> table(const RigidTransform& world_from_table, double height, double half_width, double half_depth) {
  std::vector<Box> boxes;
  const auto add = [&](const Vector3d& centre, const Vector3d& half) {
    boxes.push_back({world_from_table * RigidTransform{Matrix3d::Identity(), centre}, half});
  };
  add({0, height - 0.02, 0}, {half_width, 0.02, half_depth});
  for (const double sx : {-1.0, 1.0}) {
    for (const double sz : {-1.0, 1.0}) {
      add({sx * (half_width - 0.05), 0.5 * height, sz * (half_depth - 0.05)}, {0.025, 0.5 * height, 0.025});
    }
  }
  return boxes;
}

std::vector<Box> chair(const RigidTransform& world_from_chair, double seat_height, double half_width,
                       double back_height) {
  std::vector<Box> boxes = table(world_from_chair, seat_height, half_width, half_width);
  if (back_height > 0) {
    boxes.push_back(
        {world_from_chair * RigidTransform{Matrix3d::Identity(), {0, seat_height + 0.5 * back_height, -half_width}},
         {half_width, 0.5 * back_height, 0.02}});
  }
  return boxes;
}

Room random_room(Random& random, double clear_half_width, double clear_distance) {
  Room room;
  room.left = -random.uniform(1.6, 3.2);
  room.right = random.uniform(1.6, 3.2);
  room.back = random.uniform(std::max(3.6, clear_distance + 0.3), 6.0);
  room.height = random.uniform(2.4, 3.2);
  const int pieces = 2 + random.below(4);
  for (int i = 0; i < pieces; ++i) {
    const double side = random.sign();
    const double wall = side > 0 ? room.right : -room.left;
    const double half_width = random.uniform(0.2, 0.5), half_depth = random.uniform(0.2, 0.4);
    const double reach = std::sqrt(half_width * half_width + half_depth * half_depth);
    const bool behind = random.chance(0.4) && room.back > clear_distance + 2 * reach;
    const double x = behind ? random.uniform(room.left + reach, room.right - reach)
                            : side * random.uniform(clear_half_width + reach,
                                                    std::max(clear_half_width + reach + 0.05, wall - reach));
    const double distance =
        behind ? random.uniform(clear_distance + reach, room.back - reach) : random.uniform(1.5, room.back - reach);
    const RigidTransform placed = world_from_body(x, distance, random.uniform(-0.4, 0.4));
    std::vector<Box> boxes;
    switch (random.below(3)) {
      case 0: {
        const double height = random.uniform(0.5, 2.0);
        boxes.push_back({placed * RigidTransform{Matrix3d::Identity(), {0, 0.5 * height, 0}},
                         {half_width, 0.5 * height, half_depth}});
        break;
      }
      case 1: boxes = table(placed, random.uniform(0.45, 0.8), half_width, half_depth); break;
      default: {
        const double back = random.uniform(0.3, 0.55);
        boxes = chair(placed, random.uniform(0.4, 0.5), 0.22, back);
        break;
      }
    }
    room.furniture.insert(room.furniture.end(), boxes.begin(), boxes.end());
  }
  return room;
}

Intrinsics kinect_intrinsics(int width, int height) {
  const double focal = 571.26 * width / 640.0;
  return {width, height, focal, focal, 0.5 * width, 0.5 * height};
}

}  // namespace armature
