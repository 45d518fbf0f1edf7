#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "firmware_host/depth_frame.h"

namespace armature::test {

/// A room of boxes and ellipsoids, ray-cast to depth. World frame: origin on the floor under the camera, x right, y
/// down (so what stands on the floor has negative y), z away from the camera, metres.
class Room {
 public:
  static constexpr std::uint8_t kThing = 0;

  explicit Room(float camera_height = 1.2F, float tilt_rad = 0) : height_(camera_height), tilt_(tilt_rad) {}

  void add_floor() { has_floor_ = true; }
  void add_box(const Eigen::Vector3f& low, const Eigen::Vector3f& high, std::uint8_t who = kThing) {
    boxes_.push_back({low, high, who});
  }
  void add_ellipsoid(const Eigen::Vector3f& centre, const Eigen::Vector3f& radii, std::uint8_t who = kThing) {
    ellipsoids_.push_back({centre, radii, who});
  }
  void add_wall(float z) { add_box({-5, -3, z}, {5, 0.5F, z + 0.2F}); }
  void add_table(float x, float z) { add_box({x - 0.6F, -0.75F, z - 0.35F}, {x + 0.6F, 0, z + 0.35F}); }
  /// 1.74 m tall, arms hanging.
  void add_person(float x, float z, std::uint8_t who) {
    add_ellipsoid({x, -1.62F, z}, {0.085F, 0.12F, 0.10F}, who);
    add_ellipsoid({x, -1.15F, z}, {0.19F, 0.40F, 0.13F}, who);
    for (const float side : {-1.0F, 1.0F}) {
      add_ellipsoid({x + side * 0.10F, -0.43F, z}, {0.09F, 0.45F, 0.09F}, who);
      add_ellipsoid({x + side * 0.23F, -1.05F, z}, {0.055F, 0.36F, 0.06F}, who);
    }
  }

  struct Picture {
    DepthFrame frame;
    std::vector<std::uint8_t> truth;  ///< [height][width], whom a pixel shows
  };

  /// Noise of a structured-light sensor: disparity quantised, jittered by `noise` steps, from a fixed sequence.
  [[nodiscard]] Picture draw(std::uint64_t sequence = 0, float noise = 0.5F, int width = 320, int height = 240) const {
    Picture picture;
    DepthFrame& frame = picture.frame;
    const double focal = 285.63 * width / 320;
    frame.intrinsics = {width, height, focal, focal, width / 2.0, height / 2.0};
    frame.sequence = sequence;
    frame.depth_mm.assign(static_cast<std::size_t>(width * height), 0);
    picture.truth.assign(frame.depth_mm.size(), kThing);
    const Eigen::Matrix3f world_from_camera = Eigen::AngleAxisf(-tilt_, Eigen::Vector3f::UnitX()).toRotationMatrix();
    const Eigen::Vector3f eye(0, -height_, 0);
    std::uint32_t random = 12345 + static_cast<std::uint32_t>(sequence) * 7919;
    for (int v = 0, i = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u, ++i) {
        random = random * 1664525U + 1013904223U;
        const Eigen::Vector3f ray(static_cast<float>((u - width / 2.0) / focal),
                                  static_cast<float>((v - height / 2.0) / focal), 1);
        const auto hit = cast(eye, world_from_camera * ray);
        if (!hit || hit->z > 8) continue;
        const float jitter = noise * (static_cast<float>(random >> 16) / 32768.0F - 1.0F);
        const float disparity = std::round(348.0F / hit->z + jitter);
        frame.depth_mm[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(std::lround(348000.0F / disparity));
        picture.truth[static_cast<std::size_t>(i)] = hit->who;
      }
    }
    return picture;
  }

 private:
  struct Box {
    Eigen::Vector3f low, high;
    std::uint8_t who;
  };
  struct Ellipsoid {
    Eigen::Vector3f centre, radii;
    std::uint8_t who;
  };
  struct Hit {
    float z;  ///< along the camera's axis, since rays have z = 1 there
    std::uint8_t who;
  };

  [[nodiscard]] std::optional<Hit> cast(const Eigen::Vector3f& eye, const Eigen::Vector3f& ray) const {
    std::optional<Hit> best;
    const auto offer = [&](float t, std::uint8_t who) {
      if (t > 0.3F && (!best || t < best->z)) best = Hit{t, who};
    };
    if (has_floor_ && ray.y() > 1e-6F) offer(-eye.y() / ray.y(), kThing);
    for (const Box& box : boxes_) {
      const Eigen::Array3f a = (box.low - eye).array() / ray.array();
      const Eigen::Array3f b = (box.high - eye).array() / ray.array();
      const float enter = a.min(b).maxCoeff();
      if (enter <= a.max(b).minCoeff()) offer(enter, box.who);
    }
    for (const Ellipsoid& e : ellipsoids_) {
      const Eigen::Vector3f o = (eye - e.centre).cwiseQuotient(e.radii);
      const Eigen::Vector3f d = ray.cwiseQuotient(e.radii);
      const float b = o.dot(d);
      const float discriminant = b * b - d.squaredNorm() * (o.squaredNorm() - 1);
      if (discriminant > 0) offer((-b - std::sqrt(discriminant)) / d.squaredNorm(), e.who);
    }
    return best;
  }

  float height_;
  float tilt_;
  bool has_floor_ = false;
  std::vector<Box> boxes_;
  std::vector<Ellipsoid> ellipsoids_;
};

/// A furnished room: floor, back wall at 4 m, a table to the left.
inline Room furnished_room(float camera_height = 1.2F, float tilt_rad = 0) {
  Room room(camera_height, tilt_rad);
  room.add_floor();
  room.add_wall(4.0F);
  room.add_table(-1.3F, 2.6F);
  return room;
}

}  // namespace armature::test
