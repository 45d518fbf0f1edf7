#include "tools/evaluation/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

namespace armature::tools {
namespace {

using Eigen::Vector3d;
using sdk::Mesh;
using sdk::VertexId;

Eigen::AlignedBox3d box_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : mesh.positions) box.extend(p);
  return box;
}

Mesh icosahedron() {
  constexpr double kLong = std::numbers::phi;
  Mesh mesh;
  for (const double a : {-1.0, 1.0}) {
    for (const double b : {-kLong, kLong}) {
      mesh.positions.insert(mesh.positions.end(), {{0, a, b}, {a, b, 0}, {b, 0, a}});
    }
  }
  // Its faces are the triples of vertices that are an edge's length, 2, apart from one another.
  const auto neighbours = [&](std::size_t i, std::size_t j) {
    return std::abs((mesh.positions[i] - mesh.positions[j]).norm() - 2) < 1e-9;
  };
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (!neighbours(i, j) || !neighbours(j, k) || !neighbours(i, k)) continue;
        const Vector3d normal = (mesh.positions[j] - mesh.positions[i]).cross(mesh.positions[k] - mesh.positions[i]);
        const bool outward = normal.dot(mesh.positions[i]) > 0;
        mesh.triangles.push_back({VertexId(i), VertexId(outward ? j : k), VertexId(outward ? k : j)});
      }
    }
  }
  return mesh;
}

}  // namespace

Mesh icosphere(int rounds, double radius) {
  Mesh mesh = icosahedron();
  for (int round = 0; round < rounds; ++round) {
    mesh = subdivided(mesh);
    for (Vector3d& p : mesh.positions) p.normalize();
  }
  for (Vector3d& p : mesh.positions) p = radius * p.normalized();
  return mesh;
}

Mesh hollow_ball(int rounds, double inner_radius) {
  Mesh mesh = icosphere(rounds);
  const Mesh inner = icosphere(rounds, inner_radius);
  const std::size_t offset = mesh.positions.size();
  mesh.positions.insert(mesh.positions.end(), inner.positions.begin(), inner.positions.end());
  for (const sdk::Triangle& t : inner.triangles) {
    mesh.triangles.push_back(
        {VertexId(offset + t[0].index()), VertexId(offset + t[2].index()), VertexId(offset + t[1].index())});
  }
  return mesh;
}

Mesh creature(int rounds) {
  constexpr int kArms = 8;
  Mesh mesh = icosphere(rounds);
  for (Vector3d& p : mesh.positions) {
    double reach = 1 + 0.03 * std::sin(9 * p.x()) * std::sin(8 * p.y()) * std::sin(7 * p.z());
    for (int arm = 0; arm < kArms; ++arm) {
      const double height = 1 - (2.0 * arm + 1) / kArms;  // Fibonacci's spiral: directions evenly over the sphere
      const double turn = 2 * std::numbers::pi * arm / std::numbers::phi;
      const double across = std::sqrt(1 - height * height);
      const Vector3d direction(across * std::cos(turn), height, across * std::sin(turn));
      const double angle2 = 2 - 2 * p.dot(direction);
      reach += (1 + 0.35 * arm) * std::exp(-angle2 / 0.05);
    }
    p *= reach;
  }
  return mesh;
}

Mesh straight_tube(double length, int around, double twist) {
  const double profile = length + std::numbers::pi;  // from pole to pole
  const int rings = static_cast<int>(std::lround(profile * around / (2 * std::numbers::pi)));
  Mesh mesh;
  for (int ring = 1; ring < rings; ++ring) {
    const double s = profile * ring / rings - profile / 2;
    const double on_cap = std::copysign(std::max(0.0, std::abs(s) - length / 2), s);
    const double x = s - on_cap + std::sin(on_cap);
    for (int k = 0; k < around; ++k) {
      const double turn = 2 * std::numbers::pi * k / around + twist * x;
      mesh.positions.emplace_back(x, std::cos(on_cap) * std::cos(turn), std::cos(on_cap) * std::sin(turn));
    }
  }
  const VertexId first(mesh.positions.size()), last(mesh.positions.size() + 1);
  for (const double side : {-1.0, 1.0}) mesh.positions.emplace_back(side * (length / 2 + 1), 0, 0);
  const auto at = [&](int ring, int k) { return VertexId(static_cast<std::size_t>(ring * around + k % around)); };
  for (int k = 0; k < around; ++k) {
    mesh.triangles.push_back({first, at(0, k + 1), at(0, k)});
    for (int ring = 0; ring + 2 < rings; ++ring) {
      mesh.triangles.push_back({at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)});
      mesh.triangles.push_back({at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)});
    }
    mesh.triangles.push_back({last, at(rings - 2, k), at(rings - 2, k + 1)});
  }
  return mesh;
}

Mesh subdivided(const Mesh& mesh) {
  Mesh result{.positions = mesh.positions};
  result.triangles.reserve(4 * mesh.triangles.size());
  std::map<std::array<VertexId, 2>, VertexId> midpoints;
  const auto midpoint = [&](VertexId a, VertexId b) {
    const auto [found, added] = midpoints.try_emplace({std::min(a, b), std::max(a, b)}, result.positions.size());
    if (added) result.positions.emplace_back((mesh.position(a) + mesh.position(b)) / 2);
    return found->second;
  };
  for (const sdk::Triangle& t : mesh.triangles) {
    const VertexId ab = midpoint(t[0], t[1]);
    const VertexId bc = midpoint(t[1], t[2]);
    const VertexId ca = midpoint(t[2], t[0]);
    result.triangles.insert(result.triangles.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
  }
  return result;
}

Mesh with_noise(const Mesh& mesh, double percent, std::uint32_t seed) {
  Mesh result = mesh;
  const double most = percent / 100 * box_of(mesh).diagonal().norm();
  std::mt19937 random(seed);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  for (Vector3d& p : result.positions) {
    const double height = 2 * uniform() - 1;
    const double turn = 2 * std::numbers::pi * uniform();
    const double across = std::sqrt(1 - height * height);
    p += most * uniform() * Vector3d(across * std::cos(turn), across * std::sin(turn), height);
  }
  return result;
}

Mesh half_of(const Mesh& mesh) {
  const Eigen::AlignedBox3d box = box_of(mesh);
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const double middle = box.center()[axis];
  Mesh result;
  std::vector<VertexId> kept(mesh.positions.size());
  for (const sdk::Triangle& t : mesh.triangles) {
    const double centroid = (mesh.position(t[0])[axis] + mesh.position(t[1])[axis] + mesh.position(t[2])[axis]) / 3;
    if (centroid > middle) continue;
    sdk::Triangle face;
    for (std::size_t k = 0; k < 3; ++k) {
      VertexId& id = kept[t[k].index()];
      if (!id.valid()) {
        id = VertexId(result.positions.size());
        result.positions.push_back(mesh.position(t[k]));
      }
      face[k] = id;
    }
    result.triangles.push_back(face);
  }
  return result;
}

}  // namespace armature::tools
