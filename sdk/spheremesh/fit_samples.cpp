#include "sdk/spheremesh/fit_samples.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <Eigen/Geometry>

#include "sdk/spheremesh/point_blocks.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

double fraction(double x) noexcept {
  return x - std::floor(x);
}

/// Point k of a sequence that fills the unit square evenly at every length (Roberts 2018).
struct Place {
  double u, v;
};
Place even_place(std::size_t k) noexcept {
  constexpr double kFirst = 0.7548776662466927;  // 1 / g and 1 / g^2, g^3 = g + 1
  constexpr double kSecond = 0.5698402909980532;
  const auto n = static_cast<double>(k + 1);
  return {fraction(0.5 + n * kFirst), fraction(0.5 + n * kSecond)};
}

/// The order of points along the curve that fills the unit frame.
std::vector<std::uint32_t> order_on_curve(std::size_t count, const auto& point) {
  std::vector<std::array<std::uint32_t, 2>> keys(count);
  for (std::uint32_t k = 0; k < count; ++k) keys[k] = {place_on_curve(point(k)), k};
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(count);
  for (std::size_t k = 0; k < count; ++k) order[k] = keys[k][1];
  return order;
}

/// Takes samples of all pieces, before what others cover is left out.
class PieceSampler {
 public:
  PieceSampler(const UnionGauge& gauge, double density, const PieceFilter& only)
      : gauge_(gauge), density_(density), only_(only) {}

  std::vector<UnionSample> take() {
    find_opposite_corners();
    sample_spheres();
    for (std::size_t e = 0; e < gauge_.edge_count(); ++e) sample_cone(e);
    for (std::size_t f = 0; f < gauge_.facets().size(); ++f) sample_facets(f);
    return std::move(samples_);
  }

 private:
  /// What one edge covers of a sphere: directions with d.axis > limit.
  struct Cap {
    Vector3d axis;
    double limit;
  };

  [[nodiscard]] bool wanted(const Corners& corners) const { return !only_ || only_(corners); }

  /// How many samples a piece gets, and how much of a sample's area each stands for.
  struct Count {
    std::size_t samples;
    double share;
  };
  /// What rounding takes from one piece the next ones get back. However small, a piece may reach far out: it gets a
  /// few.
  Count samples_of(double area) noexcept {
    constexpr double kFewest = 4;
    const double wanted = area * density_;
    if (wanted < kFewest) return {static_cast<std::size_t>(kFewest), wanted / kFewest};
    due_ += wanted;
    const double whole = std::floor(due_);
    due_ -= whole;
    return {static_cast<std::size_t>(whole), 1};
  }

  void sample_spheres() {
    const std::size_t count = gauge_.spheres().size();
    std::vector<std::vector<Cap>> caps(count);
    for (std::size_t e = 0; e < gauge_.edge_count(); ++e) {
      const EdgeGauge& edge = gauge_.edges()[e];
      const auto [a, b] = gauge_.edge_corners(e);
      if (a == b) continue;
      constexpr double kAll = -2;
      if (edge.length == 0) {
        caps[edge.b_is_all ? a : b].push_back({Vector3d::UnitX(), kAll});
      } else {
        caps[a].push_back({edge.u, -edge.g});
        caps[b].push_back({-edge.u, edge.g});
      }
    }
    for (std::uint32_t k = 0; k < count; ++k) {
      if (!wanted({k, k, k})) continue;
      const Sphere& s = gauge_.spheres()[k];
      const auto [n, share] = samples_of(4 * pi * s.radius * s.radius);
      for (std::size_t i = 0; i < n; ++i) {
        const double z = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
        const double turn = 2 * pi * fraction(static_cast<double>(i) * (std::numbers::phi - 1));
        const double away = std::sqrt(1 - z * z);
        const Vector3d d(away * std::cos(turn), away * std::sin(turn), z);
        if (std::none_of(caps[k].begin(), caps[k].end(), [&](const Cap& cap) { return d.dot(cap.axis) > cap.limit; }))
          samples_.push_back({s.centre + s.radius * d, d, {k, k, k}, {1, 0, 0}, UnionSample::kSphere, share});
      }
    }
  }

  /// The third corners of the triangles at each edge.
  void find_opposite_corners() {
    opposite_.resize(gauge_.edge_count());
    for (std::size_t f = 0; f < gauge_.facets().size(); ++f) {
      const auto [a, b, c] = gauge_.facet_corners(f);
      opposite_[gauge_.edge_between(a, b)].push_back(c);
      opposite_[gauge_.edge_between(b, c)].push_back(a);
      opposite_[gauge_.edge_between(a, c)].push_back(b);
    }
  }

  /// Whether a triangle at the edge covers the line of its cone with this normal: its third sphere reaches farther.
  [[nodiscard]] bool covered(std::size_t e, const Vector3d& normal) const {
    const auto& spheres = gauge_.spheres();
    const Sphere& a = spheres[gauge_.edge_corners(e)[0]];
    return std::any_of(opposite_[e].begin(), opposite_[e].end(), [&](std::uint32_t c) {
      return normal.dot(spheres[c].centre - a.centre) + spheres[c].radius - a.radius > 1e-9;
    });
  }

  void sample_cone(std::size_t e) {
    const EdgeGauge& edge = gauge_.edges()[e];
    const auto [a, b] = gauge_.edge_corners(e);
    if (edge.length == 0 || !wanted({a, b, b})) return;
    const double ra = edge.radius_a;
    const double growth = edge.radius_b - ra;
    const double slant = edge.length * edge.cosine;
    const auto [n, share] = samples_of(pi * edge.cosine * (ra + edge.radius_b) * slant);
    const Vector3d x = any_normal_to(edge.u);
    const Vector3d y = edge.u.cross(x);
    for (std::size_t i = 0; i < n; ++i) {
      const auto [place, turn] = even_place(i);
      // Area grows with the radius: the inverse of its integral along the cone.
      const bool straight = std::abs(growth) <= 1e-9 * (ra + edge.radius_b);
      const double t =
          straight ? place : (std::sqrt(std::max(0.0, ra * ra + place * growth * (2 * ra + growth))) - ra) / growth;
      const Vector3d d = edge.cosine * (std::cos(2 * pi * turn) * x + std::sin(2 * pi * turn) * y) - edge.g * edge.u;
      if (!covered(e, d))
        samples_.push_back({edge.centre(t * edge.length) + (ra + t * growth) * d,
                            d,
                            {a, b, b},
                            {1 - t, t, 0},
                            static_cast<std::uint32_t>(e),
                            share});
    }
  }

  void sample_facets(std::size_t f) {
    const FacetGauge& facet = gauge_.facets()[f];
    const auto [a, b, c] = gauge_.facet_corners(f);
    if (!facet.exists || !wanted({a, b, c})) return;
    const auto& s = gauge_.spheres();
    for (const double sign : {1.0, -1.0}) {
      const Vector3d d = facet.normal(sign);
      const Vector3d pa = s[a].centre + s[a].radius * d;
      const Vector3d ab = s[b].centre + s[b].radius * d - pa;
      const Vector3d ac = s[c].centre + s[c].radius * d - pa;
      const auto [n, share] = samples_of(0.5 * ab.cross(ac).norm());
      for (std::size_t i = 0; i < n; ++i) {
        auto [v, w] = even_place(i);
        if (v + w > 1) v = 1 - v, w = 1 - w;
        samples_.push_back({pa + v * ab + w * ac,
                            d,
                            {a, b, c},
                            {1 - v - w, v, w},
                            static_cast<std::uint32_t>(gauge_.edge_count() + f),
                            share});
      }
    }
  }

  const UnionGauge& gauge_;
  double density_;
  const PieceFilter& only_;
  std::vector<std::vector<std::uint32_t>> opposite_;  // by edge
  double due_ = 0.5;
  std::vector<UnionSample> samples_;
};

}  // namespace

SurfaceSamples sample_input(const Mesh& mesh, std::size_t count) {
  const std::size_t faces = mesh.triangles.size();
  const auto corner = [&](std::uint32_t face, std::size_t k) -> const Vector3d& {
    return mesh.corner(FaceId(face), k);
  };
  const std::vector<std::uint32_t> order = order_on_curve(
      faces, [&](std::uint32_t f) { return Vector3d((corner(f, 0) + corner(f, 1) + corner(f, 2)) / 3); });
  std::vector<double> reached(faces + 1, 0);
  for (std::size_t k = 0; k < faces; ++k) {
    const std::uint32_t f = order[k];
    reached[k + 1] = reached[k] + 0.5 * (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)).norm();
  }
  if (!(reached.back() > 0)) return {};

  SurfaceSamples drawn;
  std::mt19937_64 random(1);  // its sequence is the same everywhere, unlike the standard's distributions
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::size_t k = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double area = (static_cast<double>(i) + uniform()) / static_cast<double>(count) * reached.back();
    while (k + 1 < faces && reached[k + 1] < area) ++k;
    double v = uniform();
    double w = uniform();
    if (v + w > 1) v = 1 - v, w = 1 - w;
    const Vector3d ab = corner(order[k], 1) - corner(order[k], 0);
    const Vector3d ac = corner(order[k], 2) - corner(order[k], 0);
    const Vector3d cross = ab.cross(ac);
    if (!(cross.squaredNorm() > 0)) continue;
    drawn.points.push_back(corner(order[k], 0) + v * ab + w * ac);
    drawn.normals.push_back(cross.normalized());
    drawn.faces.push_back(FaceId(order[k]));
  }
  const std::vector<std::uint32_t> sorted =
      order_on_curve(drawn.points.size(), [&](std::uint32_t i) -> const Vector3d& { return drawn.points[i]; });
  SurfaceSamples samples;
  for (const std::uint32_t i : sorted) {
    samples.points.push_back(drawn.points[i]);
    samples.normals.push_back(drawn.normals[i]);
    samples.faces.push_back(drawn.faces[i]);
  }
  return samples;
}

std::vector<UnionSample> sample_union(const UnionGauge& gauge, double density, const PieceFilter& only) {
  constexpr double kTouching = 1e-7;  // a point of one piece that another one only touches is not covered
  const std::vector<UnionSample> taken = PieceSampler(gauge, density, only).take();
  const std::vector<std::uint32_t> order =
      order_on_curve(taken.size(), [&](std::uint32_t k) -> const Vector3d& { return taken[k].point; });
  std::vector<Vector3d> points(taken.size());
  for (std::size_t k = 0; k < order.size(); ++k) points[k] = taken[order[k]].point;

  std::vector<char> covered(taken.size(), 0);
  for_each_block(gauge, points, 0, [&](const NearbyPieces& pieces, std::size_t begin, std::size_t end) {
    const std::size_t count = end - begin;
    gauge.covers(pieces, std::span(points).subspan(begin, count), kTouching, std::span(covered).subspan(begin, count));
  });
  std::vector<UnionSample> boundary;
  for (std::size_t k = 0; k < order.size(); ++k)
    if (!covered[k]) boundary.push_back(taken[order[k]]);
  return boundary;
}

}  // namespace armature::sdk
