#include "tracker/synth/render.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <armature/sdk/spheremesh/primitives.h>

namespace armature {
namespace {

using Eigen::Vector3d;

struct PixelRect {
  int left = 0, top = 0, right = 0, bottom = 0;  // right and bottom exclusive
};

/// The slopes (x/z) between which a sphere is seen: tangents to the circle (x, z, r). False where it reaches behind the
/// nearest plane.
bool tangent_slopes(double x, double z, double r, double& low, double& high) {
  if (z - r < kNearest) return false;
  const double root = r * std::sqrt(x * x + z * z - r * r);
  const double denominator = z * z - r * r;
  low = (x * z - root) / denominator;
  high = (x * z + root) / denominator;
  return true;
}

/// The hull of two spheres projects into the hull of their projections.
PixelRect projected_rect(const sdk::SphereEdge& edge, const Intrinsics& k) {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const sdk::Sphere* s : {&edge.a, &edge.b}) {
    double u0, u1, v0, v1;
    if (s->centre.z() + s->radius < kNearest) continue;
    if (!tangent_slopes(s->centre.x(), s->centre.z(), s->radius, u0, u1) ||
        !tangent_slopes(s->centre.y(), s->centre.z(), s->radius, v0, v1)) {
      return {0, 0, k.width, k.height};
    }
    left = std::min(left, u0);
    right = std::max(right, u1);
    top = std::min(top, v0);
    bottom = std::max(bottom, v1);
  }
  if (left > right) return {};
  const auto clamp = [](double value, int limit) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(limit)));
  };
  return {clamp(std::ceil(k.centre_x_px + k.focal_x_px * left), k.width),
          clamp(std::ceil(k.centre_y_px + k.focal_y_px * top), k.height),
          clamp(std::floor(k.centre_x_px + k.focal_x_px * right) + 1, k.width),
          clamp(std::floor(k.centre_y_px + k.focal_y_px * bottom) + 1, k.height)};
}

std::size_t pixel_of(const Intrinsics& k, int u, int v) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(k.width) + static_cast<std::size_t>(u);
}

/// A box seen from the camera's centre, in the box's own axes.
struct BoxCaster {
  Vector3d origin;
  Eigen::Matrix3d box_from_camera;
  Vector3d half;

  BoxCaster(const RigidTransform& camera_from_box, const Vector3d& half_size)
      : origin(-(camera_from_box.rotation.transpose() * camera_from_box.translation)),
        box_from_camera(camera_from_box.rotation.transpose()),
        half(half_size) {}

  /// The interval of z in which a ray with direction z = 1 is inside.
  void cast(const Vector3d& direction, double& enter, double& leave, int& leave_face) const {
    const Vector3d d = box_from_camera * direction;
    enter = -std::numeric_limits<double>::infinity();
    leave = std::numeric_limits<double>::infinity();
    leave_face = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (std::abs(d[axis]) < 1e-12) {
        if (std::abs(origin[axis]) > half[axis]) leave = -1;
        continue;
      }
      const double inverse = 1 / d[axis];
      const double a = (-half[axis] - origin[axis]) * inverse;
      const double b = (half[axis] - origin[axis]) * inverse;
      enter = std::max(enter, std::min(a, b));
      if (std::max(a, b) < leave) {
        leave = std::max(a, b);
        leave_face = d[axis] > 0 ? axis + 1 : -(axis + 1);
      }
    }
  }
};

}  // namespace

void SurfaceImage::reset(const Intrinsics& image_intrinsics) {
  intrinsics = image_intrinsics;
  const auto count = static_cast<std::size_t>(intrinsics.width) * static_cast<std::size_t>(intrinsics.height);
  depth_m.assign(count, kNothing);
  part.assign(count, kNoPart);
  owner.assign(count, 0);
  material.assign(count, static_cast<std::uint8_t>(Material::Wall));
}

void render_edges(std::span<const SurfaceEdge> edges, std::uint8_t owner, SurfaceImage& image) {
  const Intrinsics& k = image.intrinsics;
  for (const SurfaceEdge& surface : edges) {
    const PixelRect rect = projected_rect(surface.edge, k);
    if (rect.left >= rect.right || rect.top >= rect.bottom) continue;
    const sdk::EdgeCaster caster(surface.edge);
    const double nearest =
        std::min(surface.edge.a.centre.z() - surface.edge.a.radius, surface.edge.b.centre.z() - surface.edge.b.radius);
    for (int v = rect.top; v < rect.bottom; ++v) {
      const double ray_y = (v - k.centre_y_px) / k.focal_y_px;
      for (int u = rect.left; u < rect.right; ++u) {
        const std::size_t pixel = pixel_of(k, u, v);
        if (nearest >= static_cast<double>(image.depth_m[pixel])) continue;
        const Vector3d ray{(u - k.centre_x_px) / k.focal_x_px, ray_y, 1};
        const auto hit = caster.cast(ray);
        if (!hit || hit->t < kNearest || hit->t >= static_cast<double>(image.depth_m[pixel])) continue;
        image.depth_m[pixel] = static_cast<float>(hit->t);
        image.part[pixel] = part_at(surface.cut, hit->t * ray);
        image.owner[pixel] = owner;
        image.material[pixel] = static_cast<std::uint8_t>(surface.material);
      }
    }
  }
}

void render_boxes(std::span<const Box> boxes, const RigidTransform& camera_from_world, SurfaceImage& image) {
  const Intrinsics& k = image.intrinsics;
  for (const Box& box : boxes) {
    const RigidTransform camera_from_box = camera_from_world * box.world_from_box;
    // The sphere around the box bounds its projection.
    const sdk::Sphere around{camera_from_box.translation, box.half_size.norm()};
    const PixelRect rect = projected_rect({around, around}, k);
    const BoxCaster caster(camera_from_box, box.half_size);
    for (int v = rect.top; v < rect.bottom; ++v) {
      for (int u = rect.left; u < rect.right; ++u) {
        const Vector3d ray{(u - k.centre_x_px) / k.focal_x_px, (v - k.centre_y_px) / k.focal_y_px, 1};
        double enter, leave;
        int face;
        caster.cast(ray, enter, leave, face);
        if (enter > leave || enter < kNearest) continue;
        const std::size_t pixel = pixel_of(k, u, v);
        if (enter >= static_cast<double>(image.depth_m[pixel])) continue;
        image.depth_m[pixel] = static_cast<float>(enter);
        image.part[pixel] = kNoPart;
        image.owner[pixel] = 0;
        image.material[pixel] = static_cast<std::uint8_t>(Material::Furniture);
      }
    }
  }
}

void render_room(const Room& room, const RigidTransform& camera_from_world, SurfaceImage& image) {
  const Intrinsics& k = image.intrinsics;
  const Vector3d low{room.left, 0, -room.back}, high{room.right, room.height, room.front};
  const RigidTransform camera_from_box =
      camera_from_world * RigidTransform{Eigen::Matrix3d::Identity(), 0.5 * (low + high)};
  const BoxCaster caster(camera_from_box, 0.5 * (high - low));
  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const Vector3d ray{(u - k.centre_x_px) / k.focal_x_px, (v - k.centre_y_px) / k.focal_y_px, 1};
      double enter, leave;
      int face;
      caster.cast(ray, enter, leave, face);
      const std::size_t pixel = pixel_of(k, u, v);
      if (leave < kNearest || leave >= static_cast<double>(image.depth_m[pixel])) continue;
      image.depth_m[pixel] = static_cast<float>(leave);
      image.part[pixel] = kNoPart;
      image.owner[pixel] = 0;
      image.material[pixel] = static_cast<std::uint8_t>(face == -2 ? Material::Floor : Material::Wall);
    }
  }
  render_boxes(room.furniture, camera_from_world, image);
}

}  // namespace armature
