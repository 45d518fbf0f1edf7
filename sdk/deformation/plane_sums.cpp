#include "sdk/deformation/plane_sums.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "sdk/mesh/four.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using Corners = std::array<std::uint32_t, 3>;

/// The channels of PlaneSums in their order, for four triangles at a time.
constexpr std::size_t kChannels = 17;
using Totals = std::array<double, kChannels>;

ARMATURE_LANES void sum_triangles(const Corners* triangles, std::size_t count, const Vector3d* points,
                                  const Vector3d& origin, Totals& totals) noexcept {
  std::array<Four, kChannels> sums{};
  for (std::size_t t = 0; t < count; t += 4) {
    // Where there are fewer the others lie at the origin, without an area.
    std::array<std::array<const double*, 4>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t lane = 0; lane < 4; ++lane)
        corners[k][lane] = t + lane < count ? points[triangles[t + lane][k]].data() : origin.data();
    const Four ax{corners[0][0][0], corners[0][1][0], corners[0][2][0], corners[0][3][0]};
    const Four ay{corners[0][0][1], corners[0][1][1], corners[0][2][1], corners[0][3][1]};
    const Four az{corners[0][0][2], corners[0][1][2], corners[0][2][2], corners[0][3][2]};
    const Four bx{corners[1][0][0], corners[1][1][0], corners[1][2][0], corners[1][3][0]};
    const Four by{corners[1][0][1], corners[1][1][1], corners[1][2][1], corners[1][3][1]};
    const Four bz{corners[1][0][2], corners[1][1][2], corners[1][2][2], corners[1][3][2]};
    const Four cx{corners[2][0][0], corners[2][1][0], corners[2][2][0], corners[2][3][0]};
    const Four cy{corners[2][0][1], corners[2][1][1], corners[2][2][1], corners[2][3][1]};
    const Four cz{corners[2][0][2], corners[2][1][2], corners[2][2][2], corners[2][3][2]};
    const Four px = ax - origin.x(), py = ay - origin.y(), pz = az - origin.z();
    const Four ux = bx - ax, uy = by - ay, uz = bz - az;
    const Four vx = cx - ax, vy = cy - ay, vz = cz - az;
    const Four nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    const Four squared = nx * nx + ny * ny + nz * nz;
    const Four size{std::sqrt(squared[0]), std::sqrt(squared[1]), std::sqrt(squared[2]), std::sqrt(squared[3])};
    const Four inverse = 1 / (size + 1e-300);
    const Four d = nx * px + ny * py + nz * pz;
    const Four hx = nx * inverse, hy = ny * inverse, hz = nz * inverse;
    sums[0] += nx * hx, sums[1] += nx * hy, sums[2] += nx * hz;
    sums[3] += ny * hy, sums[4] += ny * hz, sums[5] += nz * hz;
    sums[6] += nx, sums[7] += ny, sums[8] += nz;
    sums[9] += size;
    sums[10] += hx * d, sums[11] += hy * d, sums[12] += hz * d;
    sums[13] += d;
    sums[14] += size * (px + (ux + vx) / 3), sums[15] += size * (py + (uy + vy) / 3);
    sums[16] += size * (pz + (uz + vz) / 3);
  }
  for (std::size_t k = 0; k < kChannels; ++k) totals[k] = (sums[k][0] + sums[k][1]) + (sums[k][2] + sums[k][3]);
}

}  // namespace

PlaneSums& PlaneSums::operator+=(const PlaneSums& other) noexcept {
  for (std::size_t k = 0; k < nn.size(); ++k) nn[k] += other.nn[k];
  for (std::size_t k = 0; k < 3; ++k) n[k] += other.n[k], nd[k] += other.nd[k], g[k] += other.g[k];
  size += other.size;
  d += other.d;
  return *this;
}

CellPlane CellPlane::of(const Vector3d& a, const Vector3d& b, const Vector3d& c) noexcept {
  const Vector3d normal = (b - a).cross(c - a) / 3;
  const double size = normal.norm();
  return {normal, size > 0 ? Vector3d(normal / size) : Vector3d::Zero(), size};
}

void PlaneSums::add_cell(const CellPlane& plane, const Vector3d& p, const Vector3d& sum) noexcept {
  const auto& [N, unit, length] = plane;
  // Two triangles of equal area, from p to the middle of a side and the middle of all: (p + (p + q + p + r) / 4 + (p +
  // q + r) / 3) / 3.
  const Vector3d middle = (15 * p + 7 * sum) / 36;
  const double at = N.dot(p);
  nn[0] += N.x() * unit.x(), nn[1] += N.x() * unit.y(), nn[2] += N.x() * unit.z();
  nn[3] += N.y() * unit.y(), nn[4] += N.y() * unit.z(), nn[5] += N.z() * unit.z();
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    n[k] += N[axis];
    nd[k] += unit[axis] * at;
    g[k] += length * middle[axis];
  }
  size += length;
  d += at;
}

SphericalQuadric PlaneSums::quadric(double regularise) const noexcept {
  // A face weighs |N| / 2, and A = 2 w (n;1)(n;1)', b = 2 w d (n;1) with n = N / |N|.
  SphericalQuadric quadric;
  const double hold = regularise * size;
  quadric.a = {nn[0] + hold, nn[1], nn[2], n[0], nn[3] + hold, nn[4], n[1], nn[5] + hold, n[2], size};
  for (std::size_t k = 0; k < 3; ++k) quadric.b[k] = nd[k] + regularise * g[k];
  quadric.b[3] = d;
  return quadric;
}

PlaneSums sum_of(std::span<const Corners> triangles, const std::vector<Vector3d>& points,
                 const Vector3d& origin) noexcept {
  Totals t;
  sum_triangles(triangles.data(), triangles.size(), points.data(), origin, t);
  return {.nn = {t[0], t[1], t[2], t[3], t[4], t[5]},
          .n = {t[6], t[7], t[8]},
          .size = t[9],
          .nd = {t[10], t[11], t[12]},
          .d = t[13],
          .g = {t[14], t[15], t[16]}};
}

}  // namespace armature::sdk
