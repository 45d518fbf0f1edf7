#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <vector>

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
/// By vertex of a block.
using Sums = std::array<Channels, kBlock>;

enum class Way : std::uint8_t { DualQuaternions, DualQuaternionsAndStretches, Linear };

/// Channels that are not zero throughout.
constexpr std::size_t channels_of(Way way) {
  return way == Way::DualQuaternions ? 8 : kChannels;
}

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
  std::span<Vector3d> out;
  // Or empty:
  std::span<const Vector3d> outward = {};
  std::span<Vector3d> directions = {};
};

/// Calls f(i, v) for each entry of a sphere that lies in the block; returns where the next block begins.
template <class F>
ARMATURE_INLINE std::size_t for_each_entry(const Mover& mover, std::size_t from, std::size_t first, F&& f) {
  std::size_t i = from;
  for (; i < mover.count && mover.vertices[i].index() < first + kBlock; ++i) f(i, mover.vertices[i].index() - first);
  return i;
}

template <Way way>
ARMATURE_INLINE void add(const Channels& channels, double weight, Channels& sum) {
  for (std::size_t k = 0; k < channels_of(way); ++k) sum[k] += weight * channels[k];
}

/// Turns that lie far apart: the sign of each quaternion is chosen vertex by vertex, to agree with what has been added
/// up. `sum` is whole, not less the motion that changes nothing.
ARMATURE_INLINE void add_agreeing(const Channels& channels, double weight, Channels& sum) {
  Channels whole = channels;
  whole[3] += 1;
  const double agreement = sum[0] * whole[0] + sum[1] * whole[1] + sum[2] * whole[2] + sum[3] * whole[3];
  const double sign = agreement < 0 ? -1 : 1;
  for (std::size_t k = 0; k < 8; ++k) sum[k] += sign * weight * whole[k];
  for (std::size_t k = 8; k < kChannels; ++k) sum[k] += weight * whole[k];
}

/// Channels [first, first + 4) of four vertices.
ARMATURE_INLINE std::array<Four, 4> lanes(const Channels* sums, std::size_t first) {
  std::array<Four, 4> rows;
  for (std::size_t v = 0; v < 4; ++v) std::memcpy(&rows[v], sums[v].data() + first, sizeof(Four));
  transpose(rows[0], rows[1], rows[2], rows[3]);
  return rows;
}

ARMATURE_INLINE FourVectors four_of(const Vector3d* v) {
  return four_vectors(v[0], v[1], v[2], v[3]);
}
ARMATURE_INLINE void store(const FourVectors& four, Vector3d* v) {
  for (int k = 0; k < 4; ++k) v[k] = {four.x[k], four.y[k], four.z[k]};
}

/// Turns four vectors by blended turns, and shortens them to how much these disagree.
ARMATURE_INLINE void direct_four(const Channels* sums, const double* totals, const Vector3d* outward,
                                 Vector3d* directions, Four& most) {
  Four all;
  std::memcpy(&all, totals, sizeof all);
  const auto [bx, by, bz, less] = lanes(sums, 0);
  const Four bw = all + less;
  const Four squared = bx * bx + by * by + bz * bz + bw * bw;
  const Four differ = 1 - squared / (all * all);
  const Four disagree = differ > kAgree ? differ : differ * 0;
  const FourVectors b{bx, by, bz};
  const FourVectors v = four_of(outward);
  const Four twice = 2 / squared;
  store(disagree * (v + twice * cross(b, cross(b, v) + bw * v)), directions);
  most = disagree > most ? disagree : most;
}

/// Moves four vertices.
template <Way way>
ARMATURE_INLINE void move_four(const Channels* sums, const double* totals, const Vector3d* rest, Vector3d* out) {
  Four all;
  std::memcpy(&all, totals, sizeof all);
  auto [x, y, z] = four_of(rest);
  if constexpr (way == Way::Linear) {
    const Four part = 1 / all;
    const auto [xx, yx, zx, xy] = lanes(sums, 0);
    const auto [yy, zy, xz, yz] = lanes(sums, 4);
    const auto [zz, tx, ty, tz] = lanes(sums, 8);
    const Four px = x, py = y, pz = z;
    x += part * (xx * px + xy * py + xz * pz + tx);
    y += part * (yx * px + yy * py + yz * pz + ty);
    z += part * (zx * px + zy * py + zz * pz + tz);
  } else {
    if constexpr (way == Way::DualQuaternionsAndStretches) {
      const Four part = 1 / all;
      const auto [sx, sy, sz, grow] = lanes(sums, 8);
      x += part * (sx + grow * x);
      y += part * (sy + grow * y);
      z += part * (sz + grow * z);
    }
    const auto [bx, by, bz, less] = lanes(sums, 0);
    const auto [ex, ey, ez, ew] = lanes(sums, 4);
    const Four bw = all + less;
    const Four twice = 2 / (bx * bx + by * by + bz * bz + bw * bw);
    const Four cx = by * z - bz * y + bw * x;
    const Four cy = bz * x - bx * z + bw * y;
    const Four cz = bx * y - by * x + bw * z;
    x += twice * (by * cz - bz * cy + bw * ex - ew * bx + by * ez - bz * ey);
    y += twice * (bz * cx - bx * cz + bw * ey - ew * by + bz * ex - bx * ez);
    z += twice * (bx * cy - by * cx + bw * ez - ew * bz + bx * ey - by * ex);
  }
  store({x, y, z}, out);
}

/// Calls f(sums, totals, in, out) for each four vertices of a block.
template <class F>
ARMATURE_INLINE void for_each_four(const Job& job, std::size_t first, const Sums& sums, std::span<const Vector3d> in,
                                   std::span<Vector3d> out, const F& f) {
  const std::size_t count = std::min(kBlock, in.size() - first);
  const std::size_t fours = count / 4 * 4;
  for (std::size_t v = 0; v < fours; v += 4) f(&sums[v], &job.totals[first + v], &in[first + v], &out[first + v]);
  if (fours == count) return;
  std::array<double, 4> totals{1, 1, 1, 1};
  std::array<Vector3d, 4> x;
  x.fill(Vector3d::Zero());
  std::copy_n(&job.totals[first + fours], count - fours, totals.begin());
  std::copy_n(&in[first + fours], count - fours, x.begin());
  f(&sums[fours], totals.data(), x.data(), x.data());
  std::copy_n(x.begin(), count - fours, &out[first + fours]);
}

/// Moves the vertices of a block; the most by which turns disagree, if that is asked for.
template <Way way>
ARMATURE_INLINE double move(const Job& job, std::size_t first, const Sums& sums) {
  Four most{};
  if (way != Way::Linear && !job.directions.empty()) {
    const auto direct = [&](const Channels* sum, const double* totals, const Vector3d* in, Vector3d* out)
        __attribute__((always_inline)) {
      direct_four(sum, totals, in, out, most);
    };
    for_each_four(job, first, sums, job.outward, job.directions, direct);
  }
  const auto moving =
      [](const Channels* sum, const double* totals, const Vector3d* in, Vector3d* out) __attribute__((always_inline)) {
    move_four<way>(sum, totals, in, out);
  };
  for_each_four(job, first, sums, job.rest, job.out, moving);
  return std::max({most[0], most[1], most[2], most[3]});
}

/// The most by which turns disagree, if that is asked for.
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
  Sums sums;
  double most = 0;
  std::vector<std::size_t> here;
  for (std::size_t first = begin * kBlock; first < end * kBlock; first += kBlock) {
    here.clear();
    for (std::size_t m = 0; m < movers.size(); ++m)
      if (next[m] < first + kBlock) here.push_back(m);
    const std::size_t count = std::min(kBlock, job.rest.size() - first);
    if (here.empty()) {
      if (job.rest.data() != job.out.data()) std::copy_n(&job.rest[first], count, &job.out[first]);
      if (!job.directions.empty()) std::fill_n(&job.directions[first], count, Vector3d::Zero());
      continue;
    }
    for (Channels& sum : sums)
      for (std::size_t k = 0; k < channels_of(way); ++k) sum[k] = 0;
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
                add_agreeing(movers[m].channels, static_cast<double>(movers[m].weights[i]), sums[v]);
              }));
      for (std::size_t v = 0; v < count; ++v) sums[v][3] -= job.totals[first + v];
    }
    most = std::max(most, move<way>(job, first, sums));
  }
  return most;
}

ARMATURE_LANES double skin_linearly(const Job& job, std::size_t begin, std::size_t end) {
  return skin_blocks<Way::Linear>(job, begin, end);
}
ARMATURE_LANES double skin_by_dual_quaternions(const Job& job, std::size_t begin, std::size_t end) {
  return skin_blocks<Way::DualQuaternions>(job, begin, end);
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
  assert(motions.size() == weights.columns.size() && job.rest.size() == weights.totals.size() &&
         job.out.size() == job.rest.size());
  bool stretches = false;
  for (std::size_t s = 0; s < motions.size(); ++s) {
    if (motions[s].moves_nothing()) continue;
    const WeightColumn& column = *weights.columns[s];
    job.movers.push_back({column.vertices.data(), column.weights.data(), column.vertices.size(),
                          blend == Blend::Linear ? matrix(motions[s]) : dual_quaternion(motions[s])});
    stretches = stretches || motions[s].scale != 1;
  }
  job.signs_agree = blend == Blend::Linear || signs_agree(job.movers);
  const auto run = blend == Blend::Linear ? skin_linearly
                   : stretches            ? skin_by_stretched_dual_quaternions
                                          : skin_by_dual_quaternions;
  const std::size_t blocks = (job.rest.size() + kBlock - 1) / kBlock;
  constexpr std::size_t kBlocksAtATime = 32;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, blocks, kBlocksAtATime), 0.0,
      [&](const auto& range, double most) { return std::max(most, run(job, range.begin(), range.end())); },
      [](double a, double b) { return std::max(a, b); });
}

}  // namespace

void skin(const SkinWeights& weights, std::span<const SphereMotion> motions, Blend blend,
          std::span<const Vector3d> rest, std::span<Vector3d> out) {
  skin({.totals = weights.totals, .rest = rest, .out = out}, weights, motions, blend);
}

double skin_with_directions(const SkinWeights& weights, std::span<const SphereMotion> motions,
                            std::span<const Vector3d> rest, std::span<Vector3d> out, std::span<const Vector3d> outward,
                            std::span<Vector3d> directions) {
  assert(outward.size() == rest.size() && directions.size() == rest.size());
  return skin({.totals = weights.totals, .rest = rest, .out = out, .outward = outward, .directions = directions},
              weights, motions, Blend::DualQuaternions);
}

}  // namespace armature::sdk
