#include <numeric>

#include <armature/sdk/distance/sphere_mesh_tree.h>

#include "sdk/distance/bvh.h"
#include "sdk/spheremesh/gauges.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeafSize = 4;

/// The pieces that distances are taken to: the insides of triangles, every edge once, spheres on no edge (as edges of
/// no length). A triangle's own edges cover what its inside does not.
enum class PieceKind : std::uint8_t { Edge, Facet };
struct Piece {
  PieceKind kind;
  std::uint32_t index;
};

}  // namespace

struct SphereMeshTree::State {
  std::vector<Sphere> spheres;
  std::vector<EdgeGauge> edges;
  std::vector<std::array<SphereId, 2>> edge_spheres;  // the second not valid for a sphere alone
  std::vector<FacetGauge> facets;
  std::vector<SphereTriple> facet_spheres;
  std::vector<Piece> pieces;  // in the order of the leaves
  UnitFrame frame;
  Bvh bvh;
  Vector3d lower = Vector3d::Zero(), upper = Vector3d::Zero();

  struct Found {
    double distance = std::numeric_limits<double>::infinity();
    Piece piece{PieceKind::Edge, 0};
    double b = 0, c = 0;  // along an edge; weights within a triangle
  };
  /// Looks for the least signed distance and stops early once it is below `enough`.
  [[nodiscard]] Found find(const Vector3d& point, double enough) const noexcept;

  [[nodiscard]] TouchedSpheres spheres_of(const Piece& piece) const noexcept {
    if (piece.kind == PieceKind::Facet) return facet_spheres[piece.index];
    return {edge_spheres[piece.index][0], edge_spheres[piece.index][1], SphereId()};
  }
  [[nodiscard]] std::optional<Passage> passage_of(const Piece& piece, const Ray& ray) const noexcept {
    const TouchedSpheres s = spheres_of(piece);
    const auto sphere = [&](std::size_t k) { return spheres[s[k].index()]; };
    if (piece.kind == PieceKind::Facet) return passage(SphereTriangle{sphere(0), sphere(1), sphere(2)}, ray);
    if (s[1].valid()) return passage(SphereEdge{sphere(0), sphere(1)}, ray);
    return passage(sphere(0), ray);
  }
};

SphereMeshTree::SphereMeshTree(const SphereMesh& shape) {
  auto state = std::make_unique<State>();
  State& s = *state;
  s.spheres = shape.spheres;

  s.edge_spheres.reserve(shape.edges.size() + 3 * shape.triangles.size());
  const auto add_edge = [&](SphereId a, SphereId b) { s.edge_spheres.push_back({std::min(a, b), std::max(a, b)}); };
  for (const auto& [a, b] : shape.edges) add_edge(a, b);
  for (const auto& [a, b, c] : shape.triangles) add_edge(a, b), add_edge(b, c), add_edge(a, c);
  std::sort(s.edge_spheres.begin(), s.edge_spheres.end());
  s.edge_spheres.erase(std::unique(s.edge_spheres.begin(), s.edge_spheres.end()), s.edge_spheres.end());
  std::vector<bool> on_edge(shape.spheres.size(), false);
  for (const auto& pair : s.edge_spheres)
    for (const SphereId id : pair) on_edge[id.index()] = true;
  for (std::size_t k = 0; k < on_edge.size(); ++k)
    if (!on_edge[k]) s.edge_spheres.push_back({SphereId(k), SphereId()});

  struct Corners {
    Vector3d lower, upper;
  };
  std::vector<Corners> corners;
  std::vector<Piece> pieces;
  const auto add_piece = [&](PieceKind kind, std::size_t index, const TouchedSpheres& ids) {
    Corners box{Vector3d::Constant(std::numeric_limits<double>::infinity()),
                Vector3d::Constant(-std::numeric_limits<double>::infinity())};
    for (const SphereId id : ids) {
      if (!id.valid()) continue;
      const Sphere& sphere = s.spheres[id.index()];
      box.lower = box.lower.cwiseMin((sphere.centre.array() - sphere.radius).matrix());
      box.upper = box.upper.cwiseMax((sphere.centre.array() + sphere.radius).matrix());
    }
    corners.push_back(box);
    pieces.push_back({kind, static_cast<std::uint32_t>(index)});
  };
  for (std::size_t k = 0; k < s.edge_spheres.size(); ++k) {
    const auto [a, b] = s.edge_spheres[k];
    s.edges.emplace_back(SphereEdge{shape.sphere(a), shape.sphere(b.valid() ? b : a)});
    add_piece(PieceKind::Edge, k, {a, b, SphereId()});
  }
  for (const SphereTriple& triple : shape.triangles) {
    const FacetGauge gauge({shape.sphere(triple[0]), shape.sphere(triple[1]), shape.sphere(triple[2])});
    if (!gauge.exists) continue;
    s.facets.push_back(gauge);
    s.facet_spheres.push_back(triple);
    add_piece(PieceKind::Facet, s.facets.size() - 1, triple);
  }

  if (!corners.empty()) {
    s.lower = corners.front().lower;
    s.upper = corners.front().upper;
    for (const Corners& box : corners) {
      s.lower = s.lower.cwiseMin(box.lower);
      s.upper = s.upper.cwiseMax(box.upper);
    }
    s.frame = UnitFrame(s.lower, s.upper);
  }
  std::vector<UnitBox> boxes;
  boxes.reserve(corners.size());
  for (const Corners& box : corners) boxes.push_back(unit_box(s.frame, box.lower, box.upper));
  s.bvh = Bvh(boxes, kLeafSize);
  s.pieces.reserve(pieces.size());
  for (const std::uint32_t k : s.bvh.order()) s.pieces.push_back(pieces[k]);
  state_ = std::move(state);
}

SphereMeshTree::~SphereMeshTree() = default;
SphereMeshTree::SphereMeshTree(SphereMeshTree&&) noexcept = default;
SphereMeshTree& SphereMeshTree::operator=(SphereMeshTree&&) noexcept = default;

SphereMeshTree::State::Found SphereMeshTree::State::find(const Vector3d& point, double enough) const noexcept {
  Found best;
  const Eigen::Vector3f p = frame.to_unit(point);
  // Bounds err by a few units in the last place of the point's own coordinates.
  const float slack = Bvh::kSlack * (1 + p.cwiseAbs().maxCoeff());
  bvh.descend(
      std::numeric_limits<float>::infinity(), [&](const Bvh::Node& node) { return signed_distances(node, p); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k) {
          const Piece piece = pieces[k];
          double b = 0;
          double c = 0;
          double distance = 0;
          if (piece.kind == PieceKind::Facet) {
            if (!facets[piece.index].distance(point, distance, b, c)) continue;
          } else {
            distance = edges[piece.index].distance(point, b);
          }
          if (distance < best.distance) best = {distance, piece, b, c};
        }
        if (best.distance < enough) return -std::numeric_limits<float>::infinity();
        return static_cast<float>(best.distance * frame.scale) + slack;
      });
  return best;
}

NearestSphere SphereMeshTree::nearest(const Vector3d& point) const noexcept {
  const State& s = *state_;
  NearestSphere result;
  const State::Found found = s.find(point, -std::numeric_limits<double>::infinity());
  result.distance = found.distance;
  if (!std::isfinite(found.distance)) return result;
  result.spheres = s.spheres_of(found.piece);
  if (found.piece.kind == PieceKind::Facet) {
    result.weights = {1 - found.b - found.c, found.b, found.c};
    const FacetGauge& facet = s.facets[found.piece.index];
    result.normal = facet.normal(facet.n.dot(point - facet.a) < 0 ? -1 : 1);
  } else {
    const EdgeGauge& edge = s.edges[found.piece.index];
    const double blend = edge.blend(found.b);
    result.weights = {1 - blend, blend, 0};
    result.normal = edge.normal(point, found.b);
  }
  result.sphere.centre.setZero();
  for (std::size_t k = 0; k < 3; ++k) {
    if (!result.spheres[k].valid()) continue;
    const Sphere& sphere = s.spheres[result.spheres[k].index()];
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

std::optional<SphereMeshHit> SphereMeshTree::intersect(const Ray& ray) const noexcept {
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
          const auto through = s.passage_of(s.pieces[k], ray);
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
  SphereMeshHit hit{crossing.t, s.spheres_of(piece), crossing.weights, Vector3d::UnitZ()};
  Vector3d centre = Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    if (hit.spheres[k].valid())
      centre += hit.weights[static_cast<Eigen::Index>(k)] * s.spheres[hit.spheres[k].index()].centre;
  const Vector3d outward = ray.origin + hit.t * ray.direction - centre;
  if (const double size = outward.norm(); size > 0) hit.normal = outward / size;
  return hit;
}

std::array<Vector3d, 2> SphereMeshTree::bounds() const noexcept {
  return {state_->lower, state_->upper};
}

}  // namespace armature::sdk
