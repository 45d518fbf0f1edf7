#include "sdk/laplacian/intrinsic_triangulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/orientation.h>

namespace armature::sdk {
namespace {

/// The place of an edge among the sides of a face.
std::uint32_t place_of(const Adjacency& adjacency, FaceId face, EdgeId edge) {
  const auto& edges = adjacency.edges(face);
  return edges[0] == edge ? 0U : edges[1] == edge ? 1U : 2U;
}

/// The faces at an edge in the order of their angles around it, counter-clockwise seen against its direction.
void sort_around(const Mesh& mesh, const Adjacency& adjacency, EdgeId edge, std::vector<FaceId>& sorted) {
  const auto faces = adjacency.faces(edge);
  sorted.assign(faces.begin(), faces.end());
  if (sorted.size() < 3) return;
  const auto [a, b] = adjacency.edge(edge);
  const Eigen::Vector3d axis = (mesh.position(b) - mesh.position(a)).stableNormalized();
  const Eigen::Vector3d u = axis.isZero() ? Eigen::Vector3d::UnitX() : Eigen::Vector3d(axis.unitOrthogonal());
  const Eigen::Vector3d v = axis.cross(u);
  std::vector<std::pair<double, FaceId>> angles;
  for (const FaceId face : sorted) {
    const Eigen::Vector3d apex = mesh.corner(face, (place_of(adjacency, face, edge) + 2) % 3) - mesh.position(a);
    angles.emplace_back(std::atan2(apex.dot(v), apex.dot(u)), face);
  }
  std::sort(angles.begin(), angles.end());
  std::transform(angles.begin(), angles.end(), sorted.begin(), [](const auto& angle) { return angle.second; });
}

void mollify(IntrinsicTriangulation& triangulation) {
  std::vector<double>& lengths = triangulation.lengths;
  if (lengths.empty()) return;
  constexpr double kThinnest = 1e-6;
  const double mean = std::accumulate(lengths.begin(), lengths.end(), 0.0) / static_cast<double>(lengths.size());
  double lacking = 0;
  for (std::size_t side = 0; side < lengths.size(); side += 3) {
    const double a = lengths[side];
    const double b = lengths[side + 1];
    const double c = lengths[side + 2];
    lacking = std::max(lacking, kThinnest * mean - (a + b + c - 2 * std::max({a, b, c})));
  }
  for (double& length : lengths) length += lacking;
}

/// The cotangents opposite the sides of a triangle.
void find_cotangents(const IntrinsicTriangulation& triangulation, std::size_t triangle, std::vector<double>& out) {
  const double* l = triangulation.lengths.data() + 3 * triangle;
  const double area = area_of_sides(l[0], l[1], l[2]);
  for (std::size_t k = 0; k < 3; ++k) {
    const double a = l[k];
    const double b = l[(k + 1) % 3];
    const double c = l[(k + 2) % 3];
    out[3 * triangle + k] = area > 0 ? (b * b + c * c - a * a) / (4 * area) : 0;
  }
}

/// The length of the other diagonal of the two triangles at a side, laid out in the plane.
double other_diagonal(const IntrinsicTriangulation& t, Side side) {
  const Side twin = t.glued[side];
  const auto next = [](Side s) { return s / 3 * 3 + (s % 3 + 1) % 3; };
  const double ab = t.lengths[side];
  const auto apex = [&](double to_a, double to_b) {
    const double x = (to_a * to_a + ab * ab - to_b * to_b) / (2 * ab);
    return Eigen::Vector2d(x, 2 * area_of_sides(ab, to_a, to_b) / ab);
  };
  const Eigen::Vector2d c = apex(t.lengths[next(next(side))], t.lengths[next(side)]);
  const Eigen::Vector2d d = apex(t.lengths[next(twin)], t.lengths[next(next(twin))]);
  return std::hypot(c.x() - d.x(), c.y() + d.y());
}

/// Exchanges the edge ab of the triangles abc and bad for cd: they become cad and dbc.
void flip(IntrinsicTriangulation& t, Side ab) {
  const Side ba = t.glued[ab];
  const auto next = [](Side s) { return s / 3 * 3 + (s % 3 + 1) % 3; };
  const Side bc = next(ab);
  const Side ca = next(bc);
  const Side ad = next(ba);
  const Side db = next(ad);
  const std::uint32_t a = t.from(ab);
  const std::uint32_t b = t.from(ba);
  const std::uint32_t c = t.from(ca);
  const std::uint32_t d = t.from(db);
  const double diagonal = other_diagonal(t, ab);

  const Side first = ab / 3 * 3;
  const Side second = ba / 3 * 3;
  const std::array<Side, 4> before = {ca, ad, db, bc};
  const std::array<Side, 4> after = {first, first + 1, second, second + 1};
  std::array<Side, 4> partners{};
  std::array<double, 4> lengths{};
  for (std::size_t i = 0; i < 4; ++i) {
    lengths[i] = t.lengths[before[i]];
    partners[i] = t.glued[before[i]];
    const auto own = std::find(before.begin(), before.end(), partners[i]);
    if (own != before.end()) partners[i] = after[static_cast<std::size_t>(own - before.begin())];
  }
  t.corners[first / 3] = {c, a, d};
  t.corners[second / 3] = {d, b, c};
  for (std::size_t i = 0; i < 4; ++i) {
    t.lengths[after[i]] = lengths[i];
    t.glued[after[i]] = partners[i];
    t.glued[partners[i]] = after[i];
  }
  t.lengths[first + 2] = t.lengths[second + 2] = diagonal;
  t.glued[first + 2] = second + 2;
  t.glued[second + 2] = first + 2;
}

}  // namespace

double area_of_sides(double a, double b, double c) noexcept {
  if (a < b) std::swap(a, b);
  if (b < c) std::swap(b, c);
  if (a < b) std::swap(a, b);
  const double square = (a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c));
  return square > 0 ? 0.25 * std::sqrt(square) : 0;
}

IntrinsicTriangulation intrinsic_triangulation(const Mesh& mesh, const Adjacency& adjacency) {
  IntrinsicTriangulation result;
  // The triangles of each face: as it is, and in a cover the other way round.
  std::vector<std::uint32_t> place(mesh.triangles.size());
  std::vector<FaceId> faces;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    place[i] = static_cast<std::uint32_t>(faces.size());
    if (!repeats_a_vertex(mesh.triangles[i])) faces.emplace_back(i);
  }
  bool closed = true;
  for (std::size_t e = 0; e < adjacency.edge_count() && closed; ++e) closed = adjacency.faces(EdgeId(e)).size() == 2;
  result.layers = closed && is_oriented(mesh, adjacency) ? 1 : 2;
  const bool cover = result.layers == 2;

  const auto count = static_cast<std::uint32_t>(faces.size());
  result.corners.resize(count * (cover ? 2 : 1));
  result.lengths.resize(3 * result.corners.size());
  result.glued.resize(3 * result.corners.size());
  const auto back = [&](Side front) { return 3 * (front / 3 + count) + 2 - front % 3; };
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto& [a, b, c] = mesh.triangle(faces[i]);
    const auto id = [](VertexId v) { return static_cast<std::uint32_t>(v.index()); };
    result.corners[i] = {id(a), id(b), id(c)};
    if (cover) result.corners[i + count] = {id(a), id(c), id(b)};
    for (Side side = 3 * i; side < 3 * i + 3; ++side) {
      const double length = (mesh.positions[result.to(side)] - mesh.positions[result.from(side)]).norm();
      result.lengths[side] = length;
      if (cover) result.lengths[back(side)] = length;
    }
  }
  std::vector<FaceId> fan;
  for (std::size_t e = 0; e < adjacency.edge_count(); ++e) {
    const EdgeId edge(e);
    const auto side_of = [&](FaceId face) { return 3 * place[face.index()] + place_of(adjacency, face, edge); };
    if (!cover) {
      const auto pair = adjacency.faces(edge);
      result.glued[side_of(pair[0])] = side_of(pair[1]);
      result.glued[side_of(pair[1])] = side_of(pair[0]);
      continue;
    }
    // What walks the edge upwards looks at the next face, what walks it downwards at the one before.
    sort_around(mesh, adjacency, edge, fan);
    for (std::size_t i = 0; i < fan.size(); ++i) {
      const Side here = side_of(fan[i]);
      const Side next = side_of(fan[(i + 1) % fan.size()]);
      const auto upwards = [&](Side side) { return result.from(side) < result.to(side); };
      const Side up = upwards(here) ? here : back(here);
      const Side down = upwards(next) ? back(next) : next;
      result.glued[up] = down;
      result.glued[down] = up;
    }
  }
  mollify(result);
  return result;
}

std::vector<double> flip_to_delaunay(IntrinsicTriangulation& triangulation) {
  const std::size_t sides = triangulation.glued.size();
  std::vector<double> cotangents(sides);
  for (std::size_t i = 0; i < sides / 3; ++i) find_cotangents(triangulation, i, cotangents);

  std::vector<Side> waiting;
  std::vector<bool> waits(sides, false);
  const auto look_at = [&](Side side) {
    constexpr double kRounding = 1e-9;
    const Side twin = triangulation.glued[side];
    if (cotangents[side] + cotangents[twin] >= -kRounding || side / 3 == twin / 3) return;
    const Side edge = std::min(side, twin);
    if (!waits[edge]) waiting.push_back(edge);
    waits[edge] = true;
  };
  for (Side side = 0; side < sides; ++side)
    if (side < triangulation.glued[side]) look_at(side);
  // Flips end by themselves (each lowers Dirichlet's energy); rounding must not keep them going.
  std::size_t left = 64 * sides;
  while (!waiting.empty() && left-- > 0) {
    const Side side = waiting.back();
    waiting.pop_back();
    waits[side] = false;
    constexpr double kRounding = 1e-9;
    const Side twin = triangulation.glued[side];
    if (side / 3 == twin / 3 || cotangents[side] + cotangents[twin] >= -kRounding) continue;
    flip(triangulation, side);
    find_cotangents(triangulation, side / 3, cotangents);
    find_cotangents(triangulation, twin / 3, cotangents);
    for (const Side triangle : {side / 3, twin / 3})
      for (Side k = 0; k < 3; ++k) look_at(3 * triangle + k);
  }
  return cotangents;
}

}  // namespace armature::sdk
