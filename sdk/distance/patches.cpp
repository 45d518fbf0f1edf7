#include "sdk/distance/patches.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
constexpr double kTurn = 2 * std::numbers::pi;

Vector3d around(const Patch& patch, double angle) noexcept {
  return std::cos(angle) * patch.across[0] + std::sin(angle) * patch.across[1];
}

void add_sphere(const SpherePieces& shape, SphereId id, const std::vector<bool>& held, std::vector<Patch>& patches) {
  if (held[id.index()] || !(shape.sphere(id).radius > 0)) return;
  patches.push_back({.kind = Patch::Kind::Sphere,
                     .index = static_cast<std::uint32_t>(id.index()),
                     .spheres = {id, SphereId(), SphereId()}});
}

void add_cone(const SpherePieces& shape, std::uint32_t edge, std::vector<Patch>& patches) {
  const EdgeGauge& e = shape.edges[edge];
  if (e.length == 0 || (e.radius_a == 0 && e.radius_b == 0)) return;
  const Vector3d first = any_normal_to(e.u);
  patches.push_back({.kind = Patch::Kind::Cone,
                     .index = edge,
                     .across = {first, e.u.cross(first)},
                     .spheres = {shape.edge_spheres[edge][0], shape.edge_spheres[edge][1], SphereId()}});
}

void add_facets(const SpherePieces& shape, std::uint32_t facet, std::vector<Patch>& patches) {
  for (const double sign : {1.0, -1.0})
    patches.push_back(
        {.kind = Patch::Kind::Facet, .index = facet, .sign = sign, .spheres = shape.facet_spheres[facet]});
}

}  // namespace

std::vector<bool> held_spheres(const SpherePieces& shape) {
  std::vector<bool> held(shape.spheres.size(), false);
  for (std::size_t k = 0; k < shape.edges.size(); ++k) {
    const auto [a, b] = shape.edge_spheres[k];
    if (shape.edges[k].length == 0 && b.valid()) held[(shape.edges[k].b_is_all ? a : b).index()] = true;
  }
  return held;
}

std::vector<Patch> patches_of(const SpherePieces& shape, Piece piece, const std::vector<bool>& held) {
  std::vector<Patch> patches;
  if (piece.kind == Piece::Kind::Facet) {
    add_facets(shape, piece.index, patches);
  } else {
    for (const SphereId id : shape.edge_spheres[piece.index])
      if (id.valid()) add_sphere(shape, id, held, patches);
    add_cone(shape, piece.index, patches);
  }
  return patches;
}

std::vector<Patch> patches_of(const SpherePieces& shape) {
  const std::vector<bool> held = held_spheres(shape);
  std::vector<Patch> patches;
  for (std::size_t k = 0; k < shape.spheres.size(); ++k) add_sphere(shape, SphereId(k), held, patches);
  for (std::size_t k = 0; k < shape.edges.size(); ++k) add_cone(shape, static_cast<std::uint32_t>(k), patches);
  for (std::size_t k = 0; k < shape.facets.size(); ++k) add_facets(shape, static_cast<std::uint32_t>(k), patches);
  return patches;
}

double area_of(const SpherePieces& shape, const Patch& patch) noexcept {
  switch (patch.kind) {
    case Patch::Kind::Sphere: {
      const double radius = shape.spheres[patch.index].radius;
      return 2 * kTurn * radius * radius;
    }
    case Patch::Kind::Cone: {
      const EdgeGauge& e = shape.edges[patch.index];
      return kTurn / 2 * e.cosine * (e.radius_a + e.radius_b) * e.length * e.cosine;
    }
    case Patch::Kind::Facet: break;
  }
  std::array<Vector3d, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) corner[k] = at(shape, patch, Vector3d::Unit(static_cast<Eigen::Index>(k))).point;
  return (corner[1] - corner[0]).cross(corner[2] - corner[0]).norm() / 2;
}

PatchPoint at(const SpherePieces& shape, const Patch& patch, const Vector3d& parameter) noexcept {
  switch (patch.kind) {
    case Patch::Kind::Sphere: {
      const Sphere& sphere = shape.spheres[patch.index];
      return {sphere.centre + sphere.radius * parameter, parameter};
    }
    case Patch::Kind::Cone: {
      const EdgeGauge& e = shape.edges[patch.index];
      const Vector3d normal = e.cosine * around(patch, parameter[1]) - e.g * e.u;
      return {e.centre(parameter[0]) + (e.radius_a + e.g * parameter[0]) * normal, normal};
    }
    case Patch::Kind::Facet: break;
  }
  const Vector3d normal = shape.facets[patch.index].normal(patch.sign);
  Vector3d centre = Vector3d::Zero();
  double radius = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Sphere& sphere = shape.sphere(patch.spheres[k]);
    centre += parameter[static_cast<Eigen::Index>(k)] * sphere.centre;
    radius += parameter[static_cast<Eigen::Index>(k)] * sphere.radius;
  }
  return {centre + radius * normal, normal};
}

Vector3d weights_at(const SpherePieces& shape, const Patch& patch, const Vector3d& parameter) noexcept {
  switch (patch.kind) {
    case Patch::Kind::Sphere: return Vector3d::UnitX();
    case Patch::Kind::Cone: {
      const double blend = shape.edges[patch.index].blend(parameter[0]);
      return {1 - blend, blend, 0};
    }
    case Patch::Kind::Facet: break;
  }
  return parameter;
}

Vector3d halfway(const Patch& patch, const Vector3d& a, const Vector3d& b) noexcept {
  return patch.kind == Patch::Kind::Sphere ? Vector3d((a + b).normalized()) : Vector3d((a + b) / 2);
}

Vector3d spread(const SpherePieces& shape, const Patch& patch, double u, double v) noexcept {
  switch (patch.kind) {
    case Patch::Kind::Sphere: {
      const double z = 2 * u - 1;
      const double off = std::sqrt(std::max(0.0, 1 - z * z));
      return {off * std::cos(kTurn * v), off * std::sin(kTurn * v), z};
    }
    case Patch::Kind::Cone: {
      // The area up to s grows as the integral of the radius: r_a s + g s^2 / 2.
      const EdgeGauge& e = shape.edges[patch.index];
      const double part = u * (e.radius_a + e.radius_b) / 2 * e.length;
      const double root = std::sqrt(std::max(0.0, e.radius_a * e.radius_a + 2 * e.g * part));
      const double along = 2 * part / std::max(e.radius_a + root, std::numeric_limits<double>::min());
      return {std::clamp(along, 0.0, e.length), kTurn * v, 0};
    }
    case Patch::Kind::Facet: break;
  }
  if (u + v > 1) return {u + v - 1, 1 - u, 1 - v};
  return {1 - u - v, u, v};
}

PatchPoint foot_on(const SpherePieces& shape, const Patch& patch, const Vector3d& point) noexcept {
  switch (patch.kind) {
    case Patch::Kind::Sphere: {
      const Sphere& sphere = shape.spheres[patch.index];
      const Touch nearest = touch(sphere, point);
      return {closest_point(point, nearest), nearest.normal};
    }
    case Patch::Kind::Cone: {
      const EdgeGauge& e = shape.edges[patch.index];
      const Vector3d v = point - e.a;
      const double x = v.dot(e.u);
      const Vector3d off = v - x * e.u;
      const double away = off.norm();
      const Vector3d side = away > 0 ? Vector3d(off / away) : patch.across[0];
      const Vector3d normal = e.cosine * side - e.g * e.u;
      return {point - (away * e.cosine - e.g * x - e.radius_a) * normal, normal};
    }
    case Patch::Kind::Facet: break;
  }
  const FacetGauge& facet = shape.facets[patch.index];
  const Vector3d normal = facet.normal(patch.sign);
  return {point - (normal.dot(point - facet.a) - facet.radius_a) * normal, normal};
}

std::vector<PatchTriangle> cover(const SpherePieces& shape, const Patch& patch) {
  std::vector<PatchTriangle> triangles;
  switch (patch.kind) {
    case Patch::Kind::Sphere:
      for (const double x : {1.0, -1.0})
        for (const double y : {1.0, -1.0})
          for (const double z : {1.0, -1.0})
            triangles.push_back({Vector3d(x, 0, 0), Vector3d(0, y, 0), Vector3d(0, 0, z)});
      break;
    case Patch::Kind::Cone: {
      const EdgeGauge& e = shape.edges[patch.index];
      constexpr int kAround = 6;
      const double arc = kTurn / kAround * std::max(e.radius_a, e.radius_b);
      const int steps = static_cast<int>(std::clamp(e.length / arc, 1.0, 64.0));
      for (int i = 0; i < steps; ++i)
        for (int j = 0; j < kAround; ++j) {
          const auto corner = [&](int di, int dj) {
            return Vector3d(e.length * (i + di) / steps, kTurn * (j + dj) / kAround, 0);
          };
          triangles.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
          triangles.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
        }
      break;
    }
    case Patch::Kind::Facet: triangles.push_back({Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()}); break;
  }
  return triangles;
}

PatchReach reach_of(const SpherePieces& shape, const Patch& patch, const PatchTriangle& t) noexcept {
  PatchReach reach;
  const Vector3d sum = t[0] + t[1] + t[2];
  switch (patch.kind) {
    case Patch::Kind::Sphere:
      reach.middle = sum.normalized();
      for (const Vector3d& corner : t) reach.turn = std::max(reach.turn, (corner - reach.middle).norm());
      reach.distance = reach.turn * shape.spheres[patch.index].radius;
      break;
    case Patch::Kind::Cone: {
      // Along the generator to the corner's height, then around: each step is at most its parameter's.
      const EdgeGauge& e = shape.edges[patch.index];
      reach.middle = sum / 3;
      const double radius =
          e.cosine * std::max({e.radius_a + e.g * t[0][0], e.radius_a + e.g * t[1][0], e.radius_a + e.g * t[2][0]});
      for (const Vector3d& corner : t) {
        const Vector3d d = (corner - reach.middle).cwiseAbs();
        reach.distance = std::max(reach.distance, std::hypot(d[0] * e.cosine, d[1] * radius));
        reach.turn = std::max(reach.turn, d[1] * e.cosine);
      }
      break;
    }
    case Patch::Kind::Facet: {
      reach.middle = sum / 3;
      const Vector3d middle = at(shape, patch, reach.middle).point;
      for (const Vector3d& corner : t)
        reach.distance = std::max(reach.distance, (at(shape, patch, corner).point - middle).norm());
      break;
    }
  }
  return reach;
}

}  // namespace armature::sdk
