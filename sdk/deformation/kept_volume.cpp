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

#include "sdk/mesh/four.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

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

/// One corner of four triangles.
ARMATURE_INLINE FourVectors gathered(const Vector3d* x, const Triangle* triangles, std::size_t corner) {
  const auto at = [&](std::size_t t) -> const Vector3d& { return x[triangles[t][corner].index()]; };
  return four_vectors(at(0), at(1), at(2), at(3));
}

/// Six volumes of x + t d are a cubic in t: its coefficients.
struct Cubic : std::array<double, 4> {
  Cubic operator+(const Cubic& other) const {
    Cubic sum = *this;
    for (std::size_t k = 0; k < 4; ++k) sum[k] += other[k];
    return sum;
  }
};

/// What four triangles of a closed mesh add: of the normals n at x and m of the same triangles at d, twice their areas
/// long, volumes are a.n, their gradient n, and so in d.
ARMATURE_INLINE void add_four(const Triangle* triangles, const Vector3d* x, const FourVectors& apex, const Vector3d* d,
                              std::array<Four, 4>& sums) {
  const FourVectors a = gathered(x, triangles, 0) - apex, b = gathered(x, triangles, 1) - apex,
                    c = gathered(x, triangles, 2) - apex;
  const FourVectors n = cross(b - a, c - a);
  add_dot(a, n, sums[0]);
  const FourVectors p = gathered(d, triangles, 0), q = gathered(d, triangles, 1), r = gathered(d, triangles, 2);
  const FourVectors m = cross(q - p, r - p);
  add_dot(n, p + q + r, sums[1]);
  add_dot(m, a + b + c, sums[2]);
  add_dot(p, m, sums[3]);
}

ARMATURE_LANES Cubic cubic_of(std::span<const Triangle> triangles, const Vector3d* x, const Vector3d& apex,
                              const Vector3d* d) {
  const FourVectors from = four_vectors(apex, apex, apex, apex);
  std::array<Four, 4> sums{};
  const std::size_t fours = triangles.size() / 4 * 4;
  for (std::size_t t = 0; t < fours; t += 4) add_four(&triangles[t], x, from, d, sums);
  if (fours < triangles.size()) {
    // The rest, and triangles without area.
    const VertexId corner = triangles[fours][0];
    std::array<Triangle, 4> rest;
    rest.fill({corner, corner, corner});
    std::ranges::copy(triangles.subspan(fours), rest.begin());
    add_four(rest.data(), x, from, d, sums);
  }
  Cubic cubic;
  for (std::size_t k = 0; k < 4; ++k) cubic[k] = sums[k][0] + sums[k][1] + sums[k][2] + sums[k][3];
  return cubic;
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

void keep_volume(const Mesh& mesh, std::span<const Vector3d> directions, double most_of_radius, double wanted,
                 std::span<Vector3d> positions) {
  if (!(most_of_radius > 0)) return;
  const Vector3d apex = apex_of(mesh, positions);
  const std::span<const Triangle> triangles = mesh.triangles;
  const Cubic f = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, triangles.size(), kGrain), Cubic{},
      [&](const auto& range, const Cubic& sum) {
        return sum +
               cubic_of(triangles.subspan(range.begin(), range.size()), positions.data(), apex, directions.data());
      },
      std::plus{});
  const double most = kMostOfRadius / most_of_radius;
  const auto excess = [&](double t) { return f[0] + t * (f[1] + t * (f[2] + t * f[3])) - wanted; };
  double t = 0;
  for (int round = 0; round < kRounds; ++round) {
    const double slope = f[1] + t * (2 * f[2] + t * 3 * f[3]);
    if (!(slope > 0)) break;  // the surface has folded over
    t = std::clamp(t - excess(t) / slope, -most, most);
  }
  if (!(std::abs(excess(t)) < std::abs(excess(0)))) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, positions.size(), kGrain), [&](const auto& range) {
    // What nothing disagrees about keeps its bits.
    for (std::size_t v = range.begin(); v != range.end(); ++v) positions[v] += t * directions[v];
  });
}

}  // namespace armature::sdk
