#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/mesh/mesh.h>

#include "tests/sdk/mesh/surfaces.h"

/// A round body with limbs whose places are known, point by point.
namespace armature::sdk::limbs {

/// A limb grows out of a cap of the unit sphere: the cap's rim stays, its pole becomes the tip.
struct Limb {
  Eigen::Vector3d towards = Eigen::Vector3d::UnitZ();  ///< of unit length
  double turn_rad = 0;                                 ///< about that direction
  double width_rad = 0.3;                              ///< half the angle of the cap
  double length = 2;                                   ///< in widths of the cap's radius
  double bend_rad = 0;                                 ///< by the tip
  double bulge = 0;  ///< of the middle, in radii; makes the limb unlike a tube, and one of its sides unlike the other
  bool mirrored = false;
};

/// Where a point of a limb lies: 0 at the rim and 1 at the tip, and the angle about its axis.
struct LimbPoint {
  double along = 0;
  double angle_rad = 0;
};

/// Where a point of a limb goes. The first fifth is a fillet to the body.
inline Eigen::Vector3d place(const Limb& limb, LimbPoint at) {
  const double radius = std::sin(limb.width_rad);
  const double length = limb.length * radius;
  const Eigen::Vector3d axis = limb.towards.normalized();
  const Eigen::Vector3d u0 = axis.unitOrthogonal();
  const Eigen::Vector3d u = Eigen::AngleAxisd(limb.turn_rad, axis) * u0;
  const Eigen::Vector3d v = (limb.mirrored ? -1.0 : 1.0) * axis.cross(u);
  const double s = at.along;
  // The profile: a flare at the root, a tube, a round tip.
  const double tube = 0.45;
  const double flare = (1 - tube) * std::exp(-12 * s);
  const double tip = 0.85;
  const double round = s > tip ? std::sqrt(std::max(0.0, 1 - std::pow((s - tip) / (1 - tip), 2))) : 1;
  const double side = 1 + limb.bulge * std::exp(-std::pow((s - 0.55) / 0.12, 2)) *
                              (1 + 0.6 * std::cos(at.angle_rad) + 0.3 * std::sin(2 * at.angle_rad));
  const double r = radius * (tube * side * round + flare);
  // Bent to an arc in the plane of the axis and u.
  const double t = s * length;
  const double theta = limb.bend_rad * s;
  Eigen::Vector2d centre(0, t);
  if (limb.bend_rad != 0) {
    const double R = length / limb.bend_rad;
    centre = {R * (1 - std::cos(theta)), R * std::sin(theta)};
  }
  const Eigen::Vector3d spine = axis * std::cos(limb.width_rad) + u * centre.x() + axis * centre.y();
  const Eigen::Vector3d outwards = u * std::cos(theta) - axis * std::sin(theta);
  return spine + r * (std::cos(at.angle_rad) * outwards + std::sin(at.angle_rad) * v);
}

/// A body, and which of its vertices lie where on which limb.
struct Creature {
  Mesh mesh = {};
  std::vector<Limb> limbs = {};
  std::vector<int> limb_of = {};       ///< by VertexId; -1 on the body
  std::vector<LimbPoint> places = {};  ///< by VertexId

  /// The faces of a limb beyond a place along it.
  [[nodiscard]] std::vector<FaceId> beyond(int limb, double along) const {
    std::vector<FaceId> faces;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
      double mean = 0;
      bool on = true;
      for (const VertexId v : mesh.triangles[f]) {
        on &= limb_of[v.index()] == limb;
        mean += places[v.index()].along / 3;
      }
      if (on && mean > along) faces.emplace_back(f);
    }
    return faces;
  }
  /// A stroke across one side of a limb, at a place along it.
  [[nodiscard]] std::vector<Eigen::Vector3d> stroke(int limb, double along, double from_rad = -1.4,
                                                    double to_rad = 1.4) const {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i <= 8; ++i)
      points.push_back(place(limbs[static_cast<std::size_t>(limb)], {along, from_rad + (to_rad - from_rad) * i / 8}));
    return points;
  }
};

/// The limbs grow out of a sphere, whose triangles are split until no edge is longer than `edge`; noise moves every
/// vertex by a normal deviate of that part of the diagonal along each axis.
inline Creature creature(std::vector<Limb> limbs, double edge = 0.04, double noise = 0, std::uint64_t seed = 7) {
  Creature result{.mesh = surfaces::icosphere(4), .limbs = std::move(limbs)};
  std::vector<Eigen::Vector3d> on_sphere = result.mesh.positions;
  const auto grow = [&](const Eigen::Vector3d& p) {
    for (std::size_t i = 0; i < result.limbs.size(); ++i) {
      const Limb& limb = result.limbs[i];
      const Eigen::Vector3d axis = limb.towards.normalized();
      const double angle = std::acos(std::clamp(p.dot(axis), -1.0, 1.0));
      if (angle >= limb.width_rad) continue;
      const Eigen::Vector3d u = Eigen::AngleAxisd(limb.turn_rad, axis) * Eigen::Vector3d(axis.unitOrthogonal());
      const Eigen::Vector3d w = (limb.mirrored ? -1.0 : 1.0) * axis.cross(u);
      const LimbPoint at{1 - angle / limb.width_rad, std::atan2(p.dot(w), p.dot(u))};
      result.limb_of.push_back(static_cast<int>(i));
      result.places.push_back(at);
      return place(limb, at);
    }
    result.limb_of.push_back(-1);
    result.places.emplace_back();
    return p;
  };
  auto& positions = result.mesh.positions;
  for (Eigen::Vector3d& p : positions) p = grow(p);
  for (bool split = true; split;) {
    split = false;
    std::map<std::pair<VertexId, VertexId>, VertexId> middles;
    const auto middle = [&](VertexId a, VertexId b) -> VertexId {
      if ((positions[a.index()] - positions[b.index()]).norm() <= edge) return {};
      const auto [found, is_new] = middles.try_emplace(std::minmax(a, b), VertexId(positions.size()));
      if (is_new) {
        on_sphere.push_back((on_sphere[a.index()] + on_sphere[b.index()]).normalized());
        positions.push_back(grow(on_sphere.back()));
        split = true;
      }
      return found->second;
    };
    std::vector<Triangle> triangles;
    for (const Triangle& t : result.mesh.triangles) {
      const std::array<VertexId, 3> m = {middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
      // The corner k is that where two split sides, or the one, begin.
      const auto count =
          static_cast<int>(m[0].valid()) + static_cast<int>(m[1].valid()) + static_cast<int>(m[2].valid());
      if (count == 0) triangles.push_back(t);
      if (count == 3)
        triangles.insert(triangles.end(), {Triangle{t[0], m[0], m[2]}, Triangle{t[1], m[1], m[0]},
                                           Triangle{t[2], m[2], m[1]}, Triangle{m[0], m[1], m[2]}});
      for (std::size_t k = 0; k < 3; ++k) {
        const VertexId a = t[k];
        const VertexId b = t[(k + 1) % 3];
        const VertexId c = t[(k + 2) % 3];
        if (count == 1 && m[k].valid()) triangles.insert(triangles.end(), {Triangle{a, m[k], c}, Triangle{m[k], b, c}});
        if (count == 2 && !m[(k + 2) % 3].valid()) {
          const VertexId ab = m[k];
          const VertexId bc = m[(k + 1) % 3];
          triangles.push_back({ab, b, bc});
          const bool to_a = (positions[a.index()] - positions[bc.index()]).norm() <
                            (positions[c.index()] - positions[ab.index()]).norm();
          if (to_a) {
            triangles.insert(triangles.end(), {Triangle{a, ab, bc}, Triangle{a, bc, c}});
          } else {
            triangles.insert(triangles.end(), {Triangle{a, ab, c}, Triangle{ab, bc, c}});
          }
        }
      }
    }
    result.mesh.triangles = std::move(triangles);
  }
  const double deviation = noise * bounding_box_diagonal(result.mesh);
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0, 1);
  if (noise > 0)
    for (Eigen::Vector3d& p : positions)
      for (int k = 0; k < 3; ++k) p[k] += deviation * normal(random);
  return result;
}

/// Joins two limbs by a tunnel, three sides wide, between the faces that are nearest to one another of those at a place
/// along them.
inline void join_by_tunnel(Creature& creature, int first, int second, double along) {
  Mesh& mesh = creature.mesh;
  const auto ring = [&](int limb) {
    std::vector<FaceId> faces = creature.beyond(limb, along - 0.05);
    const auto farther = creature.beyond(limb, along + 0.05);
    std::erase_if(faces, [&](FaceId face) { return std::ranges::binary_search(farther, face); });
    return faces;
  };
  const auto middle = [&](FaceId face) -> Eigen::Vector3d {
    return (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
  };
  std::pair<FaceId, FaceId> ends;
  double nearest = std::numeric_limits<double>::infinity();
  for (const FaceId a : ring(first))
    for (const FaceId b : ring(second))
      if (const double distance = (middle(a) - middle(b)).norm(); distance < nearest) {
        nearest = distance;
        ends = {a, b};
      }
  const Triangle from = mesh.triangle(ends.first);
  Triangle to = mesh.triangle(ends.second);
  std::swap(to[1], to[2]);  // seen from the other side
  const auto twist = [&](std::size_t turn) {
    double sum = 0;
    for (std::size_t k = 0; k < 3; ++k) sum += (mesh.position(from[k]) - mesh.position(to[(k + turn) % 3])).norm();
    return sum;
  };
  std::ranges::rotate(to, to.begin() + std::ranges::min({0, 1, 2}, {}, twist));
  constexpr int kRings = 12;
  std::vector<Triangle> sides;
  Triangle here = from;
  for (int i = 1; i <= kRings; ++i) {
    Triangle next = to;
    for (std::size_t k = 0; i < kRings && k < 3; ++k) {
      next[k] = VertexId(mesh.positions.size());
      const double share = static_cast<double>(i) / kRings;
      mesh.positions.emplace_back((1 - share) * mesh.position(from[k]) + share * mesh.position(to[k]));
      creature.limb_of.push_back(-1);
      creature.places.emplace_back();
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t l = (k + 1) % 3;
      sides.insert(sides.end(), {Triangle{here[k], here[l], next[l]}, Triangle{here[k], next[l], next[k]}});
    }
    here = next;
  }
  mesh.triangles[ends.first.index()] = sides[0];
  mesh.triangles[ends.second.index()] = sides[1];
  mesh.triangles.insert(mesh.triangles.end(), sides.begin() + 2, sides.end());
}

/// The area of what two sets of faces have in common over that of their union; both ascend.
inline double overlap(const Mesh& mesh, const std::vector<FaceId>& a, const std::vector<FaceId>& b) {
  const auto areas = face_areas(mesh);
  std::vector<std::uint8_t> in(mesh.triangles.size(), 0);
  for (const FaceId f : a) in[f.index()] |= 1;
  for (const FaceId f : b) in[f.index()] |= 2;
  double both = 0;
  double either = 0;
  for (std::size_t f = 0; f < in.size(); ++f) {
    if (in[f] == 3) both += areas[f];
    if (in[f] != 0) either += areas[f];
  }
  return either > 0 ? both / either : 0;
}

}  // namespace armature::sdk::limbs
