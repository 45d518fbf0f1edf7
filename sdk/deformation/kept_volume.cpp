#include "sdk/deformation/kept_volume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr double kAgree = 1e-9;        // turns that differ by less are one
constexpr double kMostOfRadius = 0.5;  // that the surface moves
constexpr int kRounds = 8;             // of Newton's method
constexpr std::size_t kGrain = 4096;   // triangles that are summed in order, or vertices

/// SplitMix64's finaliser: edges become numbers that no few of them add up to zero by chance.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

/// A sum over all triangles.
template <class Sum, class F>
Sum sum_over(const Mesh& mesh, const F& f) {
  return tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kGrain), Sum{},
      [&](const auto& range, Sum sum) {
        for (std::size_t t = range.begin(); t != range.end(); ++t) sum += f(mesh.triangles[t]);
        return sum;
      },
      std::plus{});
}

/// From where volumes are measured: near the mesh, or digits would cancel.
Vector3d apex_of(const Mesh& mesh, std::span<const Vector3d> x) {
  return mesh.triangles.empty() ? Vector3d(Vector3d::Zero()) : x[mesh.triangles[0][0].index()];
}

std::array<Vector3d, 3> seen_from(const Vector3d& apex, std::span<const Vector3d> x, const Triangle& corners) {
  return {x[corners[0].index()] - apex, x[corners[1].index()] - apex, x[corners[2].index()] - apex};
}

/// Where vertices go per unit of t; of the others nothing.
struct Directions {
  std::vector<Vector3d> of;   // by vertex
  double most_of_radius = 0;  // the largest share of a radius among them
};

/// [V]: the turns of the spheres that weigh on a vertex, as `skin()` blends them: their signs agree.
std::vector<Vector4d> blended_turns(const SkinWeights& weights, std::span<const SphereMotion> motions) {
  struct Turning {
    const WeightColumn* column;
    Vector4d turn;
  };
  std::vector<Turning> turning;
  for (std::size_t s = 0; s < motions.size(); ++s)
    if (const Vector4d turn = motions[s].turn.coeffs(); !turn.head<3>().isZero(0))
      turning.push_back({weights.columns[s].get(), turn.w() < 0 ? Vector4d(-turn) : turn});
  const auto for_each_weight = [&](const auto& f) {
    for (const auto& [column, turn] : turning)
      for (std::size_t i = 0; i < column->vertices.size(); ++i) {
        const std::size_t v = column->vertices[i].index();
        f(v, static_cast<double>(column->weights[i]) / weights.totals[v], turn);
      }
  };
  std::vector<Vector4d> sums(weights.totals.size(), Vector4d::UnitW());
  // Turns by a right angle at most lie within half a turn of one another.
  constexpr double kHalfOfRightAngle = 0.7071067811865476;
  if (std::ranges::all_of(turning, [](const Turning& t) { return t.turn.w() >= kHalfOfRightAngle; })) {
    for_each_weight(
        [&](std::size_t v, double weight, const Vector4d& turn) { sums[v] += weight * (turn - Vector4d::UnitW()); });
    return sums;
  }
  for_each_weight([&](std::size_t v, double weight, const Vector4d&) { sums[v].w() -= weight; });
  for_each_weight([&](std::size_t v, double weight, const Vector4d& turn) {
    sums[v] += sums[v].dot(turn) < 0 ? -weight * turn : weight * turn;
  });
  return sums;
}

Directions directions(std::span<const Vector3d> outward, const SkinWeights& weights,
                      std::span<const SphereMotion> motions) {
  const std::vector<Vector4d> turns = blended_turns(weights, motions);
  Directions found{.of = std::vector<Vector3d>(outward.size(), Vector3d::Zero())};
  for (std::size_t v = 0; v < outward.size(); ++v) {
    const Vector4d& turn = turns[v];
    const double agree = turn.squaredNorm();
    const double disagree = 1 - agree;
    if (!(disagree > kAgree) || !(agree > 0)) continue;
    const Vector3d axis = turn.head<3>();
    const Vector3d twice = 2 * axis.cross(outward[v]);
    found.of[v] = disagree * (outward[v] + (turn.w() * twice + axis.cross(twice)) / agree);
    found.most_of_radius = std::max(found.most_of_radius, disagree);
  }
  return found;
}

}  // namespace

bool is_closed(const Mesh& mesh) {
  return sum_over<std::uint64_t>(mesh, [](const Triangle& corners) {
           std::uint64_t border = 0;
           for (std::size_t k = 0; k < 3; ++k) {
             const std::uint64_t a = corners[k].index();
             const std::uint64_t b = corners[(k + 1) % 3].index();
             const std::uint64_t edge = mixed(mixed(std::min(a, b) + 1) + std::max(a, b));
             border += a < b ? edge : a > b ? -edge : 0;
           }
           return border;
         }) == 0;
}

double six_volumes(const Mesh& mesh, std::span<const Vector3d> x) {
  const Vector3d apex = apex_of(mesh, x);
  return sum_over<double>(mesh, [&](const Triangle& corners) -> double {
    const auto [a, b, c] = seen_from(apex, x, corners);
    return a.dot(b.cross(c));
  });
}

std::vector<Vector3d> outward_by_radius(const Mesh& mesh, const SkinWeights& weights, std::span<const Sphere> spheres) {
  std::vector<double> radii(mesh.positions.size());
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const WeightColumn& column = *weights.columns[s];
    for (std::size_t i = 0; i < column.vertices.size(); ++i)
      radii[column.vertices[i].index()] += static_cast<double>(column.weights[i]) * spheres[s].radius;
  }
  std::vector<Vector3d> outward = vertex_normals(mesh);
  for (std::size_t v = 0; v < outward.size(); ++v) outward[v] *= radii[v] / weights.totals[v];
  return outward;
}

void keep_volume(const Mesh& mesh, std::span<const Vector3d> outward, const SkinWeights& weights,
                 std::span<const SphereMotion> motions, double wanted, std::span<Vector3d> positions) {
  const Directions directions = armature::sdk::directions(outward, weights, motions);
  if (!(directions.most_of_radius > 0)) return;
  const auto& d = directions.of;
  // Six volumes of x + t d are a cubic in t.
  using Cubic = std::array<double, 4>;
  struct Sum : Cubic {
    Sum operator+(const Sum& other) const { return Sum(*this) += other; }
    Sum& operator+=(const Cubic& other) {
      for (std::size_t k = 0; k < 4; ++k) (*this)[k] += other[k];
      return *this;
    }
  };
  const Vector3d apex = apex_of(mesh, positions);
  const Sum f = sum_over<Sum>(mesh, [&](const Triangle& corners) -> Cubic {
    const auto [a, b, c] = seen_from(apex, positions, corners);
    const Vector3d bc = b.cross(c);
    const Vector3d &p = d[corners[0].index()], &q = d[corners[1].index()], &r = d[corners[2].index()];
    if (p.isZero(0) && q.isZero(0) && r.isZero(0)) return {a.dot(bc), 0, 0, 0};
    const Vector3d qr = q.cross(r);
    return {a.dot(bc), p.dot(bc) + q.dot(c.cross(a)) + r.dot(a.cross(b)),
            a.dot(qr) + b.dot(r.cross(p)) + c.dot(p.cross(q)), p.dot(qr)};
  });
  const double most = kMostOfRadius / directions.most_of_radius;
  const auto excess = [&](double t) { return f[0] + t * (f[1] + t * (f[2] + t * f[3])) - wanted; };
  double t = 0;
  for (int round = 0; round < kRounds; ++round) {
    const double slope = f[1] + t * (2 * f[2] + t * 3 * f[3]);
    if (!(slope > 0)) break;  // the surface has folded over
    t = std::clamp(t - excess(t) / slope, -most, most);
  }
  if (!(std::abs(excess(t)) < std::abs(excess(0)))) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), kGrain), [&](const auto& range) {
    for (std::size_t v = range.begin(); v != range.end(); ++v)
      if (!d[v].isZero(0)) positions[v] += t * d[v];
  });
}

}  // namespace armature::sdk
