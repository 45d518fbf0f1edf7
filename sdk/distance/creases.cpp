#include "sdk/distance/creases.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr int kDeepest = 14;  // halvings of a segment of crease: a kink between two ends is cut off below the chord

class CreaseTracer {
 public:
  CreaseTracer(const SpherePieces& shape, const Patch& patch, const CreaseOptions& options,
               std::vector<OuterCrease>& creases)
      : shape_(shape), patch_(patch), options_(options), creases_(creases) {
    for (const SphereId id : patch.spheres)
      if (id.valid()) own_.push_back(id);
    anchor_ = shape.sphere(own_.front());
  }

  void trace(std::span<const Piece> pieces) {
    for (const Piece piece : pieces) {
      const TouchedSpheres s = shape_.spheres_of(piece);
      const auto owned = static_cast<std::size_t>(
          std::count_if(s.begin(), s.end(), [&](SphereId id) { return id.valid() && is_own(id); }));
      const auto named =
          static_cast<std::size_t>(std::count_if(s.begin(), s.end(), [](SphereId id) { return id.valid(); }));
      if (owned == named) continue;
      // A primitive on the patch's own spheres and another one covers a side of the patch up to a tangent line, which
      // is no crease.
      if (owned == own_.size()) {
        for (const SphereId id : s)
          if (id.valid() && !is_own(id)) fences_.push_back(id);
        continue;
      }
      others_.push_back(piece);
    }
    std::sort(fences_.begin(), fences_.end());
    fences_.erase(std::unique(fences_.begin(), fences_.end()), fences_.end());
    if (others_.empty()) return;
    levels_.resize(64);
    for (const PatchTriangle& triangle : cover(shape_, patch_)) search(triangle, others_, 0);
  }

 private:
  [[nodiscard]] bool is_own(SphereId id) const { return std::find(own_.begin(), own_.end(), id) != own_.end(); }

  /// How far sphere `id` reaches beyond the tangent plane with that normal; at most zero if it stays below.
  [[nodiscard]] double beyond(SphereId id, const Vector3d& normal, double turn) const {
    if (is_own(id)) return 0;
    const Sphere& s = shape_.sphere(id);
    const Vector3d between = s.centre - anchor_.centre;
    return normal.dot(between) + s.radius - anchor_.radius + turn * between.norm();
  }

  void search(const PatchTriangle& cell, const std::vector<Piece>& candidates, std::size_t depth) {
    const PatchReach reach = reach_of(shape_, patch_, cell);
    const PatchPoint middle = at(shape_, patch_, reach.middle);
    if ((middle.point - options_.place).norm() > options_.within + reach.distance) return;
    for (const SphereId id : fences_)
      if (beyond(id, middle.normal, 0) > reach.turn * (shape_.sphere(id).centre - anchor_.centre).norm()) return;
    std::vector<Piece>& active = levels_[depth];
    active.clear();
    for (const Piece piece : candidates) {
      const double distance = distance_to(shape_, piece, middle.point).distance;
      if (distance < -reach.distance) return;
      if (piece.kind == Piece::Kind::Edge && distance > reach.distance) continue;
      double over = -std::numeric_limits<double>::infinity();
      for (const SphereId id : shape_.spheres_of(piece))
        if (id.valid()) over = std::max(over, beyond(id, middle.normal, reach.turn));
      if (over <= 1e-12 * anchor_.radius) continue;
      // The inside of a triangle knows no distance where its edges are nearer: its box must do.
      if (piece.kind == Piece::Kind::Facet && far_from(piece, middle.point, reach.distance)) continue;
      active.push_back(piece);
    }
    if (active.empty()) return;
    if (reach.distance <= options_.resolution || depth + 1 >= levels_.size()) {
      march(cell, active);
      return;
    }
    const Vector3d ab = halfway(patch_, cell[0], cell[1]);
    const Vector3d bc = halfway(patch_, cell[1], cell[2]);
    const Vector3d ca = halfway(patch_, cell[2], cell[0]);
    for (const PatchTriangle& part : {PatchTriangle{cell[0], ab, ca}, PatchTriangle{ab, cell[1], bc},
                                      PatchTriangle{ca, bc, cell[2]}, PatchTriangle{ab, bc, ca}})
      search(part, levels_[depth], depth + 1);
  }

  [[nodiscard]] bool far_from(Piece piece, const Vector3d& point, double reach) const {
    const SphereTriple& s = shape_.facet_spheres[piece.index];
    return signed_distance(SphereTriangle{shape_.sphere(s[0]), shape_.sphere(s[1]), shape_.sphere(s[2])}, point) >
           reach;
  }

  [[nodiscard]] PieceDistance least(const std::vector<Piece>& active, const Vector3d& point) const {
    PieceDistance best;
    for (const Piece piece : active)
      if (const PieceDistance d = distance_to(shape_, piece, point); d.distance < best.distance) best = d;
    return best;
  }

  void march(const PatchTriangle& cell, const std::vector<Piece>& active) {
    std::array<double, 3> value{};
    for (std::size_t k = 0; k < 3; ++k) value[k] = least(active, at(shape_, patch_, cell[k]).point).distance;
    std::array<Vector3d, 2> ends;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if ((value[k] < 0) == (value[next] < 0)) continue;
      ends[count++] = root(active, cell[k], value[k], cell[next], value[next]);
    }
    if (count == 2) refine(active, ends[0], ends[1], 0);
  }

  /// Where the crease crosses a side of a cell, by the Illinois rule.
  [[nodiscard]] Vector3d root(const std::vector<Piece>& active, Vector3d a, double fa, Vector3d b, double fb) const {
    const double enough = 1e-3 * options_.chord;
    Vector3d x = a;
    int side = 0;
    for (int step = 0; step < 40; ++step) {
      const double t = std::isfinite(fa) && std::isfinite(fb) ? fa / (fa - fb) : 0.5;
      x = (1 - t) * a + t * b;
      if (patch_.kind == Patch::Kind::Sphere) x.normalize();
      const double fx = least(active, at(shape_, patch_, x).point).distance;
      if (std::abs(fx) < enough) break;
      if ((fx < 0) == (fb < 0)) {
        b = x;
        fb = fx;
        if (side == -1) fa /= 2;
        side = -1;
      } else {
        a = x;
        fa = fx;
        if (side == 1) fb /= 2;
        side = 1;
      }
    }
    return at(shape_, patch_, x).point;
  }

  /// Halves a piece of crease until it is as straight as asked.
  void refine(const std::vector<Piece>& active, const Vector3d& a, const Vector3d& b, int depth) {
    const Vector3d chord = b - a;
    const double length = chord.norm();
    if (!(length > 0)) return;
    Vector3d middle = (a + b) / 2;
    if (depth < kDeepest && length > options_.chord && project(active, middle)) {
      const Vector3d off = middle - a;
      const double sag = (off - chord * (off.dot(chord) / chord.squaredNorm())).norm();
      const double shift = (middle - (a + b) / 2).norm();
      if (shift < length / 2 && sag > options_.chord) {
        refine(active, a, middle, depth + 1);
        refine(active, middle, b, depth + 1);
        return;
      }
    }
    creases_.push_back({a, b});
  }

  /// Moves a point onto the patch and the nearest of the others, at right angles to the curve where they meet.
  [[nodiscard]] bool project(const std::vector<Piece>& active, Vector3d& x) const {
    for (int step = 0; step < 8; ++step) {
      const PatchPoint own = foot_on(shape_, patch_, x);
      const PieceDistance other = least(active, x);
      if (!std::isfinite(other.distance)) return false;
      const double f = own.normal.dot(x - own.point);
      if (std::abs(f) + std::abs(other.distance) < 1e-2 * options_.chord) return true;
      const Vector3d normal = normal_at(shape_, other, x);
      // The least step d with own.normal.d = -f and normal.d = -distance.
      const double c = own.normal.dot(normal);
      const double determinant = 1 - c * c;
      if (determinant < 1e-10) return false;
      x -= ((f - c * other.distance) * own.normal + (other.distance - c * f) * normal) / determinant;
    }
    return true;
  }

  const SpherePieces& shape_;
  const Patch& patch_;
  const CreaseOptions& options_;
  std::vector<OuterCrease>& creases_;
  std::vector<SphereId> own_;
  Sphere anchor_;
  std::vector<SphereId> fences_;
  std::vector<Piece> others_;
  std::vector<std::vector<Piece>> levels_;  // candidates that remain, by depth
};

}  // namespace

void find_creases(const SpherePieces& shape, std::span<const Piece> pieces, const Patch& patch,
                  const CreaseOptions& options, std::vector<OuterCrease>& creases) {
  CreaseTracer(shape, patch, options, creases).trace(pieces);
}

}  // namespace armature::sdk
