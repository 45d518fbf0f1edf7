#include "sdk/expansion/ring_cut.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <unordered_map>
#include <utility>

#include <Eigen/SparseCholesky>

#include "sdk/selection/best_isoline.h"

namespace armature::sdk {
namespace {

using Eigen::Index;

Index place(VertexId vertex) {
  return static_cast<Index>(vertex.index());
}

}  // namespace

RingCut::RingCut(const PartModel& model) : model_(&model), value_(model.surface().mesh.positions.size(), 0.0) {}

void RingCut::fill_region(const LevelNode& node) {
  const Eigen::VectorXd& phi = model_->conformal_factor();
  region_.assign(1, node.tip);
  value_[node.tip.index()] = 1;
  for (std::size_t at = 0; at < region_.size(); ++at)
    for (const VertexId next : model_->surface().adjacency.neighbours(region_[at])) {
      if (value_[next.index()] != 0 || !(phi[place(next)] > node.level)) continue;
      value_[next.index()] = 1;
      region_.push_back(next);
    }
}

void RingCut::forget(const Ring& ring) {
  for (const VertexId v : region_) value_[v.index()] = 0;
  for (const VertexId v : ring.near) value_[v.index()] = 0;
}

Ring RingCut::ring_around(const LevelNode& node, double reach) {
  const Surface& surface = model_->surface();
  const Eigen::VectorXd& phi = model_->conformal_factor();
  fill_region(node);
  const auto inside = [&](VertexId v) { return value_[v.index()] != 0; };
  // By distance to the isoline, along edges that do not cross it (Dijkstra 1959).
  using Entry = std::pair<double, VertexId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> waiting;
  std::unordered_map<VertexId, double> distance;
  const auto offer = [&](VertexId v, double d) {
    const auto [found, is_new] = distance.try_emplace(v, d);
    if (!is_new && found->second <= d) return;
    found->second = d;
    waiting.emplace(d, v);
  };
  for (const VertexId a : region_)
    for (const VertexId b : surface.adjacency.neighbours(a)) {
      if (inside(b)) continue;
      const double length = (surface.mesh.position(a) - surface.mesh.position(b)).norm();
      const double t = (phi[place(a)] - node.level) / (phi[place(a)] - phi[place(b)]);
      offer(a, t * length);
      offer(b, (1 - t) * length);
    }
  Ring ring;
  while (!waiting.empty()) {
    const auto [d, v] = waiting.top();
    waiting.pop();
    if (d > distance[v]) continue;
    if (d >= reach) {
      (inside(v) ? ring.inside : ring.outside).push_back(v);
      continue;
    }
    ring.near.push_back(v);
    for (const VertexId next : surface.adjacency.neighbours(v))
      if (inside(next) == inside(v)) offer(next, d + (surface.mesh.position(v) - surface.mesh.position(next)).norm());
  }
  forget(ring);
  return ring;
}

Eigen::VectorXd RingCut::field(const Ring& ring) const {
  std::unordered_map<VertexId, Index> unknown;
  for (std::size_t i = 0; i < ring.near.size(); ++i) unknown[ring.near[i]] = static_cast<Index>(i);
  std::unordered_map<VertexId, double> known;
  for (const VertexId v : ring.inside) known[v] = 1;
  const auto n = static_cast<Index>(ring.near.size());
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  // A little on the diagonal, for pieces that no ring holds.
  constexpr double kEpsilon = 1e-9;
  for (Index i = 0; i < n; ++i)
    for (Eigen::SparseMatrix<double>::InnerIterator entry(model_->laplacian().stiffness,
                                                          place(ring.near[static_cast<std::size_t>(i)]));
         entry; ++entry) {
      const VertexId other(entry.row());
      if (const auto found = unknown.find(other); found != unknown.end()) {
        if (found->second >= i)
          entries.emplace_back(found->second, i, entry.value() + (found->second == i ? kEpsilon : 0));
      } else if (const auto fixed = known.find(other); fixed != known.end()) {
        b[i] -= entry.value() * fixed->second;
      }
    }
  Eigen::SparseMatrix<double> L(n, n);
  L.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(L);
  if (factor.info() != Eigen::Success) return Eigen::VectorXd::Constant(n, 0.5);
  return factor.solve(b).cwiseMax(0).cwiseMin(1);
}

std::vector<FaceId> RingCut::band(const Ring& ring) const {
  std::vector<FaceId> band;
  for (const VertexId v : ring.near)
    for (const FaceId face : model_->surface().adjacency.faces(v)) band.push_back(face);
  std::sort(band.begin(), band.end());
  band.erase(std::unique(band.begin(), band.end()), band.end());
  return band;
}

std::vector<FaceId> RingCut::cut(const LevelNode& node, const Ring& ring) {
  const Surface& surface = model_->surface();
  if (ring.near.empty() || ring.inside.empty() || ring.outside.empty()) return {};
  const Eigen::VectorXd near = field(ring);
  fill_region(node);
  for (std::size_t i = 0; i < ring.near.size(); ++i) value_[ring.near[i].index()] = near[static_cast<Index>(i)];
  constexpr double kLeast = 0.05;
  const double isovalue = best_isovalue(
      surface, value_,
      {.faces = band(ring), .lower = kLeast, .upper = 1 - kLeast, .scale = 2 * model_->offset(node.through)});
  std::vector<FaceId> faces = region_above(surface, value_, isovalue, ring.inside);
  forget(ring);
  return faces;
}

std::vector<FaceId> RingCut::within(const LevelNode& node, const Ring& ring, std::span<const FaceId> band,
                                    const std::vector<bool>& is_in) {
  fill_region(node);
  const std::vector<VertexId> tip = {node.tip};
  std::vector<FaceId> faces =
      region_about(model_->surface(), ring.inside.empty() ? tip : ring.inside, [&](FaceId face) {
        const auto at = std::lower_bound(band.begin(), band.end(), face);
        if (at != band.end() && *at == face) return bool{is_in[static_cast<std::size_t>(at - band.begin())]};
        return value_[model_->surface().mesh.triangle(face)[0].index()] != 0;  // no isoline passes there
      });
  forget(ring);
  return faces;
}

}  // namespace armature::sdk
