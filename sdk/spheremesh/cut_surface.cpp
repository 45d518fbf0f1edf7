#include "sdk/spheremesh/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include <Eigen/Geometry>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/distance/outer_surface.h>

#include "sdk/distance/cavities.h"
#include "sdk/spheremesh/tetrahedra.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using CornerId = Tetrahedra::CornerId;

constexpr std::size_t kMostTets = 8'000'000;
constexpr int kCavityGrid = OuterSurfaceOptions{}.cavity_grid;  // so that distances agree about what is outside

/// What the surface cuts out of a tetrahedron: a triangle or a quadrangle of vertices, outward.
struct Cut {
  std::array<std::uint32_t, 4> vertices{};
  std::size_t count = 0;
};

class Cutter {
 public:
  Cutter(const ConvexUnion& bodies, const SphereMeshTree& tree, const CutOptions& options)
      : bodies_(bodies), tree_(tree), cavities_(tree, kCavityGrid), options_(options), tets_(lattice()) {}

  Expected<Mesh> run(const Task& task) {
    std::size_t looked_at = 0;
    // New tetrahedra are appended; one that a neighbour halves first is skipped.
    for (std::size_t k = 0; k < tets_.tets().size(); ++k) {
      if ((++looked_at & 0x3FFF) == 0) {
        if (task.stopped()) return cancelled();
        task.report("dividing space", 1 - 1 / (1 + static_cast<double>(k) / 3e5));
      }
      const auto id = static_cast<Tetrahedra::TetId>(k);
      if (tets_.tets()[k].whole && wants_halving(id)) tets_.halve(id);
      if (tets_.tets().size() > kMostTets)
        return fail("the tolerance is too fine for this sphere-mesh: more than 8 million tetrahedra");
    }
    task.report("dividing space", 1);
    for (const Tetrahedra::Tet& tet : tets_.tets()) {
      if (!tet.whole) continue;
      const Cut c = cut(tet, nullptr);
      if (c.count >= 3) add_triangle(c.vertices[0], c.vertices[1], c.vertices[2]);
      if (c.count == 4) add_triangle(c.vertices[0], c.vertices[2], c.vertices[3]);
    }
    return compact();
  }

 private:
  [[nodiscard]] Tetrahedra lattice() const {
    const auto [lower, upper] = tree_.bounds();
    const double spacing = options_.coarse;
    std::array<int, 3> counts{};
    Vector3d size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      counts[axis] = static_cast<int>(std::ceil((upper[a] - lower[a]) / spacing)) + 1;
      size[a] = counts[axis] * spacing;
    }
    return {(lower + upper) / 2 - size / 2, spacing, counts};
  }

  [[nodiscard]] bool filled(const Vector3d& point) const {
    return tree_.inside(point) || (cavities_.any() && cavities_.space_at(tree_, point) == Cavities::Space::Closed);
  }

  bool inside(CornerId id) {
    while (inside_.size() <= id) {
      const Vector3d& corner = tets_.corner(static_cast<CornerId>(inside_.size()));
      inside_.push_back(filled(corner));
    }
    return inside_[id];
  }

  bool wants_halving(Tetrahedra::TetId id) {
    const Tetrahedra::Tet tet = tets_.tets()[id];
    std::array<Vector3d, 4> p;
    Vector3d middle = Vector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      p[k] = tets_.corner(tet.corners[k]);
      middle += p[k] / 4;
    }
    double reach = 0;
    for (const Vector3d& corner : p) reach = std::max(reach, (corner - middle).norm());
    if (reach <= options_.finest) return false;

    near_.clear();
    bodies_.find(middle, reach, near_);
    active_.clear();
    for (const ConvexUnion::BodyId body : near_) {
      const ConvexUnion::Value v = bodies_.value(body, middle);
      double below = std::numeric_limits<double>::infinity();
      double most = -std::numeric_limits<double>::infinity();
      for (const Vector3d& corner : p) below = std::min(below, v.distance + v.gradient.dot(corner - middle));
      if (below > 0) continue;
      for (const Vector3d& corner : p) most = std::max(most, bodies_.distance(body, corner));
      if (most < 0) return false;
      active_.push_back(body);
    }
    const auto is_thin = [&](ConvexUnion::BodyId body) { return bodies_.least_radius(body) < options_.fine; };
    if (reach <= options_.fine && std::none_of(active_.begin(), active_.end(), is_thin)) return false;
    if (active_.empty()) return false;
    const auto within = std::count_if(tet.corners.begin(), tet.corners.end(), [&](CornerId c) { return inside(c); });
    if (within == 0 || within == 4) return true;
    return error_of(cut(tet, &active_)) > options_.error;
  }

  [[nodiscard]] double error_of(const Cut& c) const {
    double most = 0;
    for (std::size_t k = 0; k + 2 < c.count; ++k) {
      const std::array<Vector3d, 3> t{positions_[c.vertices[0]], positions_[c.vertices[k + 1]],
                                      positions_[c.vertices[k + 2]]};
      most = std::max(most, std::abs(bodies_.distance(active_, (t[0] + t[1] + t[2]) / 3)));
      for (std::size_t e = 0; e < 3; ++e)
        most = std::max(most, std::abs(bodies_.distance(active_, (t[e] + t[(e + 1) % 3]) / 2)));
      if (most > options_.error) break;
    }
    return most;
  }

  /// The vertices on the edges whose ends lie on different sides, in an order that turns outward.
  Cut cut(const Tetrahedra::Tet& tet, const std::vector<ConvexUnion::BodyId>* bodies) {
    std::array<CornerId, 4> order{};
    std::size_t within = 0;
    for (const CornerId corner : tet.corners)
      if (inside(corner)) order[within++] = corner;
    if (within == 0 || within == 4) return {};
    std::size_t place = within;
    for (const CornerId corner : tet.corners)
      if (!inside(corner)) order[place++] = corner;

    Cut c;
    const auto at = [&](std::size_t i, std::size_t o) { return vertex_between(order[i], order[o], bodies); };
    if (within == 1)
      c = {{at(0, 1), at(0, 2), at(0, 3)}, 3};
    else if (within == 3)
      c = {{at(0, 3), at(1, 3), at(2, 3)}, 3};
    else
      c = {{at(0, 2), at(0, 3), at(1, 3), at(1, 2)}, 4};
    // Which way the order turns follows from how the corners lie.
    const Vector3d& a = tets_.corner(order[0]);
    const double volume =
        (tets_.corner(order[1]) - a).cross(tets_.corner(order[2]) - a).dot(tets_.corner(order[3]) - a);
    if (volume < 0) std::reverse(c.vertices.begin(), c.vertices.begin() + static_cast<std::ptrdiff_t>(c.count));
    return c;
  }

  std::uint32_t vertex_between(CornerId in, CornerId out, const std::vector<ConvexUnion::BodyId>* bodies) {
    const std::uint64_t key = static_cast<std::uint64_t>(std::min(in, out)) << 32 | std::max(in, out);
    const auto [found, added] = on_edge_.try_emplace(key, static_cast<std::uint32_t>(positions_.size()));
    if (added) positions_.push_back(root(tets_.corner(in), tets_.corner(out), bodies));
    return found->second;
  }

  [[nodiscard]] Vector3d root(const Vector3d& in, const Vector3d& out,
                              const std::vector<ConvexUnion::BodyId>* bodies) const {
    const auto distance = [&](const Vector3d& x) {
      return bodies != nullptr ? bodies_.distance(*bodies, x) : tree_.signed_distance(x);
    };
    // The Illinois rule. The ends stay apart from corners, so that no two vertices fall together.
    double a = 0;
    double b = 1;
    double fa = distance(in);
    double fb = distance(out);
    if (fa > 0) return membrane(in, out);
    double t = 0.5;
    int last = 0;
    for (int step = 0; step < 30 && b - a > 1e-9; ++step) {
      t = std::isfinite(fb) && fb > fa ? a + (b - a) * std::clamp(fa / (fa - fb), 1e-3, 1 - 1e-3) : (a + b) / 2;
      const double ft = distance(in + t * (out - in));
      if (std::abs(ft) < 1e-3 * options_.error) break;
      if (ft < 0) {
        a = t;
        fa = ft;
        if (last == -1) fb /= 2;
        last = -1;
      } else {
        b = t;
        fb = ft;
        if (last == 1) fa /= 2;
        last = 1;
      }
    }
    return in + std::clamp(t, 1e-3, 1 - 1e-3) * (out - in);
  }

  /// Where a cavity ends that a way leads out of too narrow to count.
  [[nodiscard]] Vector3d membrane(Vector3d in, Vector3d out) const {
    constexpr int kHalvings = 8;
    for (int k = 0; k < kHalvings; ++k) {
      const Vector3d between = (in + out) / 2;
      (filled(between) ? in : out) = between;
    }
    return (in + out) / 2;
  }

  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    triangles_.push_back({VertexId(a), VertexId(b), VertexId(c)});
  }

  /// The mesh of the vertices that triangles use: those of halved tetrahedra are left over.
  Mesh compact() {
    Mesh mesh;
    std::vector<VertexId> renamed(positions_.size());
    for (Triangle& triangle : triangles_)
      for (VertexId& v : triangle) {
        VertexId& name = renamed[v.index()];
        if (!name.valid()) {
          name = VertexId(mesh.positions.size());
          mesh.positions.push_back(positions_[v.index()]);
        }
        v = name;
      }
    mesh.triangles = std::move(triangles_);
    return mesh;
  }

  const ConvexUnion& bodies_;
  const SphereMeshTree& tree_;
  const Cavities cavities_;
  const CutOptions& options_;
  Tetrahedra tets_;
  std::vector<bool> inside_;  // by corner
  std::unordered_map<std::uint64_t, std::uint32_t> on_edge_;
  std::vector<Vector3d> positions_;
  std::vector<Triangle> triangles_;
  std::vector<ConvexUnion::BodyId> near_, active_;
};

/// For every face the component of the mesh that it belongs to, by a number below `count`.
std::vector<std::size_t> components(const Mesh& mesh, std::size_t& count) {
  std::vector<std::size_t> parent(mesh.positions.size());
  for (std::size_t k = 0; k < parent.size(); ++k) parent[k] = k;
  const auto root = [&](std::size_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Triangle& t : mesh.triangles)
    for (const VertexId v : {t[1], t[2]}) parent[root(v.index())] = root(t[0].index());
  std::vector<std::size_t> number(parent.size(), parent.size());
  std::vector<std::size_t> of_face;
  count = 0;
  for (const Triangle& t : mesh.triangles) {
    std::size_t& n = number[root(t[0].index())];
    if (n == parent.size()) n = count++;
    of_face.push_back(n);
  }
  return of_face;
}

Mesh with_faces(const Mesh& mesh, const std::vector<std::size_t>& component, const std::vector<bool>& wanted) {
  Mesh part;
  std::vector<VertexId> renamed(mesh.positions.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (!wanted[component[f]]) continue;
    Triangle triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      VertexId& name = renamed[mesh.triangles[f][k].index()];
      if (!name.valid()) {
        name = VertexId(part.positions.size());
        part.positions.push_back(mesh.position(mesh.triangles[f][k]));
      }
      triangle[k] = name;
    }
    part.triangles.push_back(triangle);
  }
  return part;
}

/// The wall of a void is a component of its own that turns inwards: the volume it encloses is negative. What lies
/// within such a wall floats in the void.
Mesh without_voids(Mesh mesh) {
  std::size_t count = 0;
  const std::vector<std::size_t> component = components(mesh, count);
  std::vector<double> volume(count, 0);
  std::vector<std::size_t> some_face(count, 0);
  const Vector3d origin = mesh.positions.empty() ? Vector3d::Zero() : mesh.positions.front();
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const FaceId face(f);
    volume[component[f]] +=
        (mesh.corner(face, 0) - origin).cross(mesh.corner(face, 1) - origin).dot(mesh.corner(face, 2) - origin);
    some_face[component[f]] = f;
  }
  std::vector<bool> wall(count);
  for (std::size_t c = 0; c < count; ++c) wall[c] = volume[c] < 0;
  if (std::find(wall.begin(), wall.end(), true) == wall.end()) return mesh;
  const MeshTree walls(with_faces(mesh, component, wall));
  std::vector<bool> outer(count);
  for (std::size_t c = 0; c < count; ++c) outer[c] = !wall[c] && !walls.inside(mesh.corner(FaceId(some_face[c]), 0));
  return with_faces(mesh, component, outer);
}

}  // namespace

Expected<Mesh> cut_surface(const ConvexUnion& bodies, const SphereMeshTree& tree, const CutOptions& options,
                           const Task& task) {
  auto mesh = Cutter(bodies, tree, options).run(task);
  if (!mesh) return mesh;
  return without_voids(std::move(*mesh));
}

}  // namespace armature::sdk
