#include "sdk/distance/sphere_pieces.h"

#include <algorithm>

namespace armature::sdk {

using Eigen::Vector3d;

SpherePieces::SpherePieces(const SphereMesh& shape) : spheres(shape.spheres) {
  edge_spheres.reserve(shape.edges.size() + 3 * shape.triangles.size());
  const auto add_edge = [&](SphereId a, SphereId b) { edge_spheres.push_back({std::min(a, b), std::max(a, b)}); };
  for (const auto& [a, b] : shape.edges) add_edge(a, b);
  for (const auto& [a, b, c] : shape.triangles) add_edge(a, b), add_edge(b, c), add_edge(a, c);
  std::sort(edge_spheres.begin(), edge_spheres.end());
  edge_spheres.erase(std::unique(edge_spheres.begin(), edge_spheres.end()), edge_spheres.end());
  std::vector<bool> on_edge(spheres.size(), false);
  for (const auto& pair : edge_spheres)
    for (const SphereId id : pair) on_edge[id.index()] = true;
  for (std::size_t k = 0; k < on_edge.size(); ++k)
    if (!on_edge[k]) edge_spheres.push_back({SphereId(k), SphereId()});

  edges.reserve(edge_spheres.size());
  for (const auto& [a, b] : edge_spheres) edges.emplace_back(SphereEdge{sphere(a), sphere(b.valid() ? b : a)});
  for (const SphereTriple& triple : shape.triangles) {
    const FacetGauge gauge({sphere(triple[0]), sphere(triple[1]), sphere(triple[2])});
    if (!gauge.exists) continue;
    facets.push_back(gauge);
    facet_spheres.push_back(triple);
  }

  if (spheres.empty()) return;
  lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  upper = -lower;
  for (const Sphere& s : spheres) {
    lower = lower.cwiseMin((s.centre.array() - s.radius).matrix());
    upper = upper.cwiseMax((s.centre.array() + s.radius).matrix());
  }
}

std::vector<Piece> SpherePieces::all() const {
  std::vector<Piece> pieces;
  pieces.reserve(edges.size() + facets.size());
  for (std::size_t k = 0; k < edges.size(); ++k) pieces.push_back({Piece::Kind::Edge, static_cast<std::uint32_t>(k)});
  for (std::size_t k = 0; k < facets.size(); ++k) pieces.push_back({Piece::Kind::Facet, static_cast<std::uint32_t>(k)});
  return pieces;
}

UnitBox SpherePieces::box_of(const UnitFrame& frame, Piece piece) const noexcept {
  Vector3d low = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d high = -low;
  for (const SphereId id : spheres_of(piece)) {
    if (!id.valid()) continue;
    low = low.cwiseMin((sphere(id).centre.array() - sphere(id).radius).matrix());
    high = high.cwiseMax((sphere(id).centre.array() + sphere(id).radius).matrix());
  }
  return unit_box(frame, low, high);
}

}  // namespace armature::sdk
