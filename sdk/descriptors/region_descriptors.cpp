#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Eigenvalues>
#include <armature/sdk/descriptors/descriptors.h>
#include <armature/sdk/mesh/measures.h>

#include "sdk/descriptors/area_means.h"

namespace armature::sdk {
namespace {

constexpr std::size_t kEntries = 6;

/// n n', as xx, yy, zz, xy, xz, yz.
std::array<double, kEntries> squares(const Eigen::Vector3d& n) noexcept {
  return {n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), n.x() * n.y(), n.x() * n.z(), n.y() * n.z()};
}

/// The integral of n n', as xx, yy, zz, xy, xz, yz; what it has of the planes' quadric is the same anywhere.
class Quadrics final : public AreaMeans {
 public:
  using AreaMeans::AreaMeans;
  [[nodiscard]] double dissimilarity(std::span<const float> a, std::span<const float> b,
                                     double) const noexcept override {
    if (!both_cover(a, b)) return kNothingAlike;
    const Eigen::Vector2f off = smallest(a) - smallest(b);
    return 2 * static_cast<double>(off.norm());  // they lie in a triangle half a unit across
  }

 private:
  static Eigen::Vector2f smallest(std::span<const float> q) noexcept {
    Eigen::Matrix3f matrix;
    matrix << q[1], q[4], q[5], q[4], q[2], q[6], q[5], q[6], q[3];
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
    solver.computeDirect(matrix, Eigen::EigenvaluesOnly);
    return solver.eigenvalues().head<2>() / matrix.trace();
  }
};

/// Histograms of unit mass, unlike by chi-square.
class MeanHistograms final : public AreaMeans {
 public:
  using AreaMeans::AreaMeans;
  [[nodiscard]] double dissimilarity(std::span<const float> a, std::span<const float> b,
                                     double) const noexcept override {
    if (!both_cover(a, b)) return kNothingAlike;
    double sum = 0;
    for (std::size_t k = 1; k < a.size(); ++k) {
      const float x = a[k] / a[0];
      const float y = b[k] / b[0];
      if (x + y > 0) sum += static_cast<double>((x - y) * (x - y) / (x + y));
    }
    return 0.5 * sum;
  }
};

}  // namespace

std::unique_ptr<Descriptor> quadric_descriptor(const Mesh& mesh) {
  const std::size_t n = mesh.positions.size();
  std::vector<double> sums(n * kEntries, 0.0);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const Eigen::Vector3d area = area_vector(mesh, FaceId(f));
    const double length = area.norm();
    if (!(length > 0)) continue;
    const auto nn = squares(area / length);
    for (const VertexId v : mesh.triangles[f])
      for (std::size_t k = 0; k < kEntries; ++k) sums[v.index() * kEntries + k] += length / 3 * nn[k];
  }
  const std::vector<double> areas = barycentric_areas(mesh);
  std::vector<float> means(sums.size(), 0.0F);
  for (std::size_t k = 0; k < sums.size(); ++k)
    if (areas[k / kEntries] > 0) means[k] = static_cast<float>(sums[k] / areas[k / kEntries]);
  return std::make_unique<Quadrics>(std::move(means), kEntries, areas);
}

std::unique_ptr<Descriptor> quadric_descriptor(const PointSet& points) {
  std::vector<float> values;
  values.reserve(points.positions.size() * kEntries);
  for (const Eigen::Vector3d& normal : points.normals)
    for (const double entry : squares(normal)) values.push_back(static_cast<float>(entry));
  const std::vector<double> alike(points.areas.empty() ? points.positions.size() : 0, 1.0);
  return std::make_unique<Quadrics>(std::move(values), kEntries, points.areas.empty() ? alike : points.areas);
}

Expected<std::unique_ptr<Descriptor>> patch_shape_context(const Surface& surface, const PatchContexts& contexts,
                                                          const Task& task) {
  auto rows = contexts.of_all(task);
  if (!rows) return tl::unexpected(rows.error());
  return std::make_unique<MeanHistograms>(std::move(*rows), PatchContexts::kDistances * PatchContexts::kAngles,
                                          surface.vertex_areas);
}

std::unique_ptr<Descriptor> approximate_shape_context(const Mesh& mesh, const ComponentIndex& index) {
  const std::size_t bins = index.size() == 0 ? 1 : index.shape(0).context.size();
  std::vector<float> rows(mesh.positions.size() * bins, 0.0F);
  for (std::size_t c = 0; c < index.size(); ++c)
    for (const FaceId face : index.faces(c))
      for (const VertexId v : mesh.triangle(face))
        std::ranges::copy(index.shape(c).context, rows.begin() + static_cast<std::ptrdiff_t>(v.index() * bins));
  return std::make_unique<MeanHistograms>(std::move(rows), bins, barycentric_areas(mesh));
}

}  // namespace armature::sdk
