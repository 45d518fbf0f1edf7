#include "sdk/mesh/normalised_shape.h"

#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>

#include "sdk/mesh/lengths.h"
#include "sdk/mesh/nesting.h"

namespace armature::sdk {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles that hang together by vertices.
struct Component {
  std::vector<std::uint32_t> triangles;
  Eigen::AlignedBox3d box;
  bool inward = false;  ///< by the sign of its volume
};

/// Whether the cone from their centroid to triangles has a negative volume; false for what is flat.
bool is_inside_out(const NormalisedShape& shape, const std::vector<std::uint32_t>& triangles) {
  double area = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const auto t : triangles) {
    const auto [a, b, c] = shape.corners(t);
    const double weight = 0.5 * (b - a).cross(c - a).norm();
    area += weight;
    centroid += weight / 3 * (a + b + c);
  }
  if (!(area > 0)) return false;
  centroid /= area;
  double volume = 0;
  for (const auto t : triangles) {
    const auto [a, b, c] = shape.corners(t);
    volume += (a - centroid).dot((b - centroid).cross(c - centroid)) / 6;
  }
  constexpr double kRounding = 1e-12;
  return volume < -kRounding * area * std::sqrt(area);
}

std::vector<Component> components_of(const NormalisedShape& shape) {
  std::vector<std::uint32_t> parent(shape.positions.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : shape.triangles) {
    parent[root(t[1])] = root(t[0]);
    parent[root(t[2])] = root(t[0]);
  }
  std::vector<std::uint32_t> index(shape.positions.size(), 0xFFFF'FFFFU);
  std::vector<Component> components;
  for (std::uint32_t t = 0; t < shape.triangles.size(); ++t) {
    auto& place = index[root(shape.triangles[t][0])];
    if (place == 0xFFFF'FFFFU) {
      place = static_cast<std::uint32_t>(components.size());
      components.emplace_back();
    }
    components[place].triangles.push_back(t);
    for (const auto corner : shape.triangles[t]) components[place].box.extend(shape.positions[corner]);
  }
  for (auto& component : components) component.inward = is_inside_out(shape, component.triangles);
  return components;
}

void turn_outward(NormalisedShape& shape) {
  const auto components = components_of(shape);
  std::vector<NestedPart> parts;
  parts.reserve(components.size());
  for (const auto& component : components) {
    const auto [a, b, c] = shape.corners(component.triangles.front());
    parts.push_back({.box = component.box, .point = (a + b + c) / 3, .inward = component.inward});
  }
  const Nesting nesting(std::move(parts), [&](std::size_t component, const Eigen::Vector3d& point) {
    double sum = 0;
    for (const auto t : components[component].triangles) {
      const auto [a, b, c] = shape.corners(t);
      sum += winding(a, b, c, point);
    }
    return sum;
  });
  if (!nesting.any_inward()) return;
  std::vector<std::size_t> inward;
  for (std::size_t k = 0; k < components.size(); ++k)
    if (nesting.points_inward(k)) inward.push_back(k);
  std::vector<bool> turned(shape.normals.size(), false);
  for (const auto k : inward)
    for (const auto t : components[k].triangles) {
      std::swap(shape.triangles[t][1], shape.triangles[t][2]);
      if (shape.normals.empty()) continue;
      for (const auto corner : shape.triangles[t]) {
        if (!turned[corner]) shape.normals[corner] = -shape.normals[corner];
        turned[corner] = true;
      }
    }
}

/// The rotation to the principal axes of the surface's second moments. Which way they point does not matter: the
/// directions that depend on the frame are the same in all 48 symmetries of a cube.
Eigen::Matrix3d own_axes(const Mesh& mesh, const Eigen::Vector3d& origin) {
  const double unit = unit_near(bounding_box_diagonal(mesh));
  double area = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = (mesh.position(triangle[k]) - origin) / unit;
    const double a = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).norm();
    const Eigen::Vector3d sum = p[0] + p[1] + p[2];
    area += a;
    first += a / 3 * sum;
    second += a / 12 * sum * sum.transpose();
    for (const auto& corner : p) second += a / 12 * corner * corner.transpose();
  }
  if (!(area > 0)) return Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d spread = second - first * first.transpose() / area;
  if (!spread.allFinite()) return Eigen::Matrix3d::Identity();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Eigen::Vector3d& values = solver.eigenvalues();
  constexpr double kAlike = 0.01;
  if (!(values[1] - values[0] > kAlike * values[2]) || !(values[2] - values[1] > kAlike * values[2]))
    return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d turn = solver.eigenvectors().transpose();
  if (turn.determinant() < 0) turn.row(0) = -turn.row(0);
  return turn;
}

}  // namespace

NormalisedShape NormalisedShape::of(const Mesh& mesh, ShapeFrame frame, const PointSet* points) {
  NormalisedShape shape;
  if (frame == ShapeFrame::Own && !mesh.positions.empty()) shape.turn = own_axes(mesh, mesh.positions.front());
  Eigen::AlignedBox3d box;
  for (const auto& position : mesh.positions) box.extend(shape.turn * position);
  if (!mesh.positions.empty()) shape.origin = shape.turn.transpose() * (box.min() + 0.5 * (box.max() - box.min()));
  double extent = mesh.positions.empty() ? 0 : length_of(box.max() - box.min());
  // Points at one place are as large as their area.
  if (extent == 0 && points != nullptr)
    extent = std::sqrt(std::accumulate(points->areas.begin(), points->areas.end(), 0.0));
  if (extent > 0 && std::isfinite(1 / extent)) shape.scale = extent;
  shape.positions.reserve(mesh.positions.size());
  for (const auto& position : mesh.positions) shape.positions.push_back(shape.from_model(position));
  shape.triangles.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    auto& corners = shape.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) corners[k] = static_cast<std::uint32_t>(triangle[k].index());
  }
  if (points != nullptr) {
    for (const auto& normal : points->normals) shape.normals.emplace_back(shape.turn * normal);
    for (const double area : points->areas) shape.areas.push_back(area / (shape.scale * shape.scale));
  }
  turn_outward(shape);
  return shape;
}

}  // namespace armature::sdk
