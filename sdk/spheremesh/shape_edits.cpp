#include "sdk/spheremesh/shape_edits.h"

#include <algorithm>
#include <cassert>

#include <armature/sdk/spheremesh/make_sphere_mesh.h>

namespace armature::sdk {
namespace {

SphereMesh in_order(SphereMesh shape) {
  return make_sphere_mesh(std::move(shape.spheres), shape.edges, shape.triangles);
}

template <class Simplex>
bool has(const Simplex& simplex, SphereId id) {
  return std::find(simplex.begin(), simplex.end(), id) != simplex.end();
}

template <class Simplex>
Simplex renamed(Simplex simplex, SphereId from, SphereId to) {
  std::replace(simplex.begin(), simplex.end(), from, to);
  return simplex;
}

template <class Simplex>
Simplex sorted(Simplex simplex) {
  std::sort(simplex.begin(), simplex.end());
  return simplex;
}

void rename_all(SphereMesh& shape, SphereId from, SphereId to) {
  for (SpherePair& e : shape.edges) e = renamed(e, from, to);
  for (SphereTriple& t : shape.triangles) t = renamed(t, from, to);
}

/// Takes a triangle out and leaves its edges.
void take_out(SphereMesh& shape, const SphereTriple& triangle) {
  const auto [a, b, c] = sorted(triangle);
  std::erase(shape.triangles, SphereTriple{a, b, c});
  shape.edges.insert(shape.edges.end(), {{a, b}, {b, c}, {a, c}});
}

}  // namespace

SphereMesh collapsed(const SphereMesh& shape, SphereId keep, SphereId drop, const Sphere& sphere) {
  SphereMesh result = shape;
  result.spheres[keep.index()] = sphere;
  rename_all(result, drop, keep);
  const SphereId last(shape.spheres.size() - 1);
  result.spheres[drop.index()] = result.spheres[last.index()];
  result.spheres.pop_back();
  rename_all(result, last, drop);
  return in_order(std::move(result));
}

SphereMesh edge_split(const SphereMesh& shape, SphereId a, SphereId b, const Sphere& sphere) {
  SphereMesh result = shape;
  const SphereId middle(result.spheres.size());
  result.spheres.push_back(sphere);
  const auto split = [&](auto& simplices) {
    const std::size_t count = simplices.size();
    for (std::size_t k = 0; k < count; ++k) {
      const auto whole = simplices[k];
      if (!has(whole, a) || !has(whole, b)) continue;
      simplices[k] = renamed(whole, a, middle);
      simplices.push_back(renamed(whole, b, middle));
    }
  };
  split(result.edges);
  split(result.triangles);
  return in_order(std::move(result));
}

SphereMesh triangle_split(const SphereMesh& shape, const SphereTriple& triangle, const Sphere& sphere) {
  SphereMesh result = shape;
  std::erase(result.triangles, sorted(triangle));
  return attached(result, {triangle.begin(), triangle.end()}, sphere);
}

SphereMesh attached(const SphereMesh& shape, std::vector<SphereId> to, const Sphere& sphere) {
  SphereMesh result = shape;
  const SphereId added(result.spheres.size());
  result.spheres.push_back(sphere);
  if (to.size() == 1) result.edges.push_back({to[0], added});
  if (to.size() == 2) result.triangles.push_back({to[0], to[1], added});
  if (to.size() == 3)
    result.triangles.insert(result.triangles.end(),
                            {{to[0], to[1], added}, {to[1], to[2], added}, {to[0], to[2], added}});
  return in_order(std::move(result));
}

SphereMesh without(const SphereMesh& shape, const SphereTriple& triangle) {
  SphereMesh result = shape;
  take_out(result, triangle);
  return in_order(std::move(result));
}

SphereMesh without(const SphereMesh& shape, const SpherePair& edge) {
  SphereMesh result = shape;
  std::erase(result.edges, edge);
  return result;
}

SphereMesh with(const SphereMesh& shape, const SphereTriple& triangle) {
  SphereMesh result = shape;
  result.triangles.push_back(triangle);
  return in_order(std::move(result));
}

SphereMesh with(const SphereMesh& shape, const SpherePair& edge) {
  SphereMesh result = shape;
  result.edges.push_back(edge);
  return in_order(std::move(result));
}

SphereMesh flipped(const SphereMesh& shape, SphereId a, SphereId b, SphereId c, SphereId d) {
  SphereMesh result = shape;
  std::erase(result.triangles, sorted(SphereTriple{a, b, c}));
  std::erase(result.triangles, sorted(SphereTriple{a, b, d}));
  result.triangles.insert(result.triangles.end(), {{a, c, d}, {b, c, d}});
  return in_order(std::move(result));
}

SphereId ShapePart::part_id(SphereId of_whole) const {
  const auto found = std::lower_bound(whole.begin(), whole.end(), of_whole);
  assert(found != whole.end() && *found == of_whole);
  return SphereId(found - whole.begin());
}

std::vector<std::vector<SphereId>> neighbours(const SphereMesh& shape) {
  std::vector<std::vector<SphereId>> result(shape.spheres.size());
  const auto add = [&](SphereId a, SphereId b) {
    result[a.index()].push_back(b);
    result[b.index()].push_back(a);
  };
  for (const auto& [a, b] : shape.edges) add(a, b);
  for (const auto& [a, b, c] : shape.triangles) add(a, b), add(b, c), add(a, c);
  for (auto& list : result) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return result;
}

Stars::Stars(const SphereMesh& shape)
    : shape_(shape),
      neighbours_(sdk::neighbours(shape)),
      edges_(shape.spheres.size()),
      triangles_(shape.spheres.size()) {
  for (std::uint32_t k = 0; k < shape.edges.size(); ++k)
    for (const SphereId id : shape.edges[k]) edges_[id.index()].push_back(k);
  for (std::uint32_t k = 0; k < shape.triangles.size(); ++k)
    for (const SphereId id : shape.triangles[k]) triangles_[id.index()].push_back(k);
}

ShapePart Stars::around(const std::vector<SphereId>& centres) const {
  std::vector<SphereId> inner = centres;
  for (const SphereId c : centres) inner.insert(inner.end(), neighbours(c).begin(), neighbours(c).end());
  const auto make_set = [](auto& list) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  make_set(inner);
  std::vector<std::uint32_t> edges;
  std::vector<std::uint32_t> triangles;
  for (const SphereId id : inner) {
    edges.insert(edges.end(), edges_[id.index()].begin(), edges_[id.index()].end());
    triangles.insert(triangles.end(), triangles_[id.index()].begin(), triangles_[id.index()].end());
  }
  make_set(edges);
  make_set(triangles);

  ShapePart part{{}, inner};
  for (const std::uint32_t k : edges)
    part.whole.insert(part.whole.end(), shape_.edges[k].begin(), shape_.edges[k].end());
  for (const std::uint32_t k : triangles)
    part.whole.insert(part.whole.end(), shape_.triangles[k].begin(), shape_.triangles[k].end());
  make_set(part.whole);
  for (const SphereId id : part.whole) part.shape.spheres.push_back(shape_.sphere(id));
  for (const std::uint32_t k : edges)
    part.shape.edges.push_back({part.part_id(shape_.edges[k][0]), part.part_id(shape_.edges[k][1])});
  for (const std::uint32_t k : triangles) {
    const auto& [a, b, c] = shape_.triangles[k];
    part.shape.triangles.push_back({part.part_id(a), part.part_id(b), part.part_id(c)});
  }
  return part;
}

}  // namespace armature::sdk
