#include <cstdint>
#include <utility>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/triangulate.h>

namespace armature::sdk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

double cross(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// A polygon laid into its plane, counter-clockwise, as a ring that shrinks as ears are cut off.
class Ring {
 public:
  Ring(std::span<const VertexId> corners, std::span<const Vector3d> positions) : corners_(corners) {
    const std::size_t n = corners.size();
    const Vector3d origin = positions[corners[0].index()];
    Vector3d normal = Vector3d::Zero();
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3d a = positions[corners[i].index()] - origin;
      const Vector3d b = positions[corners[(i + 1) % n].index()] - origin;
      normal += a.cross(b);
    }
    const double length = normal.norm();
    if (!(length > 0)) return;
    normal /= length;
    const Vector3d u = normal.unitOrthogonal();
    const Vector3d v = normal.cross(u);
    flat_.reserve(n);
    for (const VertexId corner : corners) {
      const Vector3d p = positions[corner.index()] - origin;
      flat_.emplace_back(p.dot(u), p.dot(v));
    }
    next_.resize(n);
    previous_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      next_[i] = (i + 1) % n;
      previous_[i] = (i + n - 1) % n;
    }
  }

  /// Whether there is a plane to work in.
  [[nodiscard]] bool has_plane() const { return !flat_.empty(); }

  [[nodiscard]] double turn(std::size_t i) const { return cross(flat_[previous_[i]], flat_[i], flat_[next_[i]]); }

  [[nodiscard]] bool convex() const {
    for (std::size_t i = 0; i < flat_.size(); ++i)
      if (!(turn(i) > 0)) return false;
    return true;
  }

  /// Ear clipping (Meisters 1975). After a cut it goes on behind the next corner, which keeps fans apart.
  void clip(std::vector<Triangle>& out) {
    std::vector<std::size_t> reflex;
    for (std::size_t i = 0; i < flat_.size(); ++i)
      if (!(turn(i) > 0)) reflex.push_back(i);
    std::vector<bool> cut(flat_.size(), false);
    std::size_t at = 0;
    std::size_t passed = 0;
    for (std::size_t left = flat_.size(); left > 3;) {
      // After a full round without an ear the polygon crosses itself or has no area: any corner will do.
      const bool stuck = passed > left;
      if (!stuck && !is_ear(at, reflex, cut)) {
        at = next_[at];
        ++passed;
        continue;
      }
      out.push_back(triangle(at));
      cut[at] = true;
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      --left;
      at = next_[next_[at]];
      if (!stuck) passed = 0;
      std::erase_if(reflex, [&](std::size_t i) { return cut[i] || turn(i) > 0; });
    }
    while (cut[at]) at = next_[at];
    out.push_back(triangle(at));
  }

 private:
  [[nodiscard]] Triangle triangle(std::size_t i) const {
    return {corners_[previous_[i]], corners_[i], corners_[next_[i]]};
  }

  /// A corner that turns left and whose triangle holds no other corner. Only reflex corners can lie in it.
  [[nodiscard]] bool is_ear(std::size_t i, const std::vector<std::size_t>& reflex, const std::vector<bool>& cut) const {
    const Vector2d& a = flat_[previous_[i]];
    const Vector2d& b = flat_[i];
    const Vector2d& c = flat_[next_[i]];
    if (!(cross(a, b, c) > 0)) return false;
    for (const std::size_t j : reflex) {
      const Vector2d& p = flat_[j];
      // A corner that stands twice in the polygon (a bridge to a hole) does not block its own ear.
      if (cut[j] || p == a || p == b || p == c) continue;
      if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::span<const VertexId> corners_;
  std::vector<Vector2d> flat_;
  std::vector<std::size_t> next_, previous_;
};

void fan(std::span<const VertexId> corners, std::vector<Triangle>& out) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) out.push_back({corners[0], corners[i], corners[i + 1]});
}

}  // namespace

void triangulate_polygon(std::span<const VertexId> corners, std::span<const Vector3d> positions,
                         std::vector<Triangle>& out) {
  if (corners.size() == 3) return fan(corners, out);
  Ring ring(corners, positions);
  if (!ring.has_plane() || ring.convex()) return fan(corners, out);
  ring.clip(out);
}

}  // namespace armature::sdk
