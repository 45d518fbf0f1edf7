#include "sdk/spheremesh/simplify_within.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>
#include <vector>

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include "sdk/distance/facet.h"
#include "sdk/spheremesh/cracks.h"
#include "sdk/spheremesh/crossings.h"
#include "sdk/spheremesh/surface_band.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Weighted sum of squared distances to planes: x'Ax - 2 b'x + c.
struct PlaneQuadric {
  Matrix3d A = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double c = 0;
  double weight = 0;

  void add_plane(const Vector3d& point, const Vector3d& normal, double w) {
    const double offset = normal.dot(point);
    A += w * normal * normal.transpose();
    b += w * offset * normal;
    c += w * offset * offset;
    weight += w;
  }
  void add(const PlaneQuadric& other) {
    A += other.A;
    b += other.b;
    c += other.c;
    weight += other.weight;
  }
  [[nodiscard]] double at(const Vector3d& x) const { return std::max(0.0, x.dot(A * x) - 2 * b.dot(x) + c); }
  /// The minimiser nearest to `start`, which it keeps to where planes leave it free.
  [[nodiscard]] Vector3d least_near(const Vector3d& start) const {
    const double keep = 1e-3 * A.trace() + std::numeric_limits<double>::min();
    return start + (A + keep * Matrix3d::Identity()).ldlt().solve(b - A * start);
  }
};

using Index = std::uint32_t;
constexpr Index kNone = std::numeric_limits<Index>::max();

class Simplifier {
 public:
  Simplifier(const Mesh& mesh, const SphereMeshTree& surface, const ConvexUnion& bodies, double tolerance)
      : surface_(surface),
        band_(bodies, tolerance),
        cracks_(bodies, tolerance),
        tolerance_(tolerance),
        positions_(mesh.positions),
        originals_(mesh.positions),
        faces_(faces_of(mesh)),
        crossings_(faces_, positions_) {
    const std::size_t vertices = positions_.size();
    around_.resize(vertices);
    held_.resize(faces_.size());
    quadrics_.resize(vertices);
    stamps_.assign(vertices, 0);
    for (Index f = 0; f < faces_.size(); ++f)
      for (const Index v : faces_[f]) around_[v].push_back(f);
    for (Index v = 0; v < vertices; ++v) {
      held_[around_[v].front()].push_back(v);
      double area = 0;
      for (const Index f : around_[v]) area += doubled_area_vector(faces_[f]).norm() / 6;
      quadrics_[v].add_plane(positions_[v], surface.nearest(positions_[v]).normal, area);
    }
    live_faces_ = faces_.size();
  }

  Expected<Mesh> run(const Task& task) {
    if (!open_cracks(task)) return cancelled();
    // What failed once may do after its surroundings have changed: so a few rounds.
    for (int round = 0; round < 6; ++round) {
      const std::size_t before = live_faces_;
      for (Index v = 0; v < positions_.size(); ++v)
        for (const Index w : neighbours(v))
          if (v < w) push(v, w);
      std::size_t steps = 0;
      const double begun = static_cast<double>(queue_.size()) + 1;
      while (!queue_.empty()) {
        if ((++steps & 0xFFF) == 0) {
          if (task.stopped()) return cancelled();
          task.report("simplifying", 1 - static_cast<double>(queue_.size()) / (begun + static_cast<double>(steps)));
        }
        const Candidate next = queue_.top();
        queue_.pop();
        if (next.stamp_a != stamps_[next.a] || next.stamp_b != stamps_[next.b]) continue;
        collapse(next);
      }
      if (before - live_faces_ < before / 50) break;
    }
    return compact();
  }

 private:
  using Face = Crossings::Face;
  static constexpr double kSteep = -0.2;  // cosines between the normals of a cleft's walls
  static constexpr double kFlat = 0.9;
  static std::vector<Face> faces_of(const Mesh& mesh) {
    std::vector<Face> faces;
    faces.reserve(mesh.triangles.size());
    const auto index = [](VertexId v) { return static_cast<Index>(v.index()); };
    for (const auto& [a, b, c] : mesh.triangles) faces.push_back({index(a), index(b), index(c)});
    return faces;
  }

  struct Candidate {
    double cost;
    Index a, b;
    Index stamp_a, stamp_b;
    bool operator<(const Candidate& other) const noexcept {
      if (cost != other.cost) return cost > other.cost;
      return a != other.a ? a > other.a : b > other.b;
    }
  };

  [[nodiscard]] Vector3d doubled_area_vector(const Face& f) const {
    const Vector3d& a = positions_[f[0]];
    return (positions_[f[1]] - a).cross(positions_[f[2]] - a);
  }

  [[nodiscard]] std::vector<Index> neighbours(Index v) const {
    std::vector<Index> ring;
    for (const Index f : around_[v])
      for (const Index w : faces_[f])
        if (w != v) ring.push_back(w);
    std::sort(ring.begin(), ring.end());
    ring.erase(std::unique(ring.begin(), ring.end()), ring.end());
    return ring;
  }

  [[nodiscard]] Vector3d place(Index a, Index b, PlaneQuadric& sum) const {
    sum = quadrics_[a];
    sum.add(quadrics_[b]);
    return sum.least_near((positions_[a] + positions_[b]) / 2);
  }

  /// Sinks what spans a crack to its bottom, pair by pair of opposite vertices; holds the bottoms of all clefts. False
  /// if stopped.
  bool open_cracks(const Task& task) {
    struct Pair {
      double cosine, length;
      Index a, b;
    };
    std::vector<Pair> pairs;
    for (Index v = 0; v < positions_.size(); ++v) {
      if ((v & 0xFF) == 0 && task.stopped()) return false;
      for (const Index w : neighbours(v))
        if (v < w)
          if (const double cosine = cracks_.cosine(positions_[v], positions_[w]); cosine < kFlat)
            pairs.push_back({cosine, (positions_[v] - positions_[w]).norm(), v, w});
    }
    std::sort(pairs.begin(), pairs.end(),
              [](const Pair& p, const Pair& q) { return std::tie(p.length, p.a, p.b) < std::tie(q.length, q.a, q.b); });
    std::vector<bool> sunk(positions_.size(), false);
    for (const auto& [cosine, length, a, b] : pairs) {
      if (task.stopped()) return false;
      if (sunk[a] || sunk[b]) continue;
      const std::optional<Vector3d> bottom = cracks_.bottom(positions_[a], positions_[b]);
      if (!bottom) continue;
      find_faces_at(a, b);
      const auto original = static_cast<Index>(originals_.size());
      if (cosine < kSteep && keeps_manifold(a, b) && stays_close(a, b, *bottom) &&
          !runs_through_others(a, b, *bottom)) {
        PlaneQuadric sum = quadrics_[a];
        sum.add(quadrics_[b]);
        sunk[a] = sunk[b] = true;
        held_[changed_.front()].push_back(original);
        originals_.push_back(*bottom);
        apply(a, b, *bottom, sum);
      } else {
        if (facet_of(faces_[gone_.front()]).squared_distance(*bottom) > tolerance_ * tolerance_) continue;
        held_[gone_.front()].push_back(original);
        originals_.push_back(*bottom);
      }
    }
    return true;
  }

  void push(Index a, Index b) {
    PlaneQuadric sum;
    const Vector3d x = place(a, b, sum);
    // Where all planes agree the shorter edge goes first.
    const double cost = sum.at(x) + 1e-6 * sum.weight * (positions_[a] - positions_[b]).squaredNorm();
    if (sum.at(x) > sum.weight * tolerance_ * tolerance_) return;
    queue_.push({cost, a, b, stamps_[a], stamps_[b]});
  }

  void collapse(const Candidate& edge) {
    const auto [cost, a, b, stamp_a, stamp_b] = edge;
    if (live_faces_ <= 4) return;
    PlaneQuadric sum;
    const Vector3d best = place(a, b, sum);
    if (!keeps_manifold(a, b)) return;
    find_faces_at(a, b);
    for (const Vector3d& x : {best, positions_[a], positions_[b]})
      if (fits(a, b, x)) {
        apply(a, b, x, sum);
        for (const Index w : neighbours(a)) push(a, w);
        return;
      }
  }

  /// The faces that a collapse changes, with the new vertex in the place of a or b, and those that it takes away.
  void find_faces_at(Index a, Index b) {
    changed_.clear();
    gone_.clear();
    for (const Index v : {a, b})
      for (const Index f : around_[v]) {
        const Face& face = faces_[f];
        const bool both = std::count(face.begin(), face.end(), a) + std::count(face.begin(), face.end(), b) == 2;
        if (!both)
          changed_.push_back(f);
        else if (v == a)
          gone_.push_back(f);
      }
  }

  /// An edge of a closed manifold may go if its ends have no other common neighbours than the two across from it.
  [[nodiscard]] bool keeps_manifold(Index a, Index b) const {
    const std::vector<Index> of_a = neighbours(a);
    const std::vector<Index> of_b = neighbours(b);
    std::vector<Index> common;
    std::set_intersection(of_a.begin(), of_a.end(), of_b.begin(), of_b.end(), std::back_inserter(common));
    if (common.size() != 2) return false;
    return around_[common[0]].size() > 3 && around_[common[1]].size() > 3 && of_a.size() + of_b.size() > 7;
  }

  [[nodiscard]] std::array<Vector3d, 3> moved(const Face& face, Index a, Index b, const Vector3d& x) const {
    std::array<Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = face[k] == a || face[k] == b ? x : positions_[face[k]];
    return p;
  }

  bool fits(Index a, Index b, const Vector3d& x) {
    if (std::abs(surface_.signed_distance(x)) > tolerance_) return false;
    for (const Index f : changed_) {
      const auto p = moved(faces_[f], a, b, x);
      const Vector3d n = (p[1] - p[0]).cross(p[2] - p[0]);
      const double longest2 =
          std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
      const double size = n.norm();
      if (!(size > 1e-3 * longest2) && !(size > 0 && size >= doubled_area_vector(faces_[f]).norm())) return false;
      // No fold: as the face was turned before, unless that was a splinter.
      const Vector3d old = doubled_area_vector(faces_[f]);
      if (n.dot(old) < 0.1 * size * old.norm() && old.norm() > 1e-2 * longest2) return false;
      const NearestSphere nearest = surface_.nearest((p[0] + p[1] + p[2]) / 3);
      if (n.dot(nearest.normal) < 0.1 * size) return false;
    }
    return stays_close(a, b, x) && !runs_through_others(a, b, x);
  }

  [[nodiscard]] Facet facet_of(const Face& face) const {
    return {positions_[face[0]], positions_[face[1]], positions_[face[2]]};
  }

  /// Whether mesh and surface stay within the tolerance of each other.
  bool stays_close(Index a, Index b, const Vector3d& x) {
    triangles_.clear();
    facets_.clear();
    for (const Index f : changed_) {
      const auto& t = triangles_.emplace_back(moved(faces_[f], a, b, x));
      facets_.emplace_back(t[0], t[1], t[2]);
    }
    const double limit2 = tolerance_ * tolerance_;
    for (const auto* faces : {&changed_, &gone_})
      for (const Index f : *faces)
        for (const Index original : held_[f]) {
          double least2 = std::numeric_limits<double>::infinity();
          for (const Facet& facet : facets_) {
            least2 = std::min(least2, facet.squared_distance(originals_[original]));
            if (least2 <= limit2 / 4) break;
          }
          if (least2 > limit2) return false;
        }
    return std::all_of(triangles_.begin(), triangles_.end(), [&](const auto& t) { return band_.holds(t); });
  }

  bool runs_through_others(Index a, Index b, const Vector3d& x) {
    besides_ = changed_;
    besides_.insert(besides_.end(), gone_.begin(), gone_.end());
    std::sort(besides_.begin(), besides_.end());
    return std::any_of(changed_.begin(), changed_.end(), [&](Index f) {
      Face face = faces_[f];
      while (face[0] != a && face[0] != b) std::rotate(face.begin(), face.begin() + 1, face.end());
      face[0] = a;
      return crossings_.any(face, x, faces_, positions_, besides_);
    });
  }

  void apply(Index a, Index b, const Vector3d& x, const PlaneQuadric& sum) {
    std::vector<Index> homeless;
    for (const auto* faces : {&changed_, &gone_})
      for (const Index f : *faces) {
        homeless.insert(homeless.end(), held_[f].begin(), held_[f].end());
        held_[f].clear();
      }
    for (const auto* faces : {&changed_, &gone_})
      for (const Index f : *faces) crossings_.erase(f, faces_[f], positions_);
    positions_[a] = x;
    quadrics_[a] = sum;
    for (const Index f : gone_)
      for (const Index v : faces_[f])
        if (v != a && v != b) std::erase(around_[v], f);
    for (const Index f : gone_) faces_[f] = {kNone, kNone, kNone};
    live_faces_ -= gone_.size();
    for (const Index f : changed_)
      for (Index& v : faces_[f])
        if (v == b) v = a;
    for (const Index f : changed_) crossings_.insert(f, faces_[f], positions_);
    around_[a] = changed_;
    around_[b].clear();
    for (const Index original : homeless) {
      Index home = changed_.front();
      double least2 = std::numeric_limits<double>::infinity();
      for (const Index f : changed_) {
        const double d2 = facet_of(faces_[f]).squared_distance(originals_[original]);
        if (d2 >= least2) continue;
        least2 = d2;
        home = f;
      }
      held_[home].push_back(original);
    }
    ++stamps_[a];
    ++stamps_[b];
  }

  Mesh compact() const {
    Mesh mesh;
    std::vector<VertexId> renamed(positions_.size());
    for (const Face& face : faces_) {
      if (face[0] == kNone) continue;
      Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k) {
        VertexId& name = renamed[face[k]];
        if (!name.valid()) {
          name = VertexId(mesh.positions.size());
          mesh.positions.push_back(positions_[face[k]]);
        }
        triangle[k] = name;
      }
      mesh.triangles.push_back(triangle);
    }
    return mesh;
  }

  const SphereMeshTree& surface_;
  SurfaceBand band_;
  Cracks cracks_;
  double tolerance_;
  std::vector<Vector3d> positions_;
  std::vector<Vector3d> originals_;
  std::vector<Face> faces_;
  Crossings crossings_;
  std::vector<std::vector<Index>> around_;  // faces at each vertex
  std::vector<std::vector<Index>> held_;    // original vertices that each face answers for
  std::vector<PlaneQuadric> quadrics_;
  std::vector<Index> stamps_;
  std::priority_queue<Candidate> queue_;
  std::size_t live_faces_ = 0;
  std::vector<Index> changed_, gone_, besides_;
  std::vector<std::array<Vector3d, 3>> triangles_;
  std::vector<Facet> facets_;  // of triangles_
};

}  // namespace

Expected<Mesh> simplify_within(const Mesh& mesh, const SphereMeshTree& surface, const ConvexUnion& bodies,
                               double tolerance, const Task& task) {
  return Simplifier(mesh, surface, bodies, tolerance).run(task);
}

}  // namespace armature::sdk
