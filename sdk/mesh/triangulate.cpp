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

  /// Ear clipping (Meisters 1975). After a cut it goes on behind the next corner, which keeps fans apart. To be called
  /// once.
  void clip(std::vector<Triangle>& out) {
    blocks_.assign(flat_.size(), false);
    for (std::size_t i = 0; i < flat_.size(); ++i)
      if (!(turn(i) > 0)) {
        blocks_[i] = true;
        reflex_.push_back(i);
      }
    std::size_t at = 0;
    std::size_t passed = 0;
    std::size_t freed = 0;
    for (std::size_t left = flat_.size(); left > 3;) {
      // After a full round without an ear the polygon crosses itself or has no area: any corner will do. So it will
      // where ears are so rare that a hostile polygon would take minutes.
      const bool stuck = passed > left || tests_ > kMostTests;
      if (!stuck && !is_ear(at)) {
        at = next_[at];
        ++passed;
        continue;
      }
      out.push_back(triangle(at));
      const std::size_t before = previous_[at];
      const std::size_t after = next_[at];
      next_[before] = after;
      previous_[after] = before;
      // The ear is gone and its neighbours may have become convex; what was convex stays so.
      blocks_[at] = false;
      blocks_[before] = blocks_[before] && !(turn(before) > 0);
      blocks_[after] = blocks_[after] && !(turn(after) > 0);
      if (++freed > reflex_.size() / 2) {
        std::erase_if(reflex_, [&](std::size_t i) { return !blocks_[i]; });
        freed = 0;
      }
      --left;
      at = next_[after];
      if (!stuck) passed = 0;
    }
    out.push_back(triangle(at));
  }

 private:
  /// About a second's: enough for a spiral of 3000 corners.
  static constexpr std::size_t kMostTests = 300'000'000;

  [[nodiscard]] Triangle triangle(std::size_t i) const {
    return {corners_[previous_[i]], corners_[i], corners_[next_[i]]};
  }

  /// A corner that turns left and whose triangle holds no other corner. Only reflex corners can lie in it.
  [[nodiscard]] bool is_ear(std::size_t i) {
    const Vector2d& a = flat_[previous_[i]];
    const Vector2d& b = flat_[i];
    const Vector2d& c = flat_[next_[i]];
    if (!(cross(a, b, c) > 0)) return false;
    tests_ += reflex_.size();
    for (const std::size_t j : reflex_) {
      const Vector2d& p = flat_[j];
      // A corner that stands twice in the polygon (a bridge to a hole) does not block its own ear.
      if (!blocks_[j] || p == a || p == b || p == c) continue;
      if (cross(a, b, p) >= 0 && cross(b, c, p) >= 0 && cross(c, a, p) >= 0) return false;
    }
    return true;
  }

  std::span<const VertexId> corners_;
  std::vector<Vector2d> flat_;
  std::vector<std::size_t> next_, previous_;
  std::vector<std::size_t> reflex_;  // corners that did not turn left when last looked through
  std::vector<bool> blocks_;         // of those, which still do not
  std::size_t tests_ = 0;
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
