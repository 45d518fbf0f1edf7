#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <armature/sdk/mesh/curvature.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// The most neighbours a fit looks at, so that a hub with thousands of them costs no more than others.
constexpr std::size_t kMostNeighbours = 48;

/// Collects the one- and two-ring of vertices, one after the other.
class Rings {
 public:
  explicit Rings(const Adjacency& adjacency) : adjacency_(adjacency) {}

  /// Its neighbours, then theirs, each once; every n-th where there are too many.
  std::span<const VertexId> around(VertexId centre) {
    found_.clear();
    add_ring(centre, centre);
    const std::size_t first_ring = found_.size();
    for (std::size_t i = 0; i < first_ring && found_.size() < kMostNeighbours; ++i) add_ring(found_[i], centre);
    return found_;
  }

 private:
  void add_ring(VertexId of, VertexId centre) {
    const auto neighbours = adjacency_.neighbours(of);
    const std::size_t step = (neighbours.size() + kMostNeighbours - 1) / kMostNeighbours;
    for (std::size_t i = 0; i < neighbours.size(); i += step) {
      const VertexId candidate = neighbours[i];
      if (candidate != centre && std::find(found_.begin(), found_.end(), candidate) == found_.end())
        found_.push_back(candidate);
    }
  }

  const Adjacency& adjacency_;
  std::vector<VertexId> found_;
};

/// The principal curvatures at the origin of z = a x^2 / 2 + b x y + c y^2 / 2 + d x + e y, from its fundamental forms.
/// The shape is below the surface, so that a hill is convex.
PrincipalCurvatures curvatures_of(const Vector5d& height) {
  const double a = height[0];
  const double b = height[1];
  const double c = height[2];
  const double d = height[3];
  const double e = height[4];
  const double E = 1 + d * d;
  const double F = d * e;
  const double G = 1 + e * e;
  const double w = std::sqrt(1 + d * d + e * e);
  const double L = -a / w;
  const double M = -b / w;
  const double N = -c / w;
  const double gauss = (L * N - M * M) / (E * G - F * F);
  const double mean = (E * N - 2 * F * M + G * L) / (2 * (E * G - F * F));
  const double root = std::sqrt(std::max(0.0, mean * mean - gauss));
  return {mean + root, mean - root};
}

/// The height field over the plane of `normal` at `centre` that fits points best, in units of `scale`. Nearer points
/// weigh more. A little is added to the diagonal, so that what the points do not tell becomes zero.
Vector5d fit_height(const Mesh& mesh, const Vector3d& centre, std::span<const VertexId> points, const Vector3d& normal,
                    double scale) {
  const Vector3d u = normal.unitOrthogonal();
  const Vector3d v = normal.cross(u);
  Matrix5d A = Matrix5d::Zero();
  Vector5d rhs = Vector5d::Zero();
  double weights = 0;
  for (const VertexId point : points) {
    const Vector3d p = (mesh.position(point) - centre) / scale;
    const double distance = p.squaredNorm();
    if (!(distance > 0)) continue;
    const double x = p.dot(u);
    const double y = p.dot(v);
    const double weight = 1 / (distance * (1 + distance));
    const Vector5d row(0.5 * x * x, x * y, 0.5 * y * y, x, y);
    A.noalias() += weight * row * row.transpose();
    rhs += weight * p.dot(normal) * row;
    weights += weight;
  }
  constexpr double kRidge = 1e-7;
  A.diagonal().array() += kRidge * std::max(weights, 1.0);
  return A.ldlt().solve(rhs);
}

PrincipalCurvatures curvatures_at(const Mesh& mesh, const Adjacency& adjacency, VertexId vertex, Vector3d normal,
                                  Rings& rings) {
  const auto first_ring = adjacency.neighbours(vertex);
  if (first_ring.empty() || normal.isZero()) return {};
  const Vector3d& centre = mesh.position(vertex);
  double length = 0;
  for (const VertexId neighbour : first_ring) length += (mesh.position(neighbour) - centre).stableNorm();
  length /= static_cast<double>(first_ring.size());
  if (!(length > 0) || !std::isfinite(1 / length)) return {};

  const auto points = rings.around(vertex);
  Vector5d height = fit_height(mesh, centre, points, normal, length);
  // A slope says that the normal was off; over the plane of the better one the quadratic fits better.
  constexpr double kSteep = 0.1;
  if (const auto slope = height.tail<2>(); slope.allFinite() && slope.squaredNorm() > kSteep * kSteep) {
    const Vector3d u = normal.unitOrthogonal();
    normal = (normal - slope[0] * u - slope[1] * normal.cross(u)).normalized();
    height = fit_height(mesh, centre, points, normal, length);
  }
  if (!height.allFinite()) return {};
  const auto [k1, k2] = curvatures_of(height);
  // In units of the edge's length, so 1 is the most that the mesh resolves.
  return {std::clamp(k1, -1.0, 1.0) / length, std::clamp(k2, -1.0, 1.0) / length};
}

}  // namespace

Expected<std::vector<PrincipalCurvatures>> principal_curvatures(const Mesh& mesh, const Adjacency& adjacency,
                                                                const Task& task) {
  const std::vector<Vector3d> normals = vertex_normals(mesh);
  std::vector<PrincipalCurvatures> result(mesh.positions.size());
  // In slices, so that the caller is told on its own thread.
  constexpr std::size_t kSlice = 1U << 16U;
  constexpr std::size_t kGrain = 512;
  for (std::size_t begin = 0; begin < result.size(); begin += kSlice) {
    if (task.stopped()) return cancelled();
    task.report("curvatures", static_cast<double>(begin) / static_cast<double>(result.size()));
    const std::size_t end = std::min(result.size(), begin + kSlice);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(begin, end, kGrain),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        Rings rings(adjacency);
                        for (std::size_t i = range.begin(); i != range.end(); ++i)
                          result[i] = curvatures_at(mesh, adjacency, VertexId(i), normals[i], rings);
                      });
  }
  return result;
}

Expected<std::vector<double>> curvature_importance(const Mesh& mesh, double sigma, const Task& task) {
  std::vector<double> importance(mesh.positions.size(), 1.0);
  if (sigma == 0) return importance;
  const auto curvatures = principal_curvatures(mesh, Adjacency(mesh), task);
  if (!curvatures) return tl::unexpected(curvatures.error());
  const double diagonal = bounding_box_diagonal(mesh);
  for (std::size_t i = 0; i < importance.size(); ++i) {
    // First times the diagonal, so that the square neither over- nor underflows with the unit of length.
    const double k1 = (*curvatures)[i].k1 * diagonal;
    const double k2 = (*curvatures)[i].k2 * diagonal;
    importance[i] = 1 + sigma * (k1 * k1 + k2 * k2);
  }
  return importance;
}

}  // namespace armature::sdk
