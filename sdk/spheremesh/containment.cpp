#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/spheremesh/containment.h>
#include <armature/sdk/spheremesh/make_sphere_mesh.h>
#include <tbb/parallel_for.h>

#include "sdk/spheremesh/surface_bounds.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// Looks for parts of triangles on the wrong side of a union.
class Patrol {
 public:
  Patrol(const SphereMesh& shape, Side side, double size) : shape_(shape), tree_(shape), side_(side), size_(size) {}

  /// The worst part; `by` is 0 if there is none.
  [[nodiscard]] Trespass look(const Vector3d& a, const Vector3d& b, const Vector3d& c) const {
    Trespass worst;
    divide(a, b, c, worst);
    return worst;
  }

 private:
  void divide(const Vector3d& a, const Vector3d& b, const Vector3d& c, Trespass& worst) const {
    const Vector3d middle = (a + b + c) / 3;
    const double reach =
        std::sqrt(std::max({(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
    const NearestSphere near = tree_.nearest(middle);
    const double at_middle = side_ == Side::Outside ? near.distance : -near.distance;
    if (at_middle + reach <= worst.by) return;  // distances change by at most 1 per length
    if (side_ == Side::Outside &&
        std::max({piece_distance(near, a), piece_distance(near, b), piece_distance(near, c)}) <= worst.by)
      return;  // the piece is convex
    if (reach <= size_) {
      worst = {at_middle + reach, near.spheres};
      return;
    }
    const Vector3d ab = 0.5 * (a + b);
    const Vector3d bc = 0.5 * (b + c);
    const Vector3d ca = 0.5 * (c + a);
    divide(ab, bc, ca, worst);
    divide(a, ab, ca, worst);
    divide(ab, b, bc, worst);
    divide(ca, bc, c, worst);
  }

  [[nodiscard]] double piece_distance(const NearestSphere& near, const Vector3d& point) const noexcept {
    const auto& [a, b, c] = near.spheres;
    if (c.valid()) return signed_distance(SphereTriangle{shape_.sphere(a), shape_.sphere(b), shape_.sphere(c)}, point);
    if (b.valid()) return signed_distance(SphereEdge{shape_.sphere(a), shape_.sphere(b)}, point);
    return signed_distance(shape_.sphere(a), point);
  }

  const SphereMesh& shape_;
  SphereMeshTree tree_;
  Side side_;
  double size_;
};

constexpr int kPasses = 40;

}  // namespace

std::vector<Trespass> trespasses(const Mesh& mesh, const SphereMesh& shape, Side side, double size) {
  const Patrol patrol(shape, side, size);
  std::vector<Trespass> by_face(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, by_face.size(), [&](std::size_t k) {
    const FaceId face(k);
    by_face[k] = patrol.look(mesh.corner(face, 0), mesh.corner(face, 1), mesh.corner(face, 2));
  });
  std::erase_if(by_face, [](const Trespass& t) { return !(t.by > 0); });
  return by_face;
}

void enclose(const Mesh& mesh, SphereMesh& shape, const std::vector<bool>& fixed, double size) {
  for (int pass = 0; pass < kPasses; ++pass) {
    const std::vector<Trespass> found = trespasses(mesh, shape, Side::Outside, size);
    if (found.empty()) return;
    // Every sphere of the piece by as much: then the interpolated one grows by as much, too.
    std::vector<double> growth(shape.spheres.size(), 0);
    for (const Trespass& t : found)
      for (const SphereId id : t.spheres)
        if (id.valid() && !(id.index() < fixed.size() && fixed[id.index()]))
          growth[id.index()] = std::max(growth[id.index()], t.by);
    for (std::size_t k = 0; k < growth.size(); ++k) shape.spheres[k].radius += growth[k] * (1 + 1e-9);
  }
}

void retreat(const Mesh& mesh, SphereMesh& shape, const std::vector<bool>& fixed, double size) {
  const auto is_fixed = [&](SphereId id) { return id.index() < fixed.size() && fixed[id.index()]; };
  const MeshTree tree(mesh);
  for (std::size_t k = 0; k < shape.spheres.size(); ++k) {
    Sphere& s = shape.spheres[k];
    if (is_fixed(SphereId(k)) || tree.inside(s.centre)) continue;
    s = {tree.closest(s.centre).point, 0};
  }
  for (int pass = 0; pass < kPasses; ++pass) {
    std::vector<Trespass> found = trespasses(mesh, shape, Side::Inside, size);
    std::erase_if(found, [&](const Trespass& t) { return t.by <= 2 * size; });
    if (found.empty()) return;
    std::vector<double> loss(shape.spheres.size(), 0);
    std::vector<SpherePair> dropped_edges;
    std::vector<SphereTriple> dropped_triangles;
    for (const Trespass& t : found) {
      double left = 0;
      for (const SphereId id : t.spheres)
        if (id.valid() && !is_fixed(id)) {
          loss[id.index()] = std::max(loss[id.index()], t.by - size);
          left = std::max(left, shape.sphere(id).radius);
        }
      if (left > 0) continue;
      if (t.spheres[2].valid())
        dropped_triangles.push_back(t.spheres);
      else if (t.spheres[1].valid())
        dropped_edges.push_back({t.spheres[0], t.spheres[1]});
    }
    for (std::size_t k = 0; k < loss.size(); ++k)
      shape.spheres[k].radius = std::max(0.0, shape.spheres[k].radius - loss[k]);
    if (dropped_edges.empty() && dropped_triangles.empty()) continue;
    // An edge takes the triangles at it along; their other edges stay.
    std::vector<SpherePair> edges = shape.edges;
    std::vector<SphereTriple> triangles;
    for (const SphereTriple& t : shape.triangles) {
      const std::array<SpherePair, 3> sides{{{t[0], t[1]}, {t[1], t[2]}, {t[0], t[2]}}};
      const bool dropped =
          std::find(dropped_triangles.begin(), dropped_triangles.end(), t) != dropped_triangles.end() ||
          std::any_of(sides.begin(), sides.end(), [&](const SpherePair& e) {
            return std::find(dropped_edges.begin(), dropped_edges.end(), e) != dropped_edges.end();
          });
      if (!dropped) triangles.push_back(t);
      if (dropped) edges.insert(edges.end(), sides.begin(), sides.end());
    }
    std::erase_if(edges, [&](const SpherePair& e) {
      return std::find(dropped_edges.begin(), dropped_edges.end(), e) != dropped_edges.end();
    });
    shape = make_sphere_mesh(std::move(shape.spheres), edges, triangles);
  }
}

Containment containment(const Mesh& mesh, const SphereMesh& shape, double tolerance) {
  const double size = tolerance * bounding_box_diagonal(mesh);
  Containment result;
  for (const Trespass& t : trespasses(mesh, shape, Side::Outside, size))
    result.uncovered = std::max(result.uncovered, t.by);
  for (const Trespass& t : trespasses(mesh, shape, Side::Inside, size)) result.crossed = std::max(result.crossed, t.by);
  return result;
}

}  // namespace armature::sdk
