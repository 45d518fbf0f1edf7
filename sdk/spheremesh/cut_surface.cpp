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
using Corners = std::array<Vector3d, 4>;

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

  /// A body that may reach into a tetrahedron, and its signed distances at the corners.
  struct Reaching {
    ConvexUnion::BodyId body;
    std::array<double, 4> at;
    double at_middle;  // of the edge that is halved

    [[nodiscard]] bool covers() const noexcept {
      return std::all_of(at.begin(), at.end(), [](double d) { return d < 0; });
    }
  };
  struct Extent {
    Vector3d middle;
    double reach = 0;

    explicit Extent(const Corners& p) : middle((p[0] + p[1] + p[2] + p[3]) / 4) {
      for (const Vector3d& corner : p) reach = std::max(reach, (corner - middle).norm());
    }
  };

  [[nodiscard]] bool reaches(ConvexUnion::BodyId body, const Corners& p, const Vector3d& middle) const {
    const ConvexUnion::Value v = bodies_.value(body, middle);
    return std::any_of(p.begin(), p.end(),
                       [&](const Vector3d& corner) { return v.distance + v.gradient.dot(corner - middle) <= 0; });
  }

  /// Whether a tetrahedron is too small to matter, given the bodies from `first` on.
  [[nodiscard]] bool is_small(double reach, std::size_t first) const {
    const auto is_thin = [&](const Reaching& r) { return bodies_.least_radius(r.body) < options_.fine; };
    return reach <= options_.fine &&
           std::none_of(reaching_.begin() + static_cast<std::ptrdiff_t>(first), reaching_.end(), is_thin);
  }

  bool wants_halving(Tetrahedra::TetId id) {
    const Tetrahedra::Tet tet = tets_.tets()[id];
    Corners p;
    for (std::size_t k = 0; k < 4; ++k) p[k] = tets_.corner(tet.corners[k]);
    const Extent extent(p);
    if (extent.reach <= options_.finest) return false;
    active_.clear();
    bodies_.find(extent.middle, extent.reach, active_);
    std::erase_if(active_, [&](ConvexUnion::BodyId body) { return !reaches(body, p, extent.middle); });
    reaching_.clear();
    for (const ConvexUnion::BodyId body : active_) {
      Reaching& r = reaching_.emplace_back();
      r.body = body;
      for (std::size_t k = 0; k < 4; ++k) r.at[k] = bodies_.distance(body, p[k]);
      if (r.covers()) return false;
    }
    if (active_.empty() || is_small(extent.reach, 0)) return false;
    const auto within = std::count_if(tet.corners.begin(), tet.corners.end(), [&](CornerId c) { return inside(c); });
    if (within == 0) return true;
    if (within == 4) return is_near_surface(tet) || !halves_are_solid(p, 0);
    return error_of(cut(tet, &active_)) > options_.error;
  }

  /// Whether a tetrahedron that it touches has a corner outside: there clefts begin, and their bottoms are wanted.
  bool is_near_surface(const Tetrahedra::Tet& tet) {
    const auto sticks_out = [&](Tetrahedra::TetId neighbour) {
      const auto& corners = tets_.tets()[neighbour].corners;
      return std::any_of(corners.begin(), corners.end(), [&](CornerId c) { return !inside(c); });
    };
    return std::any_of(tet.corners.begin(), tet.corners.end(), [&](CornerId corner) {
      const auto& around = tets_.around(corner);
      return std::any_of(around.begin(), around.end(), sticks_out);
    });
  }

  /// Whether no gap is found between the bodies from `first` on that meet in a tetrahedron all of whose corners are
  /// inside. Halved on its own it takes no neighbours along: most of what needs a closer look lies deep inside.
  bool halves_are_solid(const Corners& p, std::size_t first) {
    std::size_t i = 0, j = 1;
    double longest2 = 0;
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        if (const double length2 = (p[a] - p[b]).squaredNorm(); length2 > longest2) longest2 = length2, i = a, j = b;
    const Vector3d middle = (p[i] + p[j]) / 2;
    const std::size_t end = reaching_.size();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = first; k < end; ++k)
      least = std::min(least, reaching_[k].at_middle = bodies_.distance(reaching_[k].body, middle));
    if (least >= 0 && !filled(middle)) return false;
    for (const std::size_t corner : {i, j}) {
      Corners half = p;
      half[corner] = middle;
      const bool solid = half_is_settled(half, corner, first, end) || halves_are_solid(half, end);
      reaching_.resize(end);
      if (!solid) return false;
    }
    return true;
  }

  /// Appends those of the bodies from `first` to `end` that may reach into a half with a new corner.
  bool half_is_settled(const Corners& p, std::size_t corner, std::size_t first, std::size_t end) {
    const Extent extent(p);
    if (extent.reach <= options_.finest) return true;
    for (std::size_t k = first; k < end; ++k) {
      if (!reaches(reaching_[k].body, p, extent.middle)) continue;
      Reaching r = reaching_[k];
      r.at[corner] = r.at_middle;
      if (r.covers()) return true;
      reaching_.push_back(r);
    }
    return reaching_.size() == end || is_small(extent.reach, end);
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
  std::vector<ConvexUnion::BodyId> active_;  // that may reach into the tetrahedron at hand
  std::vector<Reaching> reaching_;           // the same, and then those of its halves' halves
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
