#include <algorithm>
#include <cmath>
#include <string>

#include <armature/sdk/editing/vertex_edits.h>
#include <armature/sdk/laplacian/sparse_factor.h>
#include <armature/sdk/mesh/measures.h>

namespace armature::sdk {
namespace {

constexpr double kHeld = 1e-3;

Expected<void> one_a_vertex(std::size_t vertices, std::span<const double> weights) {
  if (weights.size() == vertices) return {};
  return fail("weights: expected one a vertex, " + std::to_string(vertices) + ", found " +
              std::to_string(weights.size()));
}

void displace(std::vector<Eigen::Vector3d>& positions, std::span<const Eigen::Vector3d> normals,
              std::span<const double> weights, double distance) {
  for (std::size_t v = 0; v < weights.size(); ++v) positions[v] += weights[v] * distance * normals[v];
}

void paint(std::vector<Colour>& colours, std::span<const double> weights, const Colour& colour) {
  if (colours.empty()) colours.assign(weights.size(), kPlainColour);
  for (std::size_t v = 0; v < weights.size(); ++v) {
    const double weight = weights[v] > 0 ? std::min(weights[v], 1.0) : 0;
    for (std::size_t k = 0; k < colour.size(); ++k) {
      auto& own = colours[v][k];
      own = static_cast<std::uint8_t>(std::lround(own + weight * (colour[k] - own)));
    }
  }
}

}  // namespace

double Transfer::operator()(double similarity) const noexcept {
  const double x = std::clamp((similarity - from) / (to - from), 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

std::vector<double> edit_weights(std::span<const float> similarity, const Transfer& transfer) {
  std::vector<double> weights;
  weights.reserve(similarity.size());
  for (const float s : similarity) weights.push_back(transfer(static_cast<double>(s)));
  return weights;
}

Expected<Mesh> displaced(const Mesh& mesh, std::span<const double> weights, double distance) {
  if (auto fits = one_a_vertex(mesh.positions.size(), weights); !fits) return tl::unexpected(fits.error());
  Mesh result = mesh;
  displace(result.positions, vertex_normals(mesh), weights, distance);
  return result;
}

Expected<PointSet> displaced(const PointSet& points, std::span<const double> weights, double distance) {
  if (auto fits = one_a_vertex(points.positions.size(), weights); !fits) return tl::unexpected(fits.error());
  if (auto fine = validate(points); !fine) return tl::unexpected(fine.error());
  PointSet result = points;
  displace(result.positions, points.normals, weights, distance);
  return result;
}

Expected<Mesh> smoothed(const Mesh& mesh, const Laplacian& laplacian, std::span<const double> weights, double length,
                        const Task& task) {
  if (auto fits = one_a_vertex(mesh.positions.size(), weights); !fits) return tl::unexpected(fits.error());
  const auto n = static_cast<Eigen::Index>(mesh.positions.size());
  const auto held = [&](Eigen::Index v) {
    return !(weights[static_cast<std::size_t>(v)] >= kHeld) || !(laplacian.mass[v] > 0);
  };
  // Rows of held vertices say that they stay; what the others take from them goes to the right-hand side.
  Eigen::MatrixXd p(n, 3);
  for (Eigen::Index v = 0; v < n; ++v) p.row(v) = mesh.positions[static_cast<std::size_t>(v)].transpose();
  Eigen::SparseMatrix<double> A = length * length * laplacian.stiffness;
  Eigen::MatrixXd b = p;
  for (Eigen::Index v = 0; v < n; ++v) {
    if (held(v)) continue;
    const double m = laplacian.mass[v] / weights[static_cast<std::size_t>(v)];
    b.row(v) *= m;
    A.coeffRef(v, v) += m;
  }
  for (Eigen::Index column = 0; column < n; ++column)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(A, column); entry; ++entry) {
      const Eigen::Index row = entry.row();
      if (held(column) && !held(row)) b.row(row) -= entry.value() * p.row(column);
      if (held(column) || held(row)) entry.valueRef() = row == column ? 1 : 0;
    }
  const auto factor = SparseFactor::of(A, mesh.positions, task);
  if (!factor) return tl::unexpected(factor.error());
  factor->solve(b);
  Mesh result = mesh;
  for (Eigen::Index v = 0; v < n; ++v)
    if (!held(v)) result.positions[static_cast<std::size_t>(v)] = b.row(v).transpose();
  return result;
}

Expected<Mesh> sharpened(const Mesh& mesh, const Laplacian& laplacian, std::span<const double> weights, double length,
                         double amount, const Task& task) {
  auto result = smoothed(mesh, laplacian, weights, length, task);
  if (!result) return result;
  for (std::size_t v = 0; v < weights.size(); ++v)
    result->positions[v] = mesh.positions[v] + amount * (mesh.positions[v] - result->positions[v]);
  return result;
}

Expected<Mesh> painted(const Mesh& mesh, std::span<const double> weights, const Colour& colour) {
  if (auto fits = one_a_vertex(mesh.positions.size(), weights); !fits) return tl::unexpected(fits.error());
  Mesh result = mesh;
  result.face_colours.clear();
  paint(result.vertex_colours, weights, colour);
  return result;
}

Expected<PointSet> painted(const PointSet& points, std::span<const double> weights, const Colour& colour) {
  if (auto fits = one_a_vertex(points.positions.size(), weights); !fits) return tl::unexpected(fits.error());
  if (auto fine = validate(points); !fine) return tl::unexpected(fine.error());
  PointSet result = points;
  paint(result.colours, weights, colour);
  return result;
}

}  // namespace armature::sdk
