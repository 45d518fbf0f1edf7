#include <algorithm>
#include <cassert>
#include <utility>

#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/distance/sphere_mesh_tree.h>

namespace armature::sdk {
namespace {

using ColumnPointer = std::shared_ptr<const WeightColumn>;

/// Takes the cut off weights as they come and leaves out what is not above it; a sphere keeps a share in the vertices
/// that it stands for.
class ColumnBuilder {
 public:
  void add(VertexId vertex, float weight, bool stands_for_it) {
    weight -= SphereWeights::kCut;
    if (stands_for_it) weight = std::max(weight, kLeastOwn);
    if (!(weight > 0)) return;
    column_->vertices.push_back(vertex);
    column_->weights.push_back(weight);
  }
  [[nodiscard]] ColumnPointer finish() { return std::move(column_); }

 private:
  static constexpr float kLeastOwn = 1e-6F;
  std::shared_ptr<WeightColumn> column_ = std::make_shared<WeightColumn>();
};

}  // namespace

SkinWeights SkinWeights::of(std::vector<ColumnPointer> columns, std::size_t vertices) {
  SkinWeights skin{.columns = std::move(columns), .totals = std::vector<double>(vertices, 0.0)};
  for (const ColumnPointer& column : skin.columns)
    for (std::size_t i = 0; i < column->vertices.size(); ++i)
      skin.totals[column->vertices[i].index()] += static_cast<double>(column->weights[i]);
  return skin;
}

std::vector<double> SkinWeights::of_sphere(std::size_t sphere) const {
  std::vector<double> weights(totals.size(), 0.0);
  const WeightColumn& column = *columns[sphere];
  for (std::size_t i = 0; i < column.vertices.size(); ++i) {
    const std::size_t v = column.vertices[i].index();
    weights[v] = static_cast<double>(column.weights[i]) / totals[v];
  }
  return weights;
}

SphereWeights::SphereWeights(const HeatDiffusion& diffusion, const Hierarchy& hierarchy)
    : diffusion_(&diffusion), hierarchy_(&hierarchy), columns_(hierarchy.node_count()) {
  assert(diffusion.size() == hierarchy.leaf_count());
  const auto roots = hierarchy.nodes_of_level(hierarchy.min_spheres());
  std::vector<VertexId> all;
  all.reserve(diffusion.size());
  for (std::size_t v = 0; v < diffusion.size(); ++v) all.emplace_back(v);
  std::vector<double> weights(all.size(), 1.0);  // of a single root
  for (const NodeId root : roots) {
    if (roots.size() > 1) diffusion.diffuse(hierarchy.vertices(root), all, weights);
    const auto [begin, end] = hierarchy.range(root);
    ColumnBuilder column;
    for (std::size_t v = 0; v < all.size(); ++v) {
      const std::uint32_t place = hierarchy.place(all[v]);
      column.add(all[v], static_cast<float>(weights[v]), begin <= place && place < end);
    }
    columns_[root.index()] = column.finish();
  }
}

ColumnPointer SphereWeights::of(NodeId node) {
  std::vector<NodeId> to_split;
  for (NodeId above = node; !columns_[above.index()]; above = hierarchy_->parent(above))
    to_split.push_back(hierarchy_->parent(above));
  for (; !to_split.empty(); to_split.pop_back()) split(to_split.back());
  return columns_[node.index()];
}

SkinWeights SphereWeights::of(std::span<const NodeId> nodes) {
  std::vector<ColumnPointer> columns;
  columns.reserve(nodes.size());
  for (const NodeId node : nodes) columns.push_back(of(node));
  return SkinWeights::of(std::move(columns), diffusion_->size());
}

void SphereWeights::split(NodeId parent) {
  const WeightColumn& both = *columns_[parent.index()];
  auto [solved, other] = hierarchy_->children(parent);
  if (hierarchy_->vertices(other).size() < hierarchy_->vertices(solved).size()) std::swap(solved, other);
  // Nowhere is a child's weight above its parent's.
  std::vector<double> weights(both.vertices.size());
  diffusion_->diffuse(hierarchy_->vertices(solved), both.vertices, weights);
  const auto holds = [](const std::array<std::uint32_t, 2>& range, std::uint32_t place) {
    return range[0] <= place && place < range[1];
  };
  ColumnBuilder of_solved;
  ColumnBuilder of_other;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const VertexId vertex = both.vertices[i];
    const std::uint32_t place = hierarchy_->place(vertex);
    const float whole = both.weights[i] + kCut;
    const float part = std::clamp(static_cast<float>(weights[i]), 0.0F, whole);
    of_solved.add(vertex, part, holds(hierarchy_->range(solved), place));
    of_other.add(vertex, whole - part, holds(hierarchy_->range(other), place));
  }
  columns_[solved.index()] = of_solved.finish();
  columns_[other.index()] = of_other.finish();
}

namespace {

/// The spheres, edges and triangles at each sphere of a sphere-mesh, as shapes of their own.
class Surroundings {
 public:
  explicit Surroundings(const SphereMesh& shape) : shapes_(shape.spheres.size()), names_(shape.spheres.size()) {
    std::vector<std::uint32_t> local(shape.spheres.size());
    for (std::size_t s = 0; s < shapes_.size(); ++s) {
      names_[s].push_back(s);
      shapes_[s].spheres.push_back(shape.spheres[s]);
    }
    const auto place = [&](std::size_t of, SphereId sphere) {
      auto& names = names_[of];
      const auto found = std::ranges::find(names, sphere.index());
      if (found != names.end()) return SphereId(found - names.begin());
      names.push_back(sphere.index());
      shapes_[of].spheres.push_back(shape.sphere(sphere));
      return SphereId(names.size() - 1);
    };
    for (const auto& [a, b] : shape.edges)
      for (const SphereId at : {a, b})
        shapes_[at.index()].edges.push_back({place(at.index(), a), place(at.index(), b)});
    for (const auto& [a, b, c] : shape.triangles)
      for (const SphereId at : {a, b, c})
        shapes_[at.index()].triangles.push_back({place(at.index(), a), place(at.index(), b), place(at.index(), c)});
  }

  [[nodiscard]] const SphereMesh& shape(std::size_t sphere) const { return shapes_[sphere]; }
  /// Which sphere of the whole one of them is.
  [[nodiscard]] std::size_t name(std::size_t sphere, SphereId local) const { return names_[sphere][local.index()]; }

 private:
  std::vector<SphereMesh> shapes_;
  std::vector<std::vector<std::size_t>> names_;
};

}  // namespace

SkinWeights closest_primitive_weights(const HeatDiffusion& diffusion, const Hierarchy& hierarchy, const Mesh& mesh,
                                      std::size_t spheres) {
  const auto nodes = hierarchy.nodes_of_level(spheres);
  const Surroundings surroundings(*hierarchy.level(spheres));
  struct Source {
    VertexId vertex;
    float share;
  };
  std::vector<std::vector<Source>> sources(nodes.size());
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const SphereMeshTree tree(surroundings.shape(s));
    for (const VertexId vertex : hierarchy.vertices(nodes[s])) {
      const NearestSphere nearest = tree.nearest(mesh.position(vertex));
      for (std::size_t k = 0; k < nearest.spheres.size(); ++k)
        if (nearest.spheres[k].valid())
          sources[surroundings.name(s, nearest.spheres[k])].push_back(
              {vertex, static_cast<float>(nearest.weights[static_cast<Eigen::Index>(k)])});
    }
  }
  std::vector<ColumnPointer> columns;
  constexpr std::size_t kTogether = 16;
  for (std::size_t first = 0; first < nodes.size(); first += kTogether) {
    const std::size_t count = std::min(kTogether, nodes.size() - first);
    Eigen::MatrixXd heat =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(diffusion.size()), static_cast<Eigen::Index>(count));
    for (std::size_t k = 0; k < count; ++k)
      for (const auto& [vertex, share] : sources[first + k])
        heat(static_cast<Eigen::Index>(vertex.index()), static_cast<Eigen::Index>(k)) += static_cast<double>(share);
    diffusion.diffuse(heat);
    for (std::size_t k = 0; k < count; ++k) {
      const auto [begin, end] = hierarchy.range(nodes[first + k]);
      ColumnBuilder column;
      for (std::size_t v = 0; v < diffusion.size(); ++v) {
        const std::uint32_t place = hierarchy.place(VertexId(v));
        const double weight = heat(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k));
        column.add(VertexId(v), static_cast<float>(weight), begin <= place && place < end);
      }
      columns.push_back(column.finish());
    }
  }
  return SkinWeights::of(std::move(columns), diffusion.size());
}

}  // namespace armature::sdk
