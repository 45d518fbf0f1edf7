#include "sdk/descriptors/cluster_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "sdk/mesh/four.h"

namespace armature::sdk {
namespace {

constexpr std::int32_t kReach = 1 << 20;  // cells from the origin to the rim

constexpr std::array kColumns = {&ClusterColumns::x,    &ClusterColumns::y,  &ClusterColumns::z,
                                 &ClusterColumns::nx,   &ClusterColumns::ny, &ClusterColumns::nz,
                                 &ClusterColumns::area, &ClusterColumns::pn, &ClusterColumns::pp};

ClusterGrid::Cell cell_at(const Eigen::Vector3d& place, double size) noexcept {
  ClusterGrid::Cell cell{};
  for (Eigen::Index k = 0; k < 3; ++k)
    cell[static_cast<std::size_t>(k)] =
        static_cast<std::int32_t>(std::clamp(std::floor(place[k] / size), 1.0 - kReach, kReach - 2.0));
  return cell;
}

/// Who lies together, in the order of the cells.
struct Sorted {
  std::vector<std::uint32_t> order;
  std::vector<std::uint64_t> keys;  // in that order
};
Sorted sorted_by(std::vector<std::uint64_t> keys) {
  Sorted sorted;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> pairs(keys.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i) pairs[i] = {keys[i], i};
  std::ranges::sort(pairs);
  sorted.order.reserve(pairs.size());
  sorted.keys.reserve(pairs.size());
  for (const auto& [key, i] : pairs) {
    sorted.order.push_back(i);
    sorted.keys.push_back(key);
  }
  return sorted;
}

constexpr std::size_t kLanes = 4;

/// x, y, z about the place, sums in the order weight, p, n, p.n, p.p.
ARMATURE_LANES void add_weighted(const ClusterColumns& c, const double* place, double inverse_t2,
                                 double* sums) noexcept {
  Four w0{}, px{}, py{}, pz{}, nx{}, ny{}, nz{}, pn{}, pp{};
  const double qx = place[0], qy = place[1], qz = place[2];
  for (std::size_t i = 0; i < c.size(); i += kLanes) {
    Four x, y, z, area, mx, my, mz, off_pn, off_pp;
    const auto load = [i](Four& four, const std::vector<double>& column) {
      std::memcpy(&four, column.data() + i, sizeof four);
    };
    load(x, c.x), load(y, c.y), load(z, c.z), load(area, c.area);
    load(mx, c.nx), load(my, c.ny), load(mz, c.nz), load(off_pn, c.pn), load(off_pp, c.pp);
    x -= qx, y -= qy, z -= qz;
    const Four d2 = x * x + y * y + z * z;
    const Four inside = 1 - d2 * inverse_t2;
    const Four in = inside > 0 ? inside : Four{};
    const Four k = in * in;
    const Four w = k * area;
    mx *= k, my *= k, mz *= k;
    w0 += w;
    px += w * x, py += w * y, pz += w * z;
    nx += mx, ny += my, nz += mz;
    pn += mx * x + my * y + mz * z + k * off_pn;
    pp += w * d2 + k * off_pp;
  }
  for (const Four* of : {&w0, &px, &py, &pz, &nx, &ny, &nz, &pn, &pp})
    *sums++ = ((*of)[0] + (*of)[1]) + ((*of)[2] + (*of)[3]);
}

}  // namespace

void ClusterColumns::append(const ClusterColumns& others, std::size_t begin, std::size_t end) {
  for (const auto column : kColumns) {
    const auto& from = others.*column;
    (this->*column)
        .insert((this->*column).end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
                from.begin() + static_cast<std::ptrdiff_t>(end));
  }
}
void ClusterColumns::append_near(const ClusterColumns& others, const Eigen::AlignedBox3d& box, double distance) {
  const Eigen::Vector3d low = box.min();
  const Eigen::Vector3d high = box.max();
  thread_local std::vector<std::uint32_t> near;
  near.resize(others.size());
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < others.size(); ++i) {
    const double dx = std::max({0.0, low.x() - others.x[i], others.x[i] - high.x()});
    const double dy = std::max({0.0, low.y() - others.y[i], others.y[i] - high.y()});
    const double dz = std::max({0.0, low.z() - others.z[i], others.z[i] - high.z()});
    near[count] = i;
    count += dx * dx + dy * dy + dz * dz < distance * distance ? 1U : 0U;
  }
  for (const auto column : kColumns) {
    auto& to = this->*column;
    const auto& from = others.*column;
    const std::size_t first = to.size();
    to.resize(first + count);
    for (std::size_t k = 0; k < count; ++k) to[first + k] = from[near[k]];
  }
}
void ClusterColumns::clear() {
  for (const auto column : kColumns) (this->*column).clear();
}
void ClusterColumns::pad(std::size_t block) {
  const std::size_t size = (this->size() + block - 1) / block * block;
  for (const auto column : kColumns) (this->*column).resize(size, 0.0);
}

std::uint64_t ClusterGrid::key(const Cell& cell) noexcept {
  const auto part = [](std::int32_t i) { return static_cast<std::uint64_t>(i + kReach); };
  return part(cell[2]) << 42U | part(cell[1]) << 21U | part(cell[0]);
}

ClusterGrid::Cell ClusterGrid::cell_of(const Eigen::Vector3d& place) const noexcept {
  return cell_at(place, scale_);
}

ClusterGrid::ClusterGrid(const PointSet& points, const Eigen::Vector3d& origin, double scale, double cluster)
    : scale_(scale) {
  std::vector<std::uint32_t> used;
  used.reserve(points.positions.size());
  const auto area = [&](std::uint32_t i) { return points.areas.empty() ? 1.0 : points.areas[i]; };
  for (std::uint32_t i = 0; i < points.positions.size(); ++i)
    if (area(i) > 0 && !points.normals[i].isZero(0)) used.push_back(i);
  const auto place = [&](std::uint32_t i) { return Eigen::Vector3d(points.positions[i] - origin); };

  // Cubes first, then the cells that their means lie in.
  std::vector<std::uint64_t> cubes(used.size());
  for (std::size_t i = 0; i < used.size(); ++i) cubes[i] = cluster > 0 ? key(cell_at(place(used[i]), cluster)) : i;
  const Sorted by_cube = sorted_by(std::move(cubes));
  ClusterColumns unsorted;
  std::vector<std::uint64_t> cells;
  for (std::size_t begin = 0; begin < used.size();) {
    std::size_t end = begin;
    double weight = 0;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (; end < used.size() && by_cube.keys[end] == by_cube.keys[begin]; ++end) {
      const std::uint32_t i = used[by_cube.order[end]];
      weight += area(i);
      mean += area(i) * place(i);
      normal += area(i) * points.normals[i];
    }
    mean = end == begin + 1 ? place(used[by_cube.order[begin]]) : Eigen::Vector3d(mean / weight);
    double pn = 0;
    double pp = 0;
    for (std::size_t k = begin; k < end; ++k) {
      const std::uint32_t i = used[by_cube.order[k]];
      const Eigen::Vector3d off = place(i) - mean;
      pn += area(i) * off.dot(points.normals[i]);
      pp += area(i) * off.squaredNorm();
    }
    const std::array<double, 9> row = {mean.x(),   mean.y(), mean.z(), normal.x(), normal.y(),
                                       normal.z(), weight,   pn,       pp};
    for (std::size_t k = 0; k < kColumns.size(); ++k) (unsorted.*kColumns[k]).push_back(row[k]);
    cells.push_back(key(cell_at(mean, scale)));
    begin = end;
  }
  const Sorted by_cell = sorted_by(std::move(cells));
  for (const auto column : kColumns) {
    (clusters_.*column).reserve(by_cell.order.size());
    for (const std::uint32_t i : by_cell.order) (clusters_.*column).push_back((unsorted.*column)[i]);
  }
  for (std::uint32_t i = 0; i < by_cell.keys.size(); ++i)
    if (i == 0 || by_cell.keys[i] != by_cell.keys[i - 1]) {
      keys_.push_back(by_cell.keys[i]);
      starts_.push_back(i);
    }
  starts_.push_back(static_cast<std::uint32_t>(by_cell.keys.size()));
}

void ClusterGrid::gather(const Cell& about, ClusterColumns& out) const {
  for (const std::int32_t dz : {-1, 0, 1})
    for (const std::int32_t dy : {-1, 0, 1}) {
      const auto row = [&](std::int32_t dx) { return key({about[0] + dx, about[1] + dy, about[2] + dz}); };
      const auto first = std::ranges::lower_bound(keys_, row(-1));
      auto last = first;
      while (last != keys_.end() && *last <= row(1)) ++last;
      if (first != last)
        out.append(clusters_, starts_[static_cast<std::size_t>(first - keys_.begin())],
                   starts_[static_cast<std::size_t>(last - keys_.begin())]);
    }
}

GlsSums weighted_sums(const ClusterColumns& clusters, const Eigen::Vector3d& place, double scale) noexcept {
  std::array<double, 9> s{};
  add_weighted(clusters, place.data(), 1 / (scale * scale), s.data());
  return {.weight = s[0], .p = {s[1], s[2], s[3]}, .n = {s[4], s[5], s[6]}, .pn = s[7], .pp = s[8]};
}

std::array<GlsSums, 4> weighted_sum_rates(const ClusterColumns& c, const Eigen::Vector3d& place,
                                          double scale) noexcept {
  const double t2 = scale * scale;
  std::array<GlsSums, 4> rates;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const Eigen::Vector3d p = Eigen::Vector3d(c.x[i], c.y[i], c.z[i]) - place;
    const Eigen::Vector3d n(c.nx[i], c.ny[i], c.nz[i]);
    const double d2 = p.squaredNorm();
    const double inside = 1 - d2 / t2;
    if (!(inside > 0)) continue;
    for (std::size_t k = 0; k < rates.size(); ++k) {
      const double rate = k < 3 ? 4 * inside * p[static_cast<Eigen::Index>(k)] / t2 : 4 * inside * d2 / (t2 * scale);
      rates[k] += {.weight = rate * c.area[i],
                   .p = rate * c.area[i] * p,
                   .n = rate * n,
                   .pn = rate * (p.dot(n) + c.pn[i]),
                   .pp = rate * (c.area[i] * d2 + c.pp[i])};
    }
  }
  return rates;
}

}  // namespace armature::sdk
