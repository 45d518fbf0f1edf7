#include <algorithm>

#include "sdk/distance/sphere_mesh_tree_state.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeafSize = 4;

std::optional<Passage> passage_of(const SpherePieces& shape, Piece piece, const Ray& ray) {
  const TouchedSpheres s = shape.spheres_of(piece);
  if (piece.kind == Piece::Kind::Facet)
    return passage(SphereTriangle{shape.sphere(s[0]), shape.sphere(s[1]), shape.sphere(s[2])}, ray);
  if (s[1].valid()) return passage(SphereEdge{shape.sphere(s[0]), shape.sphere(s[1])}, ray);
  return passage(shape.sphere(s[0]), ray);
}

}  // namespace

SphereMeshTree::SphereMeshTree(const SphereMesh& shape) {
  auto state = std::make_unique<State>();
  state->shape = SpherePieces(shape);
  state->frame = state->shape.frame();
  const std::vector<Piece> pieces = state->shape.all();
  std::vector<UnitBox> boxes;
  boxes.reserve(pieces.size());
  for (const Piece piece : pieces) boxes.push_back(state->shape.box_of(state->frame, piece));
  state->bvh = Bvh(boxes, kLeafSize);
  state->pieces.reserve(pieces.size());
  for (const std::uint32_t k : state->bvh.order()) state->pieces.push_back(pieces[k]);
  state_ = std::move(state);
}

SphereMeshTree::~SphereMeshTree() = default;
SphereMeshTree::SphereMeshTree(SphereMeshTree&&) noexcept = default;
SphereMeshTree& SphereMeshTree::operator=(SphereMeshTree&&) noexcept = default;

PieceDistance SphereMeshTree::State::find(const Vector3d& point, double enough) const noexcept {
  PieceDistance best;
  const Eigen::Vector3f p = frame.to_unit(point);
  // Bounds err by a few units in the last place of the point's own coordinates.
  const float slack = Bvh::kSlack * (1 + p.cwiseAbs().maxCoeff());
  bvh.descend(
      std::numeric_limits<float>::infinity(), [&](const Bvh::Node& node) { return signed_distances(node, p); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k)
          if (const PieceDistance d = distance_to(shape, pieces[k], point); d.distance < best.distance) best = d;
        if (best.distance < enough) return -std::numeric_limits<float>::infinity();
        return static_cast<float>(best.distance * frame.scale) + slack;
      });
  return best;
}

NearestSphere SphereMeshTree::nearest(const Vector3d& point) const noexcept {
  const State& s = *state_;
  NearestSphere result;
  const PieceDistance found = s.find(point, -std::numeric_limits<double>::infinity());
  result.distance = found.distance;
  if (!std::isfinite(found.distance)) return result;
  result.spheres = s.shape.spheres_of(found.piece);
  result.weights = weights_at(s.shape, found);
  result.normal = normal_at(s.shape, found, point);
  for (std::size_t k = 0; k < 3; ++k) {
    if (!result.spheres[k].valid()) continue;
    const Sphere& sphere = s.shape.sphere(result.spheres[k]);
    result.sphere.centre += result.weights[static_cast<Eigen::Index>(k)] * sphere.centre;
    result.sphere.radius += result.weights[static_cast<Eigen::Index>(k)] * sphere.radius;
  }
  return result;
}

double SphereMeshTree::signed_distance(const Vector3d& point) const noexcept {
  return state_->find(point, -std::numeric_limits<double>::infinity()).distance;
}

bool SphereMeshTree::inside(const Vector3d& point, double depth) const noexcept {
  return state_->find(point, -depth).distance < -depth;
}

std::optional<SphereMeshHit> SphereMeshTree::intersect(const Ray& ray) const {
  const State& s = *state_;
  const UnitRay unit(s.frame, ray.origin, ray.direction);
  struct Part {
    Passage through;
    Piece piece;
  };
  // From outside the first entry is the answer. From inside, what lies ahead without a gap must be known.
  const bool from_inside = inside(ray.origin);
  std::vector<Part> parts;
  std::optional<Part> first_part;
  float limit = std::numeric_limits<float>::max();
  s.bvh.descend(
      limit, [&](const Bvh::Node& node) { return entries(node, unit); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k) {
          const auto through = passage_of(s.shape, s.pieces[k], ray);
          if (!through || !(through->exit.t > 0)) continue;
          if (from_inside) {
            parts.push_back({*through, s.pieces[k]});
          } else if (through->entry.t > 0 && (!first_part || through->entry.t < first_part->through.entry.t)) {
            first_part = Part{*through, s.pieces[k]};
            limit = static_cast<float>(through->entry.t) * (1 + Bvh::kSlack);
          }
        }
        return limit;
      });

  Crossing crossing;
  Piece piece{};
  if (from_inside) {
    std::sort(parts.begin(), parts.end(),
              [](const Part& a, const Part& b) { return a.through.entry.t < b.through.entry.t; });
    crossing.t = 0;
    for (const Part& part : parts) {
      if (part.through.entry.t > crossing.t) break;
      if (part.through.exit.t <= crossing.t) continue;
      crossing = part.through.exit;
      piece = part.piece;
    }
    if (!(crossing.t > 0)) return std::nullopt;
  } else {
    if (!first_part) return std::nullopt;
    crossing = first_part->through.entry;
    piece = first_part->piece;
  }
  SphereMeshHit hit{crossing.t, s.shape.spheres_of(piece), crossing.weights, Vector3d::UnitZ()};
  Vector3d centre = Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    if (hit.spheres[k].valid())
      centre += hit.weights[static_cast<Eigen::Index>(k)] * s.shape.sphere(hit.spheres[k]).centre;
  const Vector3d outward = ray.origin + hit.t * ray.direction - centre;
  if (const double size = outward.norm(); size > 0) hit.normal = outward / size;
  return hit;
}

std::array<Vector3d, 2> SphereMeshTree::bounds() const noexcept {
  return {state_->shape.lower, state_->shape.upper};
}

}  // namespace armature::sdk
