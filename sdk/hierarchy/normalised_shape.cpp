#include "sdk/hierarchy/normalised_shape.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

namespace armature::sdk {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

/// Triangles that hang together by vertices, of which at least one is inside out by volume or could enclose one.
struct Component {
  std::vector<std::uint32_t> triangles;
  Eigen::AlignedBox3d box;
  double volume = 0;  ///< signed, about the box's middle
};

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
  for (auto& component : components) {
    const Eigen::Vector3d middle = component.box.center();
    for (const auto t : component.triangles) {
      const auto& [a, b, c] = shape.triangles[t];
      component.volume +=
          (shape.positions[a] - middle).dot((shape.positions[b] - middle).cross(shape.positions[c] - middle)) / 6;
    }
  }
  return components;
}

/// The winding number of a component's surface about a point, as the sum of its solid angles: near 1 or -1 inside a
/// closed one, near 0 outside.
double winding(const NormalisedShape& shape, const Component& component, const Eigen::Vector3d& point) {
  double angle = 0;
  for (const auto t : component.triangles) {
    std::array<Eigen::Vector3d, 3> to;
    for (std::size_t k = 0; k < 3; ++k) to[k] = shape.positions[shape.triangles[t][k]] - point;
    const double a = to[0].norm(), b = to[1].norm(), c = to[2].norm();
    angle += 2 * std::atan2(to[0].dot(to[1].cross(to[2])),
                            a * b * c + to[0].dot(to[1]) * c + to[1].dot(to[2]) * a + to[2].dot(to[0]) * b);
  }
  return angle / (4 * EIGEN_PI);
}

/// The rotation to the principal axes of the surface's second moments. Which way they point does not matter: the
/// directions that depend on the frame are the same in all 48 symmetries of a cube.
Eigen::Matrix3d own_axes(const Mesh& mesh, const Eigen::Vector3d& origin) {
  double area = 0;
  Eigen::Vector3d first = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const auto& triangle : mesh.triangles) {
    std::array<Eigen::Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.position(triangle[k]) - origin;
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

NormalisedShape NormalisedShape::of(const Mesh& mesh, ShapeFrame frame) {
  NormalisedShape shape;
  if (frame == ShapeFrame::Own && !mesh.positions.empty()) shape.turn = own_axes(mesh, mesh.positions.front());
  Eigen::AlignedBox3d box;
  for (const auto& position : mesh.positions) box.extend(shape.turn * position);
  if (!mesh.positions.empty()) shape.origin = shape.turn.transpose() * (box.min() + 0.5 * (box.max() - box.min()));
  const double diagonal = mesh.positions.empty() ? 0 : (box.max() - box.min()).norm();
  if (diagonal > 0 && std::isfinite(1 / diagonal)) shape.scale = diagonal;
  shape.positions.reserve(mesh.positions.size());
  for (const auto& position : mesh.positions) shape.positions.push_back(shape.from_model(position));
  shape.triangles.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    auto& corners = shape.triangles.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) corners[k] = static_cast<std::uint32_t>(triangle[k].index());
  }

  const auto components = components_of(shape);
  std::vector<const Component*> inside_out;
  for (const auto& component : components) {
    if (component.volume >= 0) continue;
    const Eigen::Vector3d& point = shape.positions[shape.triangles[component.triangles.front()][0]];
    const auto encloses = [&](const Component& other) {
      return &other != &component && other.box.contains(component.box) && std::abs(winding(shape, other, point)) > 0.5;
    };
    // What an odd number of others encloses is the wall of a hole in the innermost.
    if (std::count_if(components.begin(), components.end(), encloses) % 2 == 0) inside_out.push_back(&component);
  }
  for (const auto* component : inside_out)
    for (const auto t : component->triangles) std::swap(shape.triangles[t][1], shape.triangles[t][2]);
  return shape;
}

}  // namespace armature::sdk
