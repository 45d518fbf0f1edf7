#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/selection/part_model.h>

#include "sdk/selection/calm.h"
#include "sdk/selection/level_tree.h"

namespace armature::sdk {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;

Index place(VertexId vertex) {
  return static_cast<Index>(vertex.index());
}

/// The component of every vertex; kNone where no face is.
std::vector<std::uint32_t> component_of_vertex(const Mesh& mesh, const Components& components) {
  std::vector<std::uint32_t> result(mesh.positions.size(), Components::kNone);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    if (components.of_face[f] != Components::kNone)
      for (const VertexId corner : mesh.triangles[f]) result[corner.index()] = components.of_face[f];
  return result;
}

/// Sums of a quantity at the vertices over each component.
std::vector<double> sums(const VectorXd& values, const std::vector<std::uint32_t>& component, std::size_t count) {
  std::vector<double> result(count, 0.0);
  for (std::size_t v = 0; v < component.size(); ++v)
    if (component[v] != Components::kNone) result[component[v]] += values[static_cast<Index>(v)];
  return result;
}

/// Integrated over each vertex: 2 pi less the angles of its faces, pi less these on a boundary.
VectorXd gaussian_curvature(const Surface& surface) {
  const Mesh& mesh = surface.mesh;
  VectorXd K = VectorXd::Zero(static_cast<Index>(mesh.positions.size()));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (!surface.adjacency.faces(VertexId(v)).empty()) K[static_cast<Index>(v)] = 2 * std::numbers::pi;
  for (std::size_t e = 0; e < surface.adjacency.edge_count(); ++e) {
    if (surface.adjacency.faces(EdgeId(e)).size() != 1) continue;
    for (const VertexId v : surface.adjacency.edge(EdgeId(e))) K[place(v)] = std::numbers::pi;
  }
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (repeats_a_vertex(mesh.triangles[f])) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d u = mesh.corner(FaceId(f), (k + 1) % 3) - mesh.corner(FaceId(f), k);
      const Vector3d v = mesh.corner(FaceId(f), (k + 2) % 3) - mesh.corner(FaceId(f), k);
      K[place(mesh.triangles[f][k])] -= std::atan2(u.cross(v).norm(), u.dot(v));
    }
  }
  return K;
}

/// How far from a stroke its constraints lie, by component.
std::vector<double> offsets_of(const Surface& surface, const Components& components) {
  struct Size {
    Eigen::AlignedBox3d box;
    double lengths = 0;
    double edges = 0;
  };
  std::vector<Size> sizes(components.count);
  for (std::size_t e = 0; e < surface.adjacency.edge_count(); ++e) {
    const auto& [a, b] = surface.adjacency.edge(EdgeId(e));
    Size& size = sizes[components.of_face[surface.adjacency.faces(EdgeId(e)).front().index()]];
    for (const VertexId end : {a, b}) size.box.extend(surface.mesh.position(end));
    size.lengths += (surface.mesh.position(a) - surface.mesh.position(b)).norm();
    ++size.edges;
  }
  constexpr double kOffset = 0.01;
  constexpr double kOffsetEdges = 1.5;
  std::vector<double> offsets;
  for (const Size& size : sizes)
    offsets.push_back(std::max(kOffset * size.box.diagonal().norm(), kOffsetEdges * size.lengths / size.edges));
  return offsets;
}

}  // namespace

PartModel::PartModel(const Surface& surface, std::shared_ptr<const Calm> calm, Laplacian laplacian, SparseFactor factor)
    : calm_(std::move(calm)), surface_(&surface), laplacian_(std::move(laplacian)), factor_(std::move(factor)) {}

Expected<PartModel> PartModel::build(const Surface& of, const Task& task) {
  std::shared_ptr<const Calm> calm;
  if (auto mesh = without_noise(of.mesh, of.adjacency)) calm = std::make_shared<const Calm>(std::move(*mesh));
  const Surface& surface = calm ? calm->surface : of;
  const Mesh& mesh = surface.mesh;
  task.report("laplacian", 0);
  Components components = find_components(mesh, surface.adjacency, LinkedBy::Vertices);
  const std::vector<std::uint32_t> component = component_of_vertex(mesh, components);
  Laplacian laplacian = armature::sdk::laplacian(mesh, surface.adjacency);
  if (task.stopped()) return cancelled();

  const VectorXd& mass = laplacian.mass;
  const std::vector<double> areas = sums(mass, component, components.count);
  Eigen::SparseMatrix<double> A = laplacian.stiffness;
  constexpr double kEpsilon = 1e-6;
  for (std::size_t v = 0; v < component.size(); ++v) {
    const auto i = static_cast<Index>(v);
    A.coeffRef(i, i) += component[v] == Components::kNone ? 1.0 : kEpsilon * mass[i] / areas[component[v]];
  }
  auto factor = SparseFactor::of(A, mesh.positions, task);
  if (!factor) return tl::unexpected(factor.error());

  PartModel model(surface, std::move(calm), std::move(laplacian), std::move(*factor));
  model.components_ = std::move(components);
  model.offsets_ = offsets_of(surface, model.components_);

  // L phi = K - K_target, so that what protrudes comes out highest.
  task.report("conformal factor", 0);
  const auto share = [&](std::size_t v, const std::vector<double>& totals) {
    return totals[component[v]] * model.laplacian_.mass[static_cast<Index>(v)] / areas[component[v]];
  };
  VectorXd phi = gaussian_curvature(surface);
  const std::vector<double> curvatures = sums(phi, component, model.components_.count);
  for (std::size_t v = 0; v < component.size(); ++v)
    phi[static_cast<Index>(v)] =
        component[v] == Components::kNone ? 0 : phi[static_cast<Index>(v)] - share(v, curvatures);
  model.factor_.solve(phi);
  const std::vector<double> moments = sums(phi.cwiseProduct(model.laplacian_.mass), component, model.components_.count);
  for (std::size_t v = 0; v < component.size(); ++v)
    if (component[v] != Components::kNone) phi[static_cast<Index>(v)] -= moments[component[v]] / areas[component[v]];
  model.conformal_factor_ = std::move(phi);

  task.report("isolines", 0);
  const std::span<const double> field(model.conformal_factor_.data(), mesh.positions.size());
  model.level_tree_ = std::make_shared<const LevelTree>(surface, field, spread_levels(surface, field));
  return model;
}

}  // namespace armature::sdk
