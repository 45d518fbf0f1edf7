#include <Eigen/Geometry>
#include <armature/sdk/distance/mesh_tree.h>

#include "sdk/distance/bvh.h"
#include "sdk/distance/facet.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeafSize = 4;

struct NumberedFacet : Facet {
  std::uint32_t face;
};

}  // namespace

struct MeshTree::State {
  UnitFrame frame;
  Bvh bvh;
  std::vector<NumberedFacet> facets;     // in the order of the leaves
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
    const auto corner = [&](std::size_t c) -> const Vector3d& { return mesh.corner(FaceId(k), c); };
    state->place_of_[k] = static_cast<std::uint32_t>(state->facets.size());
    state->facets.push_back({Facet(corner(0), corner(1), corner(2)), k});
  }
  state_ = std::move(state);
}

MeshTree::~MeshTree() = default;
MeshTree::MeshTree(MeshTree&&) noexcept = default;
MeshTree& MeshTree::operator=(MeshTree&&) noexcept = default;

SurfacePoint MeshTree::closest(const Vector3d& point, const SearchStart& start) const noexcept {
  const State& s = *state_;
  const NumberedFacet* nearest = nullptr;
  Facet::Place nearest_place;
  double least2 = start.within * start.within;
  const auto look_at = [&](const NumberedFacet& f) {
    const Facet::Place place = f.closest(point);
    const double distance2 = f.squared_distance(point, place);
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
  return {FaceId(nearest->face), nearest->at(nearest_place), {std::max(0.0, 1 - v - w), v, w}, std::sqrt(least2)};
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
