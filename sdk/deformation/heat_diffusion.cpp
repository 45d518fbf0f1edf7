#include <cmath>

#include <armature/sdk/deformation/heat_diffusion.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/mesh/measures.h>

namespace armature::sdk {

Expected<HeatDiffusion> HeatDiffusion::of(const Mesh& mesh, const HeatOptions& options, const Task& task) {
  if (!(options.reach > 0) || !std::isfinite(options.reach)) return fail("reach: expected a positive number");
  task.report("measuring the surface", 0);
  auto [L, mass] = laplacian(mesh, Adjacency(mesh));
  const double length = options.reach * bounding_box_diagonal(mesh);
  const double lambda = 1 / (length * length);
  Eigen::VectorXd source(mass.size());
  for (Eigen::Index v = 0; v < mass.size(); ++v) {
    source[v] = mass[v] > 0 ? lambda * mass[v] : 1;
    L.coeffRef(v, v) += source[v];
  }
  auto factor = SparseFactor::of(L, mesh.positions, task);
  if (!factor) return tl::unexpected(factor.error());
  return HeatDiffusion(std::move(*factor), std::move(source));
}

void HeatDiffusion::diffuse(Eigen::Ref<Eigen::MatrixXd> p) const {
  p = source_.asDiagonal() * p;
  factor_.solve(p);
}

void HeatDiffusion::diffuse(std::span<const VertexId> vertices, std::span<const VertexId> wanted,
                            std::span<double> out) const {
  std::vector<SparseFactor::Entry> entries;
  entries.reserve(vertices.size());
  for (const VertexId vertex : vertices)
    entries.push_back({vertex, source_[static_cast<Eigen::Index>(vertex.index())]});
  factor_.solve(entries, wanted, out);
}

}  // namespace armature::sdk
