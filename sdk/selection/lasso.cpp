#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Geometry>
#include <armature/sdk/selection/lasso.h>
#include <tbb/parallel_for.h>

#include "sdk/selection/flood.h"

namespace armature::sdk {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The picture plane: where points are seen.
class Picture {
 public:
  explicit Picture(const Lasso& lasso) {
    if (const auto* eye = std::get_if<Eye>(&lasso.seen_from)) {
      eye_ = eye->position;
      for (const Vector3d& point : lasso.loop) ahead_ += (point - *eye_).stableNormalized();
    } else {
      ahead_ = std::get<Gaze>(lasso.seen_from).direction;
    }
    ahead_.stableNormalize();
    right_ = ahead_.unitOrthogonal();
    down_ = ahead_.cross(right_);
  }

  /// Whether there is a direction to look in.
  [[nodiscard]] bool valid() const { return ahead_.allFinite() && ahead_.norm() > 0.5; }
  /// Nothing for what is at the eye or behind it.
  [[nodiscard]] std::optional<Vector2d> seen(const Vector3d& point) const {
    const Vector3d x = eye_ ? Vector3d(point - *eye_) : point;
    const double depth = x.dot(ahead_);
    if (eye_ && !(depth > 0)) return std::nullopt;
    return Vector2d(x.dot(right_), x.dot(down_)) / (eye_ ? depth : 1);
  }
  /// From where the line of sight to a point comes, outside of a box of that diagonal.
  [[nodiscard]] Vector3d viewer_of(const Vector3d& point, double diagonal) const {
    return eye_ ? *eye_ : Vector3d(point - 2 * diagonal * ahead_);
  }

 private:
  std::optional<Vector3d> eye_;
  Vector3d ahead_ = Vector3d::Zero(), right_, down_;
};

/// How often a loop winds around a point.
int winding(const std::vector<Vector2d>& loop, const Vector2d& p) {
  int turns = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector2d& a = loop[i];
    const Vector2d& b = loop[(i + 1) % loop.size()];
    if ((a.y() <= p.y()) == (b.y() <= p.y())) continue;
    const double side = (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
    if (a.y() <= p.y() && side > 0) ++turns;
    if (a.y() > p.y() && side < 0) --turns;
  }
  return turns;
}

}  // namespace

Expected<std::vector<FaceId>> select_lasso(const Surface& surface, const Lasso& lasso) {
  if (lasso.loop.size() < 3) return fail("the lasso has less than three points; draw it around something");
  const Picture picture(lasso);
  std::vector<Vector2d> loop;
  Eigen::AlignedBox2d box;
  for (std::size_t i = 0; i < lasso.loop.size(); ++i) {
    const std::string name = "loop, point " + std::to_string(i) + ": ";
    if (!lasso.loop[i].allFinite()) return fail(name + "expected finite coordinates");
    if (!picture.valid()) return fail("the lasso's picture looks in no direction; expected one of a length above 0");
    const auto seen = picture.seen(lasso.loop[i]);
    if (!seen) return fail(name + "lies at the eye or behind it; expected points in front of it");
    loop.push_back(*seen);
    box.extend(*seen);
  }

  const Mesh& mesh = surface.mesh;
  constexpr double kTouches = 1e-6;  // of the way to a face: nearer than that is the face itself
  std::vector<std::uint8_t> taken(mesh.triangles.size());
  tbb::parallel_for(std::size_t{0}, taken.size(), [&](std::size_t f) {
    const Vector3d at = middle(mesh, FaceId(f));
    const auto seen = picture.seen(at);
    if (!seen || !box.contains(*seen) || winding(loop, *seen) == 0) return;
    if (!lasso.through) {
      const Vector3d viewer = picture.viewer_of(at, surface.diagonal);
      const auto hit = surface.tree.intersect({viewer, at - viewer});
      if (hit && hit->face != FaceId(f) && hit->t < 1 - kTouches) return;
    }
    taken[f] = 1;
  });
  std::vector<FaceId> faces;
  for (std::size_t f = 0; f < taken.size(); ++f)
    if (taken[f] != 0) faces.emplace_back(f);
  if (faces.empty()) return fail("no face is seen inside the lasso; draw it around some");
  return faces;
}

}  // namespace armature::sdk
