#include <algorithm>
#include <iterator>
#include <utility>

#include <armature/sdk/spheremesh/make_sphere_mesh.h>

namespace armature::sdk {
namespace {

template <class Element>
void sort_and_unite(std::vector<Element>& elements) {
  std::sort(elements.begin(), elements.end());
  elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
}

}  // namespace

SphereMesh make_sphere_mesh(std::vector<Sphere> spheres, std::span<const SpherePair> edges,
                            std::span<const SphereTriple> triangles) {
  SphereMesh result;
  result.spheres = std::move(spheres);
  std::vector<SpherePair> wires;
  const auto add_wire = [&](SphereId a, SphereId b) {
    if (a != b) wires.push_back({std::min(a, b), std::max(a, b)});
  };
  for (const auto& [a, b] : edges) add_wire(a, b);
  std::vector<SpherePair> sides;
  for (SphereTriple triple : triangles) {
    std::sort(triple.begin(), triple.end());
    const auto& [a, b, c] = triple;
    if (a == b || b == c) {
      add_wire(a, c);
      continue;
    }
    result.triangles.push_back(triple);
    sides.insert(sides.end(), {SpherePair{a, b}, SpherePair{a, c}, SpherePair{b, c}});
  }
  sort_and_unite(result.triangles);
  sort_and_unite(wires);
  sort_and_unite(sides);
  std::set_difference(wires.begin(), wires.end(), sides.begin(), sides.end(), std::back_inserter(result.edges));
  return result;
}

}  // namespace armature::sdk
