#include "sdk/mesh/point_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <tbb/parallel_for.h>

#include "sdk/mesh/lengths.h"
#include "sdk/mesh/nearest_point.h"

namespace armature::sdk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint32_t kNobody = 0xFFFF'FFFF;
constexpr std::size_t kNearest = 24;    // neighbours that are looked at
constexpr std::size_t kRing = 6;        // as many as stand about a point of a plane
constexpr double kReach = 1;            // of a cell, of the distance to the last of those
constexpr double kOtherSide = -0.5;     // cosine between normals
constexpr double kSteep = 0.3;          // how much of a way must lie in the tangent plane
constexpr std::size_t kBlock = 1024;    // points a task
constexpr std::size_t kDiscSides = 12;  // of the disc that cells are cut from
constexpr double kLeastArea = 1e-12;    // of the square of a diagonal, of all points together
constexpr double kMostArea = 1e12;      // likewise

/// A point's cell in its tangent plane.
struct Cell {
  double area = 0;
  std::vector<std::uint32_t> ring;  ///< neighbours beyond its sides, counter-clockwise; kNobody for the disc's rim
};

/// A convex polygon about the origin that is cut smaller and smaller.
class CellPolygon {
 public:
  explicit CellPolygon(double radius) {
    for (std::size_t k = 0; k < kDiscSides; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kDiscSides;
      corners_.push_back({radius * Vector2d(std::cos(angle), std::sin(angle)), kNobody});
    }
  }

  /// Whether a neighbour at that distance may cut it.
  [[nodiscard]] bool reaches(double distance) const {
    return std::ranges::any_of(corners_, [&](const Corner& c) { return 2 * c.place.norm() > distance; });
  }

  /// Leaves what is closer to the origin than to a neighbour.
  void cut(const Vector2d& neighbour, std::uint32_t name) {
    const double half = neighbour.squaredNorm() / 2;
    cut_.clear();
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Corner& from = corners_[k];
      const Corner& to = corners_[(k + 1) % corners_.size()];
      const double a = half - from.place.dot(neighbour);
      const double b = half - to.place.dot(neighbour);
      if (a >= 0) cut_.push_back(from);
      if ((a >= 0) == (b >= 0)) continue;
      const Vector2d crossing = from.place + a / (a - b) * (to.place - from.place);
      cut_.push_back({crossing, a >= 0 ? name : from.beyond});
    }
    std::swap(corners_, cut_);
  }

  [[nodiscard]] Cell cell() const {
    Cell cell;
    for (std::size_t k = 0; k < corners_.size(); ++k) {
      const Vector2d& p = corners_[k].place;
      const Vector2d& q = corners_[(k + 1) % corners_.size()].place;
      cell.area += 0.5 * (p.x() * q.y() - p.y() * q.x());
      cell.ring.push_back(corners_[k].beyond);
    }
    return cell;
  }

 private:
  struct Corner {
    Vector2d place;
    std::uint32_t beyond;  // the side that begins here
  };
  std::vector<Corner> corners_, cut_;
};

void keep_one_of_each(auto& list) {
  std::ranges::sort(list);
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

/// Joins points that are there once each and have normals.
class Joiner {
 public:
  /// `names` are the numbers of the points in `points`; the places are theirs, in any unit.
  Joiner(const PointSet& points, std::span<const std::uint32_t> names, std::vector<Vector3d> places)
      : points_(points), names_(names), places_(std::move(places)), near_(names.size()), cells_(names.size()) {}

  /// False if the task was stopped.
  bool find_cells(const Task& task) {
    const NearestPoint tree(places_);
    for_all(task, [&](std::uint32_t i) {
      std::array<NearestPoint::Found, kNearest> found;
      Near& near = near_[i];
      near.count = tree.find(place(i), found, i);
      for (std::size_t k = 0; k < near.count; ++k) near.points[k] = found[k].point;
      if (near.count > 0) near.ring = std::sqrt(found[std::min(kRing, near.count) - 1].distance2);
    });
    for_all(task, [&](std::uint32_t i) { cells_[i] = cell_of(i); });
    return !task.stopped();
  }

  /// By the number of each point here.
  [[nodiscard]] const Cell& cell(std::size_t i) const { return cells_[i]; }

  void join(Mesh& mesh) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::array<std::uint32_t, 2>> edges;
    std::vector<std::tuple<double, std::uint32_t, std::uint32_t>> through;
    for (std::uint32_t i = 0; i < names_.size(); ++i) {
      const auto& ring = cells_[i].ring;
      for (std::size_t k = 0; k < ring.size(); ++k) {
        const std::uint32_t a = ring[k];
        if (a == kNobody) continue;
        edges.push_back({std::min(i, a), std::max(i, a)});
        const std::uint32_t b = ring[(k + 1) % ring.size()];
        if (b != kNobody && b != a) triangles.push_back({i, a, b});
      }
      for (const std::uint32_t a : near_[i].all())
        if (through_the_solid(i, a)) through.emplace_back((place(a) - place(i)).norm(), i, a);
    }
    // The same is found from every corner.
    for (auto& t : triangles) std::rotate(t.begin(), std::ranges::min_element(t), t.end());
    keep_one_of_each(triangles);
    keep_one_of_each(edges);
    for (const auto& pair : edges_between_parts(edges, through)) edges.push_back(pair);

    std::vector<std::array<std::uint32_t, 2>> sides;
    for (const auto& t : triangles)
      for (std::size_t k = 0; k < 3; ++k)
        sides.push_back({std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])});
    std::ranges::sort(sides);
    for (const auto& [a, b, c] : triangles)
      mesh.triangles.push_back({VertexId(names_[a]), VertexId(names_[b]), VertexId(names_[c])});
    for (const auto& pair : edges)
      if (!std::ranges::binary_search(sides, pair))
        mesh.triangles.push_back({VertexId(names_[pair[0]]), VertexId(names_[pair[1]]), VertexId(names_[pair[1]])});
  }

 private:
  struct Near {
    std::array<std::uint32_t, kNearest> points;  // the closest first
    std::size_t count = 0;                       // of them
    double ring = 0;                             // how far the sixth is

    [[nodiscard]] std::span<const std::uint32_t> all() const { return std::span(points).first(count); }
  };

  template <class Work>
  void for_all(const Task& task, const Work& work) {
    tbb::parallel_for(std::size_t{0}, (names_.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t i = block * kBlock; i < std::min(names_.size(), (block + 1) * kBlock); ++i)
        if (!task.stopped()) work(static_cast<std::uint32_t>(i));
    });
  }
  [[nodiscard]] const Vector3d& place(std::uint32_t i) const { return places_[i]; }
  [[nodiscard]] const Vector3d& normal(std::uint32_t i) const { return points_.normals[names_[i]]; }
  /// Each behind the other, as the sides of a sheet are.
  [[nodiscard]] bool through_the_solid(std::uint32_t a, std::uint32_t b) const {
    const Vector3d way = place(b) - place(a);
    return normal(a).dot(normal(b)) < kOtherSide && normal(a).dot(way) <= 0 && normal(b).dot(way) >= 0;
  }

  [[nodiscard]] Cell cell_of(std::uint32_t i) const {
    const Near& near = near_[i];
    // A point that is far from all others is no large part of the surface: as its neighbours are.
    std::vector<double> rings{near.ring};
    for (const std::uint32_t other : near.all().first(std::min(kRing, near.count))) rings.push_back(near_[other].ring);
    const auto middle = rings.begin() + static_cast<std::ptrdiff_t>(rings.size() / 2);
    std::ranges::nth_element(rings, middle);
    CellPolygon polygon(kReach * *middle);
    const Vector3d& n = normal(i);
    // The disc's corners are laid out from the closest neighbour on, so that the cell turns with the points.
    std::optional<Vector3d> u;
    for (const std::uint32_t other : near.all()) {
      const Vector3d way = place(other) - place(i);
      const double distance = way.norm();
      if (!polygon.reaches(distance)) break;
      const Vector3d flat = way - n.dot(way) * n;
      if (n.dot(normal(other)) < kOtherSide || !(flat.norm() > kSteep * distance)) continue;
      if (!u) u = flat.normalized();
      const Vector2d along(u->dot(flat), n.cross(*u).dot(flat));
      polygon.cut(distance * along.normalized(), other);
    }
    return polygon.cell();
  }

  /// The shortest of edges that join what others leave apart.
  [[nodiscard]] std::vector<std::array<std::uint32_t, 2>> edges_between_parts(
      const std::vector<std::array<std::uint32_t, 2>>& edges,
      std::vector<std::tuple<double, std::uint32_t, std::uint32_t>>& through) const {
    std::vector<std::uint32_t> into(names_.size());
    std::iota(into.begin(), into.end(), 0U);
    const auto part = [&](std::uint32_t i) {
      while (into[i] != i) i = into[i] = into[into[i]];
      return i;
    };
    for (const auto& [a, b] : edges) into[part(a)] = part(b);
    std::ranges::sort(through);
    std::vector<std::array<std::uint32_t, 2>> joined;
    for (const auto& [length, a, b] : through) {
      if (part(a) == part(b)) continue;
      into[part(a)] = part(b);
      joined.push_back({std::min(a, b), std::max(a, b)});
    }
    return joined;
  }

  const PointSet& points_;
  std::span<const std::uint32_t> names_;
  std::vector<Vector3d> places_;
  std::vector<Near> near_;
  std::vector<Cell> cells_;
};

/// Whether the areas of points that have normals can be theirs. Where all are at one place, any areas can.
bool are_areas_of(const PointSet& points, double diagonal) {
  double sum = 0;
  for (std::size_t i = 0; i < points.areas.size(); ++i)
    if (!points.normals[i].isZero(0)) sum += points.areas[i];
  if (diagonal == 0) return std::isfinite(sum);
  const double share = sum / (diagonal * diagonal);
  return share >= kLeastArea && share <= kMostArea;
}

/// For each point the first at the same place that has a normal: itself, if it has one and is that.
std::vector<std::uint32_t> firsts_at_places(const PointSet& points) {
  const auto& p = points.positions;
  std::vector<std::uint32_t> order(p.size());
  std::iota(order.begin(), order.end(), 0U);
  std::erase_if(order, [&](std::uint32_t i) { return points.normals[i].isZero(0); });
  std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple(p[a].x(), p[a].y(), p[a].z(), a) < std::tuple(p[b].x(), p[b].y(), p[b].z(), b);
  });
  std::vector<std::uint32_t> first(p.size(), kNobody);
  for (std::size_t k = 0; k < order.size(); ++k)
    first[order[k]] = k > 0 && p[order[k]] == p[order[k - 1]] ? first[order[k - 1]] : order[k];
  return first;
}

}  // namespace

Expected<PointSurface> surface_of(PointSet points, const Task& task) {
  if (auto fine = validate(points); !fine) return tl::unexpected(fine.error());
  const std::size_t count = points.positions.size();
  if (count == 0) return fail("expected points, found none");
  for (Vector3d& n : points.normals) n = direction_of(n);
  task.report("joining points", 0);
  PointSurface surface{.points = std::move(points), .mesh = {}};
  surface.mesh.positions = surface.points.positions;
  surface.mesh.vertex_colours = surface.points.colours;
  const std::vector<std::uint32_t> first = firsts_at_places(surface.points);
  std::vector<std::uint32_t> names;
  std::vector<std::uint32_t> together(count, 0);  // at the place of each first
  for (std::uint32_t i = 0; i < count; ++i) {
    if (first[i] == i) names.push_back(i);
    if (first[i] != kNobody) ++together[first[i]];
  }
  if (names.empty()) return fail("expected points with normals; all normals are 0 0 0");
  Eigen::AlignedBox3d box;
  for (const Vector3d& p : surface.points.positions) box.extend(p);
  const double diagonal = length_of(box.diagonal());
  if (!std::isfinite(diagonal * diagonal))
    return fail("expected points that lie closer together; the area of their box is beyond all numbers");
  if (diagonal > 0 && !(kLeastArea * diagonal * diagonal > std::numeric_limits<double>::min()))
    return fail("expected points that lie farther apart; the area of their box is below all numbers");
  if (!surface.points.areas.empty() && !are_areas_of(surface.points, diagonal))
    return fail(
        "areas: expected what fits the points' places; all together they are 0, or more than 1e12 times smaller or "
        "larger than the square of the diagonal of the points' box");
  const double unit = diagonal > 0 ? diagonal : 1;
  std::vector<Vector3d> places;
  for (const auto name : names) places.emplace_back((surface.points.positions[name] - box.min()) / unit);
  Joiner joiner(surface.points, names, std::move(places));
  if (!joiner.find_cells(task)) return cancelled();
  joiner.join(surface.mesh);
  for (std::uint32_t i = 0; i < count; ++i)
    if (first[i] != i && first[i] != kNobody)
      surface.mesh.triangles.push_back({VertexId(first[i]), VertexId(i), VertexId(i)});
  if (surface.points.areas.empty()) {
    surface.points.areas.assign(count, 0);
    for (std::size_t k = 0; k < names.size(); ++k)
      surface.points.areas[names[k]] = unit * unit * joiner.cell(k).area / together[names[k]];
    for (std::uint32_t i = 0; i < count; ++i)
      if (first[i] != kNobody) surface.points.areas[i] = surface.points.areas[first[i]];
  }
  task.report("joining points", 1);
  return surface;
}

}  // namespace armature::sdk
