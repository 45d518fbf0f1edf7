#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/deformation/skinning.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "sdk/deformation/skin_with_directions.h"
#include "sdk/mesh/four.h"

namespace armature::sdk {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

/// What is summed for a vertex, with the weights of its spheres: the motion less the one that changes nothing.
///   dual quaternions: turn x y z w | shift x y z w | (1 - s) c and s - 1, which stretch first
///   linear:           A - 1, column by column | shift
constexpr std::size_t kChannels = 12;
using Channels = std::array<double, kChannels>;
/// Turns that differ by less are one.
constexpr double kAgree = 1e-9;
/// So many vertices are worked on at a time: their sums stay in the cache next to the processor.
constexpr std::size_t kBlock = 256;

enum class Way : std::uint8_t { DualQuaternions, DualQuaternionsAndDirections, DualQuaternionsAndStretches, Linear };

/// The channels that are not zero throughout: the first ones.
constexpr std::size_t channels_of(Way way) {
  return way == Way::DualQuaternions || way == Way::DualQuaternionsAndDirections ? 8 : kChannels;
}
template <Way way>
using Sum = std::array<double, channels_of(way)>;
/// By vertex of a block.
template <Way way>
struct alignas(64) Sums : std::array<Sum<way>, kBlock> {};

Channels dual_quaternion(const SphereMotion& motion) {
  Quaterniond turn = motion.turn.normalized();
  if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
  // x -> turn x + shift, once it has been stretched about its centre.
  const Vector3d shift = motion.after.centre - turn * motion.before.centre;
  const Quaterniond half = Quaterniond(0, 0.5 * shift.x(), 0.5 * shift.y(), 0.5 * shift.z()) * turn;
  const double grow = motion.scale - 1;
  return {turn.x(),
          turn.y(),
          turn.z(),
          turn.w() - 1,
          half.x(),
          half.y(),
          half.z(),
          half.w(),
          -grow * motion.before.centre.x(),
          -grow * motion.before.centre.y(),
          -grow * motion.before.centre.z(),
          grow};
}

Channels matrix(const SphereMotion& motion) {
  const Eigen::Matrix3d A = motion.scale * motion.turn.normalized().toRotationMatrix();
  const Eigen::Matrix3d less = A - Eigen::Matrix3d::Identity();
  const Vector3d shift = motion.after.centre - A * motion.before.centre;
  Channels channels;
  std::copy_n(less.data(), 9, channels.begin());
  std::copy_n(shift.data(), 3, channels.begin() + 9);
  return channels;
}

/// One of the spheres that move.
struct Mover {
  const VertexId* vertices;
  const float* weights;
  std::size_t count;
  Channels channels;
};

struct Job {
  std::vector<Mover> movers = {};
  bool signs_agree = true;  // no two turns lie more than 180 degrees apart as quaternions
  std::span<const double> totals;
  std::span<const Vector3d> rest;
  std::span<Vector3d> out = {};
  // Instead of `out` where directions are asked for:
  std::span<const FourDirections> outward = {};
  std::span<DirectedVertex> directed = {};
};

/// Calls f(i, v) for each entry of a sphere that lies in the block; returns where the next block begins.
template <class F>
ARMATURE_INLINE std::size_t for_each_entry(const Mover& mover, std::size_t from, std::size_t first, F&& f) {
  std::size_t i = from;
  for (; i < mover.count && mover.vertices[i].index() < first + kBlock; ++i) f(i, mover.vertices[i].index() - first);
  return i;
}

template <Way way>
ARMATURE_INLINE void add(const Channels& channels, double weight, Sum<way>& sum) {
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += weight * channels[k];
}

/// Turns that lie far apart: the sign of each quaternion is chosen vertex by vertex, to agree with what has been added
/// up. `sum` is whole, not less the motion that changes nothing.
template <Way way>
ARMATURE_INLINE void add_agreeing(const Channels& channels, double weight, Sum<way>& sum) {
  Channels whole = channels;
  whole[3] += 1;
  const double agreement = sum[0] * whole[0] + sum[1] * whole[1] + sum[2] * whole[2] + sum[3] * whole[3];
  const double sign = agreement < 0 ? -1 : 1;
  for (std::size_t k = 0; k < 8; ++k) sum[k] += sign * weight * whole[k];
  for (std::size_t k = 8; k < sum.size(); ++k) sum[k] += weight * whole[k];
}

/// Four channels of four vertices.
struct FourSums {
  Four a, b, c, d;

  /// The channels [first, first + 4).
  template <class Sum>
  ARMATURE_INLINE FourSums(const Sum* sums, std::size_t first)
      : a(reinterpret_cast<const FourAnywhere&>(sums[0][first])),
        b(reinterpret_cast<const FourAnywhere&>(sums[1][first])),
        c(reinterpret_cast<const FourAnywhere&>(sums[2][first])),
        d(reinterpret_cast<const FourAnywhere&>(sums[3][first])) {
    transpose(a, b, c, d);
  }
};

ARMATURE_INLINE FourVectors four_of(const Vector3d* v) {
  return four_vectors(v[0], v[1], v[2], v[3]);
}
ARMATURE_INLINE void store(const FourVectors& four, Vector3d* v) {
  for (int k = 0; k < 4; ++k) v[k] = {four.x[k], four.y[k], four.z[k]};
}

/// What the turns of four vertices are blended to, of any length.
struct BlendedTurns {
  FourVectors b;
  Four bw;
  Four squared;  // length

  template <class Sum>
  ARMATURE_INLINE BlendedTurns(const Sum* sums, const Four& all) {
    const auto [x, y, z, less] = FourSums(sums, 0);
    b = {x, y, z};
    bw = all + less;
    squared = x * x + y * y + z * z + bw * bw;
  }
  /// What is added to vectors that are turned, and then shifted by dual parts, if any.
  ARMATURE_INLINE FourVectors change(const FourVectors& v) const {
    return 2 / squared * cross(b, cross(b, v) + bw * v);
  }
  ARMATURE_INLINE FourVectors change(const FourVectors& v, const FourVectors& e, const Four& ew) const {
    return 2 / squared * (cross(b, cross(b, v) + bw * v + e) + bw * e - ew * b);
  }
};

template <class Sum>
ARMATURE_INLINE FourVectors moved_by_dual_quaternions(const BlendedTurns& turns, const Sum* sums,
                                                      const FourVectors& v) {
  const auto [ex, ey, ez, ew] = FourSums(sums, 4);
  return v + turns.change(v, {ex, ey, ez}, ew);
}

template <class Sum>
ARMATURE_INLINE FourVectors stretched(const Sum* sums, const Four& all, const FourVectors& v) {
  const auto [x, y, z, grow] = FourSums(sums, 8);
  return v + 1 / all * (FourVectors{x, y, z} + grow * v);
}

template <class Sum>
ARMATURE_INLINE FourVectors moved_linearly(const Sum* sums, const Four& all, const FourVectors& v) {
  const auto [xx, yx, zx, xy] = FourSums(sums, 0);
  const auto [yy, zy, xz, yz] = FourSums(sums, 4);
  const auto [zz, tx, ty, tz] = FourSums(sums, 8);
  const FourVectors less{xx * v.x + xy * v.y + xz * v.z + tx, yx * v.x + yy * v.y + yz * v.z + ty,
                         zx * v.x + zy * v.y + zz * v.z + tz};
  return v + 1 / all * less;
}

/// Moves four vertices.
template <Way way>
ARMATURE_INLINE void move_four(const Sum<way>* sums, const double* totals, const Vector3d* rest, Vector3d* out) {
  Four all;
  std::memcpy(&all, totals, sizeof all);
  FourVectors v = four_of(rest);
  if constexpr (way == Way::Linear) {
    v = moved_linearly(sums, all, v);
  } else {
    if constexpr (way == Way::DualQuaternionsAndStretches) v = stretched(sums, all, v);
    v = moved_by_dual_quaternions(BlendedTurns(sums, all), sums, v);
  }
  store(v, out);
}

/// The same, and turns their directions, shortened to how much the turns disagree.
ARMATURE_INLINE void direct_four(const Sum<Way::DualQuaternionsAndDirections>* sums, const double* totals,
                                 const Vector3d* rest, const FourDirections& outward, DirectedVertex* directed,
                                 Four& most) {
  Four all;
  std::memcpy(&all, totals, sizeof all);
  const BlendedTurns turns(sums, all);
  const FourVectors positions = moved_by_dual_quaternions(turns, sums, four_of(rest));
  const Four differ = 1 - turns.squared / (all * all);
  const Four disagree = differ > kAgree ? differ : differ * 0;
  most = disagree > most ? disagree : most;
  const FourVectors v = outward.vectors();
  FourDirectedVertices{positions, disagree * (v + turns.change(v))}.store(directed);
}

/// Moves the vertices of a block; the most by which turns disagree, where directions are asked for.
template <Way way>
ARMATURE_INLINE double move_block(const Job& job, std::size_t first, const Sums<way>& sums) {
  constexpr bool kDirects = way == Way::DualQuaternionsAndDirections;
  Four most{};
  const std::size_t end = std::min(first + kBlock, job.rest.size());
  const std::size_t fours = end / 4 * 4;
  for (std::size_t v = first; v < fours; v += 4) {
    if constexpr (kDirects)
      direct_four(&sums[v - first], &job.totals[v], &job.rest[v], job.outward[v / 4], &job.directed[v], most);
    else
      move_four<way>(&sums[v - first], &job.totals[v], &job.rest[v], &job.out[v]);
  }
  if (fours < end) {
    std::array<double, 4> totals{1, 1, 1, 1};
    std::array<Vector3d, 4> x;
    x.fill(Vector3d::Zero());
    std::copy(&job.totals[fours], job.totals.data() + end, totals.begin());
    std::copy(&job.rest[fours], job.rest.data() + end, x.begin());
    if constexpr (kDirects) {
      std::array<DirectedVertex, 4> directed;
      direct_four(&sums[fours - first], totals.data(), x.data(), job.outward[fours / 4], directed.data(), most);
      std::copy_n(directed.begin(), end - fours, &job.directed[fours]);
    } else {
      move_four<way>(&sums[fours - first], totals.data(), x.data(), x.data());
      std::copy_n(x.begin(), end - fours, &job.out[fours]);
    }
  }
  return std::max({most[0], most[1], most[2], most[3]});
}

/// What no sphere reaches stays.
template <Way way>
ARMATURE_INLINE void leave_block(const Job& job, std::size_t first) {
  const std::size_t end = std::min(first + kBlock, job.rest.size());
  if constexpr (way == Way::DualQuaternionsAndDirections) {
    for (std::size_t v = first; v < end; ++v)
      job.directed[v] = {{job.rest[v].x(), job.rest[v].y(), job.rest[v].z()}, {}};
  } else if (job.rest.data() != job.out.data()) {
    std::copy(&job.rest[first], job.rest.data() + end, &job.out[first]);
  }
}

/// The most by which turns disagree, where directions are asked for.
template <Way way>
ARMATURE_INLINE double skin_blocks(const Job& job, std::size_t begin, std::size_t end) {
  const auto& movers = job.movers;
  // Where each sphere's entries for the next block begin, and in which vertex.
  std::vector<std::size_t> at(movers.size());
  std::vector<std::size_t> next(movers.size());
  const auto go_on = [&](std::size_t m, std::size_t i) {
    at[m] = i;
    next[m] = i < movers[m].count ? movers[m].vertices[i].index() : job.rest.size();
  };
  for (std::size_t m = 0; m < movers.size(); ++m) {
    const auto* const last = movers[m].vertices + movers[m].count;
    const auto* const found = std::lower_bound(movers[m].vertices, last, VertexId(begin * kBlock));
    go_on(m, static_cast<std::size_t>(found - movers[m].vertices));
  }
  Sums<way> sums;
  double most = 0;
  std::vector<std::size_t> here;
  for (std::size_t first = begin * kBlock; first < end * kBlock; first += kBlock) {
    here.clear();
    for (std::size_t m = 0; m < movers.size(); ++m)
      if (next[m] < first + kBlock) here.push_back(m);
    const std::size_t count = std::min(kBlock, job.rest.size() - first);
    if (here.empty()) {
      leave_block<way>(job, first);
      continue;
    }
    for (Sum<way>& sum : sums) sum.fill(0);
    if (job.signs_agree) {
      for (const std::size_t m : here) {
        const Channels channels = movers[m].channels;
        go_on(m, for_each_entry(movers[m], at[m], first, [&](std::size_t i, std::size_t v) {
                add<way>(channels, static_cast<double>(movers[m].weights[i]), sums[v]);
              }));
      }
    } else {
      // Unmoved spheres weigh what is left.
      for (std::size_t v = 0; v < count; ++v) sums[v][3] = job.totals[first + v];
      for (const std::size_t m : here)
        for_each_entry(movers[m], at[m], first,
                       [&](std::size_t i, std::size_t v) { sums[v][3] -= static_cast<double>(movers[m].weights[i]); });
      for (const std::size_t m : here)
        go_on(m, for_each_entry(movers[m], at[m], first, [&](std::size_t i, std::size_t v) {
                add_agreeing<way>(movers[m].channels, static_cast<double>(movers[m].weights[i]), sums[v]);
              }));
      for (std::size_t v = 0; v < count; ++v) sums[v][3] -= job.totals[first + v];
    }
    most = std::max(most, move_block<way>(job, first, sums));
  }
  return most;
}

ARMATURE_LANES double skin_linearly(const Job& job, std::size_t begin, std::size_t end) {
  return skin_blocks<Way::Linear>(job, begin, end);
}
ARMATURE_LANES double skin_by_dual_quaternions(const Job& job, std::size_t begin, std::size_t end) {
  return skin_blocks<Way::DualQuaternions>(job, begin, end);
}
ARMATURE_LANES double skin_by_directed_dual_quaternions(const Job& job, std::size_t begin, std::size_t end) {
  return skin_blocks<Way::DualQuaternionsAndDirections>(job, begin, end);
}
ARMATURE_LANES double skin_by_stretched_dual_quaternions(const Job& job, std::size_t begin, std::size_t end) {
  return skin_blocks<Way::DualQuaternionsAndStretches>(job, begin, end);
}

/// Whether no two of the turns are more than 180 degrees apart as quaternions, the one that changes nothing included.
bool signs_agree(const std::vector<Mover>& movers) {
  constexpr std::size_t kMost = 256;
  if (movers.size() > kMost) return false;
  for (std::size_t i = 0; i < movers.size(); ++i) {
    const Channels& a = movers[i].channels;
    for (std::size_t j = 0; j < i; ++j) {
      const Channels& b = movers[j].channels;
      if (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + (a[3] + 1) * (b[3] + 1) < 0) return false;
    }
  }
  return true;
}

double skin(Job job, const SkinWeights& weights, std::span<const SphereMotion> motions, Blend blend) {
  assert(motions.size() == weights.columns.size() && job.rest.size() == weights.totals.size());
  bool stretches = false;
  for (std::size_t s = 0; s < motions.size(); ++s) {
    if (motions[s].moves_nothing()) continue;
    const WeightColumn& column = *weights.columns[s];
    job.movers.push_back({column.vertices.data(), column.weights.data(), column.vertices.size(),
                          blend == Blend::Linear ? matrix(motions[s]) : dual_quaternion(motions[s])});
    stretches = stretches || motions[s].scale != 1;
  }
  job.signs_agree = blend == Blend::Linear || signs_agree(job.movers);
  assert(job.directed.empty() || !stretches);
  const auto run = blend == Blend::Linear  ? skin_linearly
                   : !job.directed.empty() ? skin_by_directed_dual_quaternions
                   : stretches             ? skin_by_stretched_dual_quaternions
                                           : skin_by_dual_quaternions;
  const std::size_t blocks = (job.rest.size() + kBlock - 1) / kBlock;
  constexpr std::size_t kBlocksAtATime = 32;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, blocks, kBlocksAtATime), 0.0,
      [&](const auto& range, double most) { return std::max(most, run(job, range.begin(), range.end())); },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace

bool only_turn(std::span<const SphereMotion> motions) {
  Eigen::AlignedBox3d box;
  for (const SphereMotion& motion : motions) box.extend(motion.before.centre);
  const double length = box.isEmpty() ? 0 : box.diagonal().norm();
  return std::ranges::all_of(motions, [&](const SphereMotion& motion) { return motion.only_turns(length); });
}

void skin(const SkinWeights& weights, std::span<const SphereMotion> motions, Blend blend,
          std::span<const Vector3d> rest, std::span<Vector3d> out) {
  assert(out.size() == rest.size());
  skin({.totals = weights.totals, .rest = rest, .out = out}, weights, motions, blend);
}

double skin_with_directions(const SkinWeights& weights, std::span<const SphereMotion> motions,
                            std::span<const Vector3d> rest, std::span<const FourDirections> outward,
                            std::span<DirectedVertex> directed) {
  assert(outward.size() == (rest.size() + 3) / 4 && directed.size() == rest.size());
  return skin({.totals = weights.totals, .rest = rest, .outward = outward, .directed = directed}, weights, motions,
              Blend::DualQuaternions);
}

}  // namespace armature::sdk
