#include <Eigen/Geometry>
#include <armature/sdk/distance/mesh_tree.h>

#include "sdk/distance/bvh.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeafSize = 4;
constexpr double kSliver = 1e-20;  // squared sine below which a face is taken for its three sides

/// A triangle with what its closest point needs.
struct Facet {
  Vector3d a, ab, ac;
  double ab_ab, ab_ac, ac_ac;
  std::uint32_t face;
  bool sliver;
};

/// Where on a facet: a + v ab + w ac.
struct Place {
  double v = 0;
  double w = 0;
};

Place closest_on_sides(const Facet& f, const Vector3d& ap) noexcept {
  const auto along = [](const Vector3d& side, const Vector3d& from_start) {
    const double length2 = side.squaredNorm();
    return length2 > 0 ? std::clamp(side.dot(from_start) / length2, 0.0, 1.0) : 0.0;
  };
  const double on_ab = along(f.ab, ap);
  const double on_ac = along(f.ac, ap);
  const double on_bc = along(f.ac - f.ab, ap - f.ab);
  Place best;
  double least = std::numeric_limits<double>::infinity();
  for (const Place place : {Place{on_ab, 0}, Place{0, on_ac}, Place{1 - on_bc, on_bc}}) {
    const double distance2 = (ap - place.v * f.ab - place.w * f.ac).squaredNorm();
    if (distance2 < least) {
      least = distance2;
      best = place;
    }
  }
  return best;
}

/// Ericson, Real-Time Collision Detection, section 5.1.5.
Place closest_place(const Facet& f, const Vector3d& ap) noexcept {
  if (f.sliver) return closest_on_sides(f, ap);
  const double d1 = f.ab.dot(ap);
  const double d2 = f.ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {};
  const double d3 = d1 - f.ab_ab;
  const double d4 = d2 - f.ab_ac;
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {d1 / f.ab_ab, 0};
  const double d5 = d1 - f.ab_ac;
  const double d6 = d2 - f.ac_ac;
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, d2 / f.ac_ac};
  const double va = d3 * d6 - d5 * d4;
  const double b_side = d4 - d3;
  const double c_side = d5 - d6;
  if (va <= 0 && b_side >= 0 && c_side >= 0) {
    const double w = b_side / (b_side + c_side);
    return {1 - w, w};
  }
  const double scale = 1 / (va + vb + vc);
  return {vb * scale, vc * scale};
}

}  // namespace

struct MeshTree::State {
  UnitFrame frame;
  Bvh bvh;
  std::vector<Facet> facets;             // in the order of the leaves
  std::vector<std::uint32_t> place_of_;  // by face

  [[nodiscard]] int winding(const Vector3d& point, const Vector3d& direction) const noexcept;
};

MeshTree::MeshTree(const Mesh& mesh) {
  auto state = std::make_unique<State>();
  const std::size_t count = mesh.triangles.size();
  Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d upper = -lower;
  for (const Triangle& triangle : mesh.triangles)
    for (const VertexId v : triangle) {
      lower = lower.cwiseMin(mesh.position(v));
      upper = upper.cwiseMax(mesh.position(v));
    }
  if (count > 0) state->frame = UnitFrame(lower, upper);
  std::vector<UnitBox> boxes(count);
  for (std::size_t k = 0; k < count; ++k) {
    const Vector3d& a = mesh.corner(FaceId(k), 0);
    const Vector3d& b = mesh.corner(FaceId(k), 1);
    const Vector3d& c = mesh.corner(FaceId(k), 2);
    boxes[k] = unit_box(state->frame, a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c));
  }
  state->bvh = Bvh(boxes, kLeafSize);
  state->facets.reserve(count);
  state->place_of_.resize(count);
  for (const std::uint32_t k : state->bvh.order()) {
    Facet f;
    f.face = k;
    f.a = mesh.corner(FaceId(k), 0);
    f.ab = mesh.corner(FaceId(k), 1) - f.a;
    f.ac = mesh.corner(FaceId(k), 2) - f.a;
    f.ab_ab = f.ab.squaredNorm();
    f.ab_ac = f.ab.dot(f.ac);
    f.ac_ac = f.ac.squaredNorm();
    const double longest2 = std::max({f.ab_ab, f.ac_ac, (f.ac - f.ab).squaredNorm()});
    f.sliver = !(f.ab.cross(f.ac).squaredNorm() > kSliver * longest2 * longest2);
    state->place_of_[k] = static_cast<std::uint32_t>(state->facets.size());
    state->facets.push_back(f);
  }
  state_ = std::move(state);
}

MeshTree::~MeshTree() = default;
MeshTree::MeshTree(MeshTree&&) noexcept = default;
MeshTree& MeshTree::operator=(MeshTree&&) noexcept = default;

SurfacePoint MeshTree::closest(const Vector3d& point, const SearchStart& start) const noexcept {
  const State& s = *state_;
  const Facet* nearest = nullptr;
  Place nearest_place;
  double least2 = start.within * start.within;
  const auto look_at = [&](const Facet& f) {
    const Vector3d ap = point - f.a;
    const Place place = closest_place(f, ap);
    const double distance2 = (ap - place.v * f.ab - place.w * f.ac).squaredNorm();
    if (distance2 < least2 || (!nearest && distance2 <= least2)) {
      least2 = distance2;
      nearest = &f;
      nearest_place = place;
    }
  };
  if (start.hint.index() < s.facets.size()) look_at(s.facets[s.place_of_[start.hint.index()]]);

  const Eigen::Vector3f p = s.frame.to_unit(point);
  const double to_unit2 = s.frame.scale * s.frame.scale;
  const auto limit = [&] { return static_cast<float>(least2 * to_unit2) * (1 + Bvh::kSlack); };
  s.bvh.descend(
      limit(), [&](const Bvh::Node& node) { return squared_distances(node, p); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k) look_at(s.facets[k]);
        return limit();
      });
  if (!nearest) return {};
  const auto [v, w] = nearest_place;
  return {FaceId(nearest->face),
          nearest->a + v * nearest->ab + w * nearest->ac,
          {std::max(0.0, 1 - v - w), v, w},
          std::sqrt(least2)};
}

namespace {

/// Moeller and Trumbore. `side` is positive where the ray leaves through the face's front.
struct Crossing {
  double t, v, w, side;
};
std::optional<Crossing> cross(const Facet& f, const Vector3d& origin, const Vector3d& direction) noexcept {
  const Vector3d p = direction.cross(f.ac);
  const double determinant = f.ab.dot(p);
  if (determinant == 0) return std::nullopt;
  const Vector3d from_a = origin - f.a;
  const double v = from_a.dot(p) / determinant;
  if (!(v >= 0 && v <= 1)) return std::nullopt;
  const Vector3d q = from_a.cross(f.ab);
  const double w = direction.dot(q) / determinant;
  if (!(w >= 0 && v + w <= 1)) return std::nullopt;
  return Crossing{f.ac.dot(q) / determinant, v, w, -determinant};
}

}  // namespace

std::optional<MeshHit> MeshTree::intersect(const Ray& ray) const noexcept {
  const State& s = *state_;
  const UnitRay unit(s.frame, ray.origin, ray.direction);
  std::optional<MeshHit> first_hit;
  float limit = std::numeric_limits<float>::max();
  s.bvh.descend(
      limit, [&](const Bvh::Node& node) { return entries(node, unit); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k) {
          const auto crossing = cross(s.facets[k], ray.origin, ray.direction);
          if (!crossing || !(crossing->t > 0) || (first_hit && crossing->t >= first_hit->t)) continue;
          first_hit = {
              FaceId(s.facets[k].face), crossing->t, {1 - crossing->v - crossing->w, crossing->v, crossing->w}};
          limit = static_cast<float>(crossing->t) * (1 + Bvh::kSlack);
        }
        return limit;
      });
  return first_hit;
}

int MeshTree::State::winding(const Vector3d& point, const Vector3d& direction) const noexcept {
  const UnitRay unit(frame, point, direction);
  constexpr float kFar = std::numeric_limits<float>::max();
  int turns = 0;
  bvh.descend(
      kFar, [&](const Bvh::Node& node) { return entries(node, unit); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k) {
          const auto crossing = cross(facets[k], point, direction);
          if (crossing && crossing->t > 0) turns += crossing->side > 0 ? 1 : -1;
        }
        return kFar;
      });
  return turns;
}

bool MeshTree::inside(const Vector3d& point) const noexcept {
  const int a = state_->winding(point, {0.8361, 0.4673, 0.2877});
  const int b = state_->winding(point, {-0.3541, 0.7193, -0.5977});
  if (a == b) return a != 0;
  const int c = state_->winding(point, {0.1789, -0.5939, -0.7843});
  return (c == a || c == b) && c != 0;
}

}  // namespace armature::sdk
