#include "sdk/deformation/kept_volume.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include "sdk/deformation/skin_with_directions.h"
#include "sdk/mesh/four.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kMostOfRadius = 0.75;  // that the surface moves
constexpr int kRounds = 8;              // of Newton's method
constexpr std::size_t kGrain = 4096;    // quads that are summed in order, or vertices
constexpr std::size_t kAhead = 20;      // quads
constexpr std::size_t kLookedAt = 8;    // faces on a side: on one of a hostile mesh there may be all of them

/// SplitMix64's finaliser: edges become numbers that no few of them add up to zero by chance.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  return x ^ (x >> 31U);
}

/// Each edge is walked as often one way as the other.
bool is_closed(const Mesh& mesh) {
  std::uint64_t border = 0;
  for (const Triangle& corners : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint64_t a = corners[k].index();
      const std::uint64_t b = corners[(k + 1) % 3].index();
      const std::uint64_t edge = mixed(mixed(std::min(a, b) + 1) + std::max(a, b));
      border += a < b ? edge : a > b ? -edge : 0;
    }
  return border == 0;
}

/// The triangles of a mesh in twos, as far as that goes: two that walk a side either way. Those that come after one
/// another have corners near one another, if the mesh's vertices have. Without those that name a vertex twice.
std::vector<Quad> quads_of(const Mesh& mesh) {
  const Adjacency adjacency(mesh);
  std::vector<bool> taken(mesh.triangles.size(), false);
  std::vector<Quad> quads;
  quads.reserve(mesh.triangles.size() / 2);
  const auto number = [](VertexId v) { return static_cast<std::uint32_t>(v.index()); };
  // One that walks the side from corner k to the next one the other way.
  const auto partner = [&](FaceId face, std::size_t k) -> std::optional<Quad> {
    const Triangle& corners = mesh.triangle(face);
    const VertexId c = corners[k], a = corners[(k + 1) % 3], b = corners[(k + 2) % 3];
    const std::span<const FaceId> beside = adjacency.faces(adjacency.edges(face)[k]);
    for (const FaceId other : beside.first(std::min(beside.size(), kLookedAt))) {
      if (taken[other.index()]) continue;
      const Triangle& theirs = mesh.triangle(other);
      for (std::size_t j = 0; j < 3; ++j)
        if (theirs[j] == a && theirs[(j + 1) % 3] == c) {
          taken[other.index()] = true;
          return Quad{number(a), number(b), number(c), number(theirs[(j + 2) % 3])};
        }
    }
    return std::nullopt;
  };
  for (std::size_t t = 0; t < taken.size(); ++t) {
    if (taken[t] || repeats_a_vertex(mesh.triangles[t])) continue;
    taken[t] = true;
    std::optional<Quad> quad;
    for (std::size_t k = 0; k < 3 && !quad; ++k) quad = partner(FaceId(t), k);
    const Triangle& alone = mesh.triangles[t];
    quads.push_back(quad.value_or(Quad{number(alone[0]), number(alone[1]), number(alone[2]), number(alone[0])}));
  }
  std::ranges::stable_sort(quads, {}, [](const Quad& quad) { return std::ranges::min(quad); });
  return quads;
}

/// Six times the volume that the quads of a closed mesh enclose with their corners there.
double six_volumes(std::span<const Quad> quads, std::span<const Vector3d> positions) {
  // Near the mesh, or digits would cancel.
  const Vector3d apex = quads.empty() ? Vector3d(Vector3d::Zero()) : positions[quads[0][0]];
  double sum = 0;
  for (const auto& [a, b, c, d] : quads)
    sum += (positions[b] - positions[d]).dot((positions[c] - apex).cross(positions[a] - apex));
  return sum;
}

/// [V], in fours: the normals of a mesh, each as long as the radius of the spheres there, in the mean.
std::vector<FourDirections> outward_by_radius(const Mesh& mesh, const SkinWeights& weights,
                                              std::span<const Sphere> spheres) {
  std::vector<double> radii(mesh.positions.size());
  for (std::size_t s = 0; s < spheres.size(); ++s) {
    const WeightColumn& column = *weights.columns[s];
    for (std::size_t i = 0; i < column.vertices.size(); ++i)
      radii[column.vertices[i].index()] += static_cast<double>(column.weights[i]) * spheres[s].radius;
  }
  const std::vector<Vector3d> normals = vertex_normals(mesh);
  std::vector<FourDirections> outward((normals.size() + 3) / 4);
  for (std::size_t v = 0; v < normals.size(); ++v) {
    const Eigen::Vector3f direction = (radii[v] / weights.totals[v] * normals[v]).cast<float>();
    FourDirections& four = outward[v / 4];
    four.x[v % 4] = direction.x();
    four.y[v % 4] = direction.y();
    four.z[v % 4] = direction.z();
  }
  return outward;
}

/// Six volumes of x + t d are a cubic in t: its coefficients.
struct Cubic : std::array<double, 4> {
  Cubic operator+(const Cubic& other) const {
    Cubic sum = *this;
    for (std::size_t k = 0; k < 4; ++k) sum[k] += other[k];
    return sum;
  }
};

/// What four quads of a closed mesh add. Six volumes below a b c and a c d are e.n with e = b - d and n = c x a, seen
/// from the apex: products of three vectors that are linear in t.
ARMATURE_INLINE void add_four(const Quad* quads, const FourVectors& apex, const DirectedVertex* vertices,
                              std::array<Four, 4>& sums) {
  const auto corner = [&](std::size_t k) __attribute__((always_inline)) {
    return FourDirectedVertices::of(vertices[quads[0][k]], vertices[quads[1][k]], vertices[quads[2][k]],
                                    vertices[quads[3][k]]);
  };
  const auto [b, b1] = corner(1);
  const auto [d, d1] = corner(3);
  const FourVectors e = b - d, e1 = b1 - d1;
  const auto [from_a, a1] = corner(0);
  const auto [from_c, c1] = corner(2);
  const FourVectors a = from_a - apex, c = from_c - apex;
  const FourVectors n = cross(c, a), n1 = cross(c, a1) + cross(c1, a), n2 = cross(c1, a1);
  add_dot(e, n, sums[0]);
  add_dot(e1, n, sums[1]);
  add_dot(e, n1, sums[1]);
  add_dot(e1, n1, sums[2]);
  add_dot(e, n2, sums[2]);
  add_dot(e1, n2, sums[3]);
}

ARMATURE_LANES Cubic cubic_of(std::span<const Quad> quads, const Vector3d& apex, const DirectedVertex* vertices) {
  const FourVectors from = four_vectors(apex, apex, apex, apex);
  std::array<Four, 4> sums{};
  const std::size_t fours = quads.size() / 4 * 4;
  for (std::size_t q = 0; q < fours; q += 4) {
    // Corners lie here and there in more than fits near the processor: some quads ahead they are asked for.
    if (q + kAhead < fours)
      for (std::size_t k = q + kAhead; k < q + kAhead + 4; ++k)
        for (const std::uint32_t corner : quads[k]) __builtin_prefetch(&vertices[corner]);
    add_four(&quads[q], from, vertices, sums);
  }
  if (fours < quads.size()) {
    // The rest, and quads without area.
    const std::uint32_t corner = quads[fours][0];
    std::array<Quad, 4> rest;
    rest.fill({corner, corner, corner, corner});
    std::ranges::copy(quads.subspan(fours), rest.begin());
    add_four(rest.data(), from, vertices, sums);
  }
  Cubic cubic;
  for (std::size_t k = 0; k < 4; ++k) cubic[k] = sums[k][0] + sums[k][1] + sums[k][2] + sums[k][3];
  return cubic;
}

ARMATURE_LANES void move_along(double t, const DirectedVertex* vertices, std::size_t count, Vector3d* out) {
  for (std::size_t v = 0; v < count; ++v)
    for (std::size_t k = 0; k < 3; ++k)
      out[v][static_cast<Eigen::Index>(k)] =
          vertices[v].position[k] + t * static_cast<double>(vertices[v].direction[k]);
}

}  // namespace

KeptVolume::KeptVolume(const Mesh& mesh) {
  if (is_closed(mesh)) quads_ = quads_of(mesh);
}

void KeptVolume::set_rest(const Mesh& mesh, const SkinWeights& weights, std::span<const Sphere> spheres) {
  outward_ = outward_by_radius(mesh, weights, spheres);
  six_volumes_ = six_volumes(quads_, mesh.positions);
}

void KeptVolume::move(const SkinWeights& weights, std::span<const SphereMotion> motions, std::span<const Vector3d> rest,
                      std::span<Vector3d> out) {
  assert(has_rest() && out.size() == rest.size());
  moved_.resize(rest.size());
  const double t = share_of_directions(skin_with_directions(weights, motions, rest, outward_, moved_));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, out.size(), kGrain), [&](const auto& range) {
    // What nothing disagrees about keeps its bits.
    move_along(t, &moved_[range.begin()], range.size(), &out[range.begin()]);
  });
}

double KeptVolume::share_of_directions(double most_of_radius) const {
  if (!(most_of_radius > 0)) return 0;
  const Vector3d apex(moved_[quads_[0][0]].position.data());
  const Cubic f = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, quads_.size(), kGrain), Cubic{},
      [&](const auto& range, const Cubic& sum) {
        return sum + cubic_of(std::span(quads_).subspan(range.begin(), range.size()), apex, moved_.data());
      },
      std::plus{});
  const double most = kMostOfRadius / most_of_radius;
  const auto excess = [&](double t) { return f[0] + t * (f[1] + t * (f[2] + t * f[3])) - six_volumes_; };
  double t = 0;
  for (int round = 0; round < kRounds; ++round) {
    const double slope = f[1] + t * (2 * f[2] + t * 3 * f[3]);
    if (!(slope > 0)) break;  // the surface has folded over
    t = std::clamp(t - excess(t) / slope, -most, most);
  }
  return std::abs(excess(t)) < std::abs(excess(0)) ? t : 0;
}

}  // namespace armature::sdk
