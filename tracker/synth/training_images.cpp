#include "tracker/synth/training_images.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracker/body/kinematics.h"
#include "tracker/synth/wheelchair.h"

namespace armature {
namespace {

using Eigen::Vector3d;

constexpr double kRadians = std::numbers::pi / 180;

/// A camera height and a tilt with which a person of this size at this distance is in view; her feet may be cut off
/// when she is near, as with a real sensor.
RigidTransform random_camera(double stature, double distance, double x, Random& random) {
  const double height = random.uniform(0.6, 2.0);
  const double look_at = random.uniform(0.42, 0.62) * stature;
  const double tilt = on_grid(std::atan2(height - look_at, std::hypot(distance, x)));
  const double roll = 0.02 * random.normal();
  return camera_from_world(height, tilt + 0.02 * random.normal(), roll);
}

/// Where somebody else stands, seen from the person: beside her, half before her or behind her, facing anywhere near
/// the camera.
RigidTransform company_place(Random& random) {
  const double side = random.sign();
  const double heading = random.uniform(-0.9, 0.9);
  double distance = 0, x = 0;
  switch (random.below(3)) {
    case 0: distance = random.uniform(-0.2, 0.2), x = random.uniform(0.45, 0.8); break;
    case 1: distance = -random.uniform(0.5, 0.9), x = random.uniform(0.25, 0.6); break;
    default: distance = random.uniform(0.5, 1.0), x = random.uniform(0, 0.7); break;
  }
  return world_from_body(side * x, distance, heading);
}

}  // namespace

void mask_with_ragged_feet(const SurfaceImage& image, const SensedImage& sensed, std::uint8_t owner,
                           const Vector3d& floor_up, double floor_offset, const std::array<Vector3d, 2>& feet,
                           std::uint64_t seed, std::vector<std::uint8_t>& mask) {
  const Intrinsics& k = image.intrinsics;
  mask.assign(image.depth_m.size(), 0);
  const int block = std::max(2, k.width / 80);
  const float low_until = static_cast<float>(0.05 * Random(seed).unit());
  const double floor_reach = 0.05 + 0.15 * Random(seed + 1).unit();
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const std::size_t pixel =
          static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
      if (sensed.depth_mm[pixel] == 0) continue;
      const std::size_t source = sensed.source[pixel];
      const bool person = image.owner[source] == owner;
      const bool floor = image.material[source] == static_cast<std::uint8_t>(Material::Floor);
      if (!person && !floor) continue;
      if (person && image.part[source] != static_cast<std::uint8_t>(PartLabel::LeftFoot) &&
          image.part[source] != static_cast<std::uint8_t>(PartLabel::RightFoot)) {
        mask[pixel] = 1;
        continue;
      }
      const double z = sensed.depth_mm[pixel] * 0.001;
      const Vector3d point{(u - k.centre_x_px) / k.focal_x_px * z, (v - k.centre_y_px) / k.focal_y_px * z, z};
      const std::uint64_t bits =
          scrambled(seed ^ (static_cast<std::uint64_t>(v / block) << 20) ^ static_cast<std::uint64_t>(u / block));
      const bool coin = (bits & 1) != 0;
      if (person) {
        const double above = floor_up.dot(point) + floor_offset;
        mask[pixel] = above > static_cast<double>(low_until) || coin ? 1 : 0;
      } else if (coin) {
        const double away = std::min((point - feet[0]).norm(), (point - feet[1]).norm());
        mask[pixel] = away < floor_reach + 0.05 ? 1 : 0;
      }
    }
  }
}

void TrainingSampler::sample(std::uint64_t seed, LabelledImage& out, LabelledImage* at_rest) {
  seed &= ~kHeldOut;
  Random random(seed);
  // Somebody who is hardly in view teaches nothing: draw again, a few times at most.
  for (int attempt = 0; attempt < 5; ++attempt) {
    const Random before = random;
    const bool in_view = try_sample(random, seed, false, out);
    if (!in_view && attempt < 4) continue;
    if (at_rest != nullptr) {
      Random again = before;
      try_sample(again, seed, true, *at_rest);
    }
    return;
  }
}

void TrainingSampler::render_somebody(const Person& person, const PosedBody& body,
                                      const RigidTransform& camera_from_body, std::uint8_t owner) {
  body_surface(person.shape, body, person.outfit, edges_);
  for (SurfaceEdge& edge : edges_) edge = moved(edge, camera_from_body.rotation, camera_from_body.translation);
  render_edges(edges_, owner, image_);
}

bool TrainingSampler::try_sample(Random& random, std::uint64_t seed, bool at_rest, LabelledImage& out) {
  const Person person = random_person(random, options_.carries);
  RandomPose posed = random_pose(person, random);
  const bool wheels = posed.seat_height > 0 && random.chance(options_.wheelchair);
  const double distance = random.uniform(options_.nearest_m, options_.farthest_m);
  const double x = distance * random.uniform(-0.28, 0.28);
  bool alone = false;
  double heading = options_.turned_deg * kRadians *
                   (random.chance(0.5) ? 0.35 * std::clamp(random.normal(), -2.0, 2.0) : random.uniform(-1, 1));
  const RigidTransform furnished = world_from_body(x, distance, heading);
  if (at_rest) {
    Random resting(scrambled(seed ^ 0x4E57ULL));
    posed = random_pose(person, posed.activity == Activity::Sit ? Activity::Sit : Activity::Stand, resting);
    heading = 0.15 * resting.normal();
    alone = resting.chance(0.5);  // whoever hides her may come later
  }
  if (wheels) raise_onto_footrests(posed);

  Intrinsics k = kinect_intrinsics(options_.width, options_.height);
  k.focal_x_px *= 1 + options_.vary_intrinsics * random.uniform(-1, 1);
  k.focal_y_px = k.focal_x_px;
  image_.reset(k);
  const RigidTransform camera = random_camera(person.shape.stature, distance, x, random);
  const RigidTransform placed = world_from_body(x, distance, heading);
  const RigidTransform camera_from_body = camera * placed;

  Room room;
  room.left = -random.uniform(2, 4);
  room.right = random.uniform(2, 4);
  room.back = distance + random.uniform(0.7, 3);
  if (wheels) {
    // Segmentation often takes a wheelchair for a part of its user.
    wheelchair(posed.seat_height, person.shape.thigh, edges_);
    for (SurfaceEdge& edge : edges_) edge = moved(edge, camera_from_body.rotation, camera_from_body.translation);
    render_edges(edges_, random.chance(0.6) ? 1 : 0, image_);
  } else if (posed.seat_height > 0 && random.chance(0.85)) {
    const double back = random.uniform(0, 0.5);
    const auto boxes = chair(placed * RigidTransform{Eigen::Matrix3d::Identity(), Vector3d(0, 0, 0.06)},
                             posed.seat_height, random.uniform(0.2, 0.27), back);
    room.furniture.insert(room.furniture.end(), boxes.begin(), boxes.end());
  }
  if (random.chance(options_.occluded)) {
    const Eigen::Matrix3d turned = turned_left(random.uniform(-0.5, 0.5));
    const double ahead = random.uniform(0.5, 0.9), aside = random.uniform(-0.5, 0.5);
    const RigidTransform before = furnished * RigidTransform{turned, Vector3d(aside, 0, ahead)};
    const auto some_table = [&] {
      const double half_depth = random.uniform(0.2, 0.3), half_width = random.uniform(0.3, 0.6);
      return table(before, random.uniform(0.5, 0.8), half_width, half_depth);
    };
    const auto boxes = random.chance(0.5) ? some_table() : chair(before, 0.45, 0.22, random.uniform(0.3, 0.5));
    room.furniture.insert(room.furniture.end(), boxes.begin(), boxes.end());
  }

  const PosedBody body = pose_body(person.shape, posed.pose);
  render_somebody(person, body, camera_from_body, 1);
  if (random.chance(options_.company) && !alone) {
    const Person other = random_person(random, options_.carries);
    const RigidTransform beside{placed.rotation.transpose(), Vector3d::Zero()};  // in the room's axes
    const RandomPose other_pose = random_pose(other, Activity::Stand, random);
    render_somebody(other, pose_body(other.shape, other_pose.pose), camera_from_body * beside * company_place(random),
                    2);
  }
  render_room(room, camera, image_);
  sensor_.sense(image_, options_.sensor, scrambled(seed ^ 0x5E45ULL), seed, sensed_);

  out.intrinsics = k;
  out.activity = posed.activity;
  for (int j = 0; j < kJointCount; ++j) {
    out.joints[static_cast<std::size_t>(j)] =
        (camera_from_body * body.joints[static_cast<std::size_t>(j)]).cast<float>();
  }
  const Vector3d up = camera.rotation.col(1);
  mask_with_ragged_feet(image_, sensed_, 1, up, -up.dot(camera.translation),
                        {camera_from_body * body[JointId::LeftFoot], camera_from_body * body[JointId::RightFoot]},
                        scrambled(seed ^ 0xF007ULL), out.user);
  out.depth_mm = sensed_.depth_mm;
  out.part.resize(out.depth_mm.size());
  out.person_pixels = 0;
  int expected = 0;
  for (std::size_t pixel = 0; pixel < out.part.size(); ++pixel) {
    const std::size_t source = sensed_.source[pixel];
    out.part[pixel] = out.user[pixel] != 0 && image_.owner[source] == 1 ? image_.part[source] : kNoPart;
    out.person_pixels += out.part[pixel] != kNoPart ? 1 : 0;
  }
  // A person of this size fills about this many pixels; a third of them must be seen.
  expected = static_cast<int>(0.24 * person.shape.stature * person.shape.stature * k.focal_x_px * k.focal_y_px /
                              (distance * distance));
  return out.person_pixels > std::min(expected / 3, 20000);
}

}  // namespace armature
