#include "sdk/spheremesh/union_moves.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <Eigen/Cholesky>
#include <armature/sdk/spheremesh/make_sphere_mesh.h>
#include <tbb/parallel_for.h>

namespace armature::sdk {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;
using Eigen::Vector4d;

constexpr std::uint32_t kThin = 3;  // of so many samples one is looked at, where much is compared
constexpr double kNear = 0.03;      // radius of the place that a new sphere is for

std::uint32_t index_of(SphereId id) noexcept {
  return static_cast<std::uint32_t>(id.index());
}

/// Pieces with a corner among these.
PieceFilter pieces_at(std::vector<std::uint32_t> corners) {
  return [corners = std::move(corners)](const Corners& piece) {
    return std::any_of(piece.begin(), piece.end(),
                       [&](std::uint32_t c) { return std::find(corners.begin(), corners.end(), c) != corners.end(); });
  };
}

}  // namespace

/// A change of the connectivity alone.
struct UnionMoves::Edit {
  enum class Kind : std::uint8_t { DropTriangle, DropEdge, AddTriangle, Flip } kind;
  std::vector<SphereId> spheres;  ///< of a flip: the ends of the edge, then the corners across
  double gain = 0;
};

struct UnionMoves::Collapse {
  SphereId keep, drop;
  Sphere sphere;
  double cost = std::numeric_limits<double>::infinity();
};

UnionMoves::UnionMoves(const UnionFit& fit, const SphereMesh& shape, const OuterSpace& outer,
                       const std::vector<bool>& fixed)
    : fit_(fit),
      shape_(shape),
      fixed_(fixed),
      gauge_(shape),
      outer_(outer),
      stars_(shape),
      touches_(fit.samples().points.size()),
      touched_by_(shape.spheres.size()) {
  touch_all(gauge_, fit.samples().points, touches_);
  for (std::uint32_t k = 0; k < touches_.size(); ++k) {
    if (k < fit.plain_count() && k % kThin != 0) continue;
    for (std::size_t c = 0; c < 3; ++c)
      if (touches_[k].weights[c] > 0) touched_by_[touches_[k].corners[c]].push_back(k);
  }
}

double UnionMoves::cost(std::uint32_t sample, double distance) const {
  return fit_.forward_cost(sample, distance) * (sample < fit_.plain_count() ? kThin : 1);
}

double UnionMoves::forward_cost(const SphereMesh& shape, std::span<const std::uint32_t> samples) const {
  const UnionGauge gauge(shape);
  std::vector<Vector3d> points;
  points.reserve(samples.size());
  for (const std::uint32_t k : samples) points.push_back(fit_.samples().points[k]);
  std::vector<UnionTouch> touches(points.size());
  touch_all(gauge, points, touches);
  double sum = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) sum += cost(samples[i], touches[i].distance);
  return sum;
}

double UnionMoves::back_cost(const SphereMesh& shape, const std::vector<std::uint32_t>& corners) const {
  return fit_.back_cost(UnionGauge(shape), outer_, pieces_at(corners), kThin);
}

std::vector<std::uint32_t> UnionMoves::at_stake(const Edit& edit) const {
  std::vector<std::uint32_t> pieces;
  const auto facet = [&](SphereId a, SphereId b, SphereId c) {
    SphereTriple triangle{a, b, c};
    std::sort(triangle.begin(), triangle.end());
    const auto found = std::lower_bound(shape_.triangles.begin(), shape_.triangles.end(), triangle);
    pieces.push_back(
        static_cast<std::uint32_t>(gauge_.edge_count() + static_cast<std::size_t>(found - shape_.triangles.begin())));
  };
  const auto edge = [&](SphereId a, SphereId b) {
    pieces.push_back(static_cast<std::uint32_t>(gauge_.edge_between(index_of(a), index_of(b))));
  };
  const auto& s = edit.spheres;
  switch (edit.kind) {
    case Edit::Kind::DropTriangle: facet(s[0], s[1], s[2]); break;
    case Edit::Kind::DropEdge: edge(s[0], s[1]); break;
    case Edit::Kind::AddTriangle: edge(s[0], s[1]), edge(s[1], s[2]), edge(s[0], s[2]); break;
    case Edit::Kind::Flip: facet(s[0], s[1], s[2]), facet(s[0], s[1], s[3]), edge(s[0], s[1]); break;
  }
  return pieces;
}

SphereMesh UnionMoves::added(const Edit& edit) const {
  SphereMesh added;
  const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
    added.triangles.push_back({SphereId(a), SphereId(b), SphereId(c)});
  };
  if (edit.kind == Edit::Kind::AddTriangle) add(0, 1, 2);
  if (edit.kind == Edit::Kind::Flip) add(0, 2, 3), add(1, 2, 3);
  if (!added.triangles.empty())
    for (const SphereId id : edit.spheres) added.spheres.push_back(shape_.sphere(id));
  return added;
}

double UnionMoves::forward_gain(const Edit& edit, const std::vector<std::uint32_t>& stake,
                                const SphereMesh& after) const {
  const UnionGauge gauge(added(edit));
  const NearbyPieces pieces = gauge.all();
  std::vector<std::uint32_t> samples;
  for (const SphereId id : edit.spheres)
    samples.insert(samples.end(), touched_by_[id.index()].begin(), touched_by_[id.index()].end());
  std::sort(samples.begin(), samples.end());
  samples.erase(std::unique(samples.begin(), samples.end()), samples.end());

  // Where the nearest piece stays, only what is added can come nearer.
  double gain = 0;
  std::vector<std::uint32_t> elsewhere;
  for (const std::uint32_t k : samples) {
    const UnionTouch& touch = touches_[k];
    if (std::find(stake.begin(), stake.end(), touch.piece) != stake.end()) {
      elsewhere.push_back(k);
    } else if (!pieces.entries.empty()) {
      const double there = gauge.touch(pieces, fit_.samples().points[k]).distance;
      if (there < touch.distance) gain += cost(k, touch.distance) - cost(k, there);
    }
  }
  for (const std::uint32_t k : elsewhere) gain += cost(k, touches_[k].distance);
  return gain - forward_cost(after, elsewhere);
}

SphereMesh UnionMoves::applied(const SphereMesh& shape, const Edit& edit) {
  const auto& s = edit.spheres;
  switch (edit.kind) {
    case Edit::Kind::DropTriangle: return without(shape, SphereTriple{s[0], s[1], s[2]});
    case Edit::Kind::DropEdge: return without(shape, SpherePair{s[0], s[1]});
    case Edit::Kind::AddTriangle: return with(shape, SphereTriple{s[0], s[1], s[2]});
    case Edit::Kind::Flip: return flipped(shape, s[0], s[1], s[2], s[3]);
  }
  return shape;
}

std::vector<UnionMoves::Edit> UnionMoves::edits() const {
  std::vector<Edit> edits;
  for (const auto& [a, b, c] : shape_.triangles) edits.push_back({Edit::Kind::DropTriangle, {a, b, c}});
  for (const auto& [a, b] : shape_.edges) edits.push_back({Edit::Kind::DropEdge, {a, b}});

  for (std::size_t e = 0; e < gauge_.edge_count(); ++e) {
    const auto [ia, ib] = gauge_.edge_corners(e);
    if (ia == ib) continue;
    const SphereId a(ia);
    const SphereId b(ib);
    std::vector<SphereId> common;
    std::set_intersection(stars_.neighbours(a).begin(), stars_.neighbours(a).end(), stars_.neighbours(b).begin(),
                          stars_.neighbours(b).end(), std::back_inserter(common));
    std::vector<SphereId> across;
    for (const SphereId c : common) {
      SphereTriple triangle{a, b, c};
      std::sort(triangle.begin(), triangle.end());
      if (std::binary_search(shape_.triangles.begin(), shape_.triangles.end(), triangle))
        across.push_back(c);
      else if (b < c)
        edits.push_back({Edit::Kind::AddTriangle, {a, b, c}});
    }
    if (across.size() == 2) edits.push_back({Edit::Kind::Flip, {a, b, across[0], across[1]}});
  }
  return edits;
}

double UnionMoves::gain(const Edit& edit) const {
  const ShapePart part = stars_.around(edit.spheres);
  Edit within = edit;
  for (SphereId& id : within.spheres) id = part.part_id(id);
  std::vector<std::uint32_t> corners;
  for (const SphereId id : within.spheres) corners.push_back(index_of(id));

  const SphereMesh after = applied(part.shape, within);
  const std::vector<std::uint32_t> stake = at_stake(edit);
  const double forward = forward_gain(edit, stake, after);
  double saves = 0;
  for (const std::uint32_t piece : stake) saves += back_costs_[piece];
  if (forward + saves <= 0) return 0;

  if (edit.kind == Edit::Kind::DropTriangle || edit.kind == Edit::Kind::DropEdge) {
    // What walls off a cavity stays, or all of the cavity would become outside.
    const UnionGauge gauge(part.shape);
    const PieceFilter itself = [&](const Corners& piece) {
      return std::all_of(corners.begin(), corners.end(),
                         [&](std::uint32_t c) { return std::find(piece.begin(), piece.end(), c) != piece.end(); });
    };
    for (const UnionSample& y : sample_union(gauge, fit_.density(), itself))
      if (!outer_.sees(y.point, y.normal)) return 0;
  }
  return forward + back_cost(part.shape, corners) - back_cost(after, corners);
}

std::size_t UnionMoves::repair(SphereMesh& shape) {
  back_costs_ = fit_.back_costs(gauge_, outer_);
  std::vector<Edit> candidates = edits();
  tbb::parallel_for(std::size_t{0}, candidates.size(),
                    [&](std::size_t k) { candidates[k].gain = gain(candidates[k]); });
  std::stable_sort(candidates.begin(), candidates.end(), [](const Edit& a, const Edit& b) { return a.gain > b.gain; });
  constexpr double kWorthwhile = 1e-7;
  std::vector<bool> touched(shape_.spheres.size(), false);
  SphereMesh result = shape_;
  std::size_t count = 0;
  for (const Edit& edit : candidates) {
    if (!(edit.gain > kWorthwhile)) break;
    if (std::any_of(edit.spheres.begin(), edit.spheres.end(), [&](SphereId id) { return touched[id.index()]; }))
      continue;
    for (const SphereId id : edit.spheres) touched[id.index()] = true;
    result = applied(result, edit);
    ++count;
  }
  shape = std::move(result);
  return count;
}

double UnionMoves::inscribed_radius(std::size_t sample) const {
  // Shrinks a ball tangent at the sample until nothing is within it (Ma, Bae, Choi 2012).
  constexpr int kSteps = 12;
  constexpr double kLargest = 0.2;
  const Vector3d& p = fit_.samples().points[sample];
  const Vector3d& n = fit_.samples().normals[sample];
  double radius = kLargest;
  for (int k = 0; k < kSteps; ++k) {
    const SurfacePoint q = fit_.tree().closest(p - radius * n);
    if (q.distance > radius * (1 - 1e-3)) break;
    const Vector3d v = p - q.point;
    const double along = v.dot(n);
    if (!(along > 1e-9)) break;
    radius = v.squaredNorm() / (2 * along);
  }
  return radius;
}

std::optional<std::size_t> UnionMoves::farthest_place(const std::vector<Vector3d>& taken) const {
  constexpr std::size_t kTried = 150;
  constexpr double kApart = 1.5 * kNear;
  const auto& points = fit_.samples().points;
  std::vector<std::uint32_t> order(points.size());
  for (std::uint32_t k = 0; k < order.size(); ++k) order[k] = k;
  const std::size_t head = std::min(kTried, order.size());
  const auto key = [&](std::uint32_t k) { return std::pair(-std::abs(touches_[k].distance), k); };
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(head), order.end(),
                    [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
  double most = 0;
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < head; ++i) {
    const std::uint32_t k = order[i];
    const Vector3d& p = points[k];
    if (std::any_of(taken.begin(), taken.end(), [&](const Vector3d& t) { return (t - p).norm() < kApart; })) continue;
    const bool missing = touches_[k].distance > 0;
    double sum = 0;
    for (std::uint32_t j = 0; j < points.size(); ++j)
      if ((points[j] - p).squaredNorm() < kNear * kNear && (touches_[j].distance > 0) == missing)
        sum += fit_.forward_cost(j, touches_[j].distance);
    if (sum > most) most = sum, best = k;
  }
  return best;
}

std::vector<SphereMesh> UnionMoves::ways_to_add(const ShapePart& part, std::size_t sample, const Sphere& ball) const {
  const UnionTouch& touch = touches_[sample];
  std::vector<SphereId> corners;  // of the part, the nearest one first
  std::array<std::size_t, 3> order{0, 1, 2};
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(-touch.weights[a], a) < std::pair(-touch.weights[b], b);
  });
  const std::size_t count = touch.piece >= gauge_.edge_count() ? 3 : touch.corners[0] == touch.corners[1] ? 1 : 2;
  for (const std::size_t k : order) {
    const SphereId id = part.part_id(SphereId(touch.corners[k]));
    if (std::find(corners.begin(), corners.end(), id) == corners.end()) corners.push_back(id);
  }
  corners.resize(count);
  const Sphere between = blend(gauge_.spheres(), touch.corners, touch.weights);

  const SphereMesh& shape = part.shape;
  std::vector<SphereMesh> ways;
  ways.push_back(attached(shape, {corners[0]}, ball));
  if (count >= 2) ways.push_back(attached(shape, {corners[0], corners[1]}, ball));
  if (count == 3) {
    ways.push_back(attached(shape, corners, ball));
    const SphereTriple triangle{corners[0], corners[1], corners[2]};
    for (const Sphere& s : {ball, between}) {
      ways.push_back(triangle_split(shape, triangle, s));
      for (std::size_t k = 0; k < 3; ++k) ways.push_back(edge_split(shape, corners[k], corners[(k + 1) % 3], s));
    }
  }
  constexpr double kAtEnd = 1e-3;
  if (count == 2 && touch.weights[order[0]] < 1 - kAtEnd)
    for (const Sphere& s : {ball, between}) ways.push_back(edge_split(shape, corners[0], corners[1], s));
  if (count <= 2 && touch.weights[order[0]] >= 1 - kAtEnd) {
    // At a sphere: the neighbour in that direction.
    const Vector3d& from = shape.sphere(corners[0]).centre;
    double most = -2;
    std::optional<SphereId> ahead;
    for (const SphereId whole : stars_.neighbours(part.whole[corners[0].index()])) {
      const SphereId n = part.part_id(whole);
      const double cosine = (ball.centre - from).dot((shape.sphere(n).centre - from).normalized());
      if (cosine > most) most = cosine, ahead = n;
    }
    if (ahead) {
      ways.push_back(edge_split(shape, corners[0], *ahead, ball));
      ways.push_back(attached(shape, {corners[0], *ahead}, ball));
    }
  }
  return ways;
}

double UnionMoves::settle(SphereMesh& shape, const ShapePart& part, std::span<const std::uint32_t> samples) const {
  const auto added = static_cast<std::uint32_t>(shape.spheres.size() - 1);
  std::vector<Vector3d> points;
  std::vector<double> otherwise;  // how near pieces outside the part are
  for (const std::uint32_t k : samples) {
    points.push_back(fit_.samples().points[k]);
    const UnionTouch& touch = touches_[k];
    const bool in_part = std::all_of(touch.corners.begin(), touch.corners.end(), [&](std::uint32_t c) {
      return std::binary_search(part.whole.begin(), part.whole.end(), SphereId(c));
    });
    otherwise.push_back(in_part ? std::numeric_limits<double>::infinity() : touch.distance);
  }
  UnionGauge gauge(shape);
  std::vector<UnionTouch> touches(points.size());
  Sphere best = shape.spheres[added];
  double least = std::numeric_limits<double>::infinity();
  double damping = 0.05;
  constexpr int kSteps = 5;
  for (int step = 0; step < kSteps; ++step) {
    gauge.move_to(shape.spheres);
    touch_all(gauge, points, touches);
    double cost = 0;
    Matrix4d A = Matrix4d::Zero();
    Vector4d b = Vector4d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const UnionTouch& touch = touches[i];
      if (otherwise[i] <= touch.distance) {
        cost += fit_.forward_cost(samples[i], otherwise[i]);
        continue;
      }
      cost += fit_.forward_cost(samples[i], touch.distance);
      double weight = 0;
      for (std::size_t c = 0; c < 3; ++c)
        if (touch.corners[c] == added) weight += touch.weights[c];
      if (!(weight > 1e-6)) continue;
      const Vector3d away = points[i] - blend(shape.spheres, touch.corners, touch.weights).centre;
      const double length = away.norm();
      if (!(length > 1e-12)) continue;
      Vector4d gradient;
      gradient << weight / length * away, weight;
      const double w = fit_.forward_weight(samples[i], touch.distance);
      A += w * gradient * gradient.transpose();
      b += w * touch.distance * gradient;
    }
    if (cost < least) {
      least = cost;
      best = shape.spheres[added];
      damping *= 0.5;
    } else {
      damping *= 4;
    }
    const double trace = A.trace();
    if (!(trace > 0)) break;
    A.diagonal() *= 1 + damping;
    A.diagonal().array() += 1e-4 * trace;
    Vector4d move = A.ldlt().solve(b);
    constexpr double kLongest = 0.03;
    if (move.norm() > kLongest) move *= kLongest / move.norm();
    shape.spheres[added] = {best.centre + move.head<3>(), std::max(0.0, best.radius + move[3])};
  }
  shape.spheres[added] = best;
  gauge.move_to(shape.spheres);
  return least + fit_.back_cost(gauge, outer_, pieces_at({added}));
}

std::optional<SphereMesh> UnionMoves::with_another_sphere(std::vector<Vector3d>& taken) const {
  const std::optional<std::size_t> sample = farthest_place(taken);
  if (!sample) return std::nullopt;
  const Vector3d& p = fit_.samples().points[*sample];
  taken.push_back(p);
  const double radius = inscribed_radius(*sample);
  const Sphere ball{p - radius * fit_.samples().normals[*sample], radius};

  std::vector<SphereId> centres;
  for (const std::uint32_t c : touches_[*sample].corners) centres.emplace_back(c);
  const ShapePart part = stars_.around(centres);
  std::vector<std::uint32_t> samples;
  constexpr double kReach = 2.5 * kNear;
  for (std::uint32_t k = 0; k < touches_.size(); ++k)
    if ((fit_.samples().points[k] - p).squaredNorm() < kReach * kReach) samples.push_back(k);

  std::vector<SphereMesh> ways = ways_to_add(part, *sample, ball);
  std::vector<double> costs(ways.size());
  tbb::parallel_for(std::size_t{0}, ways.size(), [&](std::size_t k) { costs[k] = settle(ways[k], part, samples); });
  const auto best = static_cast<std::size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());

  // Back into the whole: what the part held is replaced by what it holds now.
  SphereMesh whole = shape_;
  const SphereId added(whole.spheres.size());
  whole.spheres.push_back(ways[best].spheres.back());
  const auto to_whole = [&](SphereId id) { return id.index() < part.whole.size() ? part.whole[id.index()] : added; };
  const auto replace = [&](auto& simplices, const auto& before, const auto& after) {
    for (auto simplex : before) {
      for (SphereId& id : simplex) id = to_whole(id);
      std::erase(simplices, simplex);
    }
    for (auto simplex : after) {
      for (SphereId& id : simplex) id = to_whole(id);
      simplices.push_back(simplex);
    }
  };
  replace(whole.edges, part.shape.edges, ways[best].edges);
  replace(whole.triangles, part.shape.triangles, ways[best].triangles);
  return make_sphere_mesh(std::move(whole.spheres), whole.edges, whole.triangles);
}

void UnionMoves::find_collapse(Collapse& collapse) const {
  const auto& [a, b] = std::pair(collapse.keep, collapse.drop);
  const ShapePart part = stars_.around({a, b});
  std::vector<std::uint32_t> samples;
  std::set_union(touched_by_[a.index()].begin(), touched_by_[a.index()].end(), touched_by_[b.index()].begin(),
                 touched_by_[b.index()].end(), std::back_inserter(samples));
  double before = 0;
  for (const std::uint32_t k : samples) before += cost(k, touches_[k].distance);

  const Sphere& sa = shape_.sphere(a);
  const Sphere& sb = shape_.sphere(b);
  std::vector<Sphere> tried{sa};
  if (!fixed(a)) {
    tried.push_back(sb);
    tried.push_back({0.5 * (sa.centre + sb.centre), 0.5 * (sa.radius + sb.radius)});
  }
  for (const Sphere& sphere : tried) {
    const SphereMesh after = collapsed(part.shape, part.part_id(a), part.part_id(b), sphere);
    const double cost = forward_cost(after, samples) - before;
    if (cost < collapse.cost) collapse.cost = cost, collapse.sphere = sphere;
  }
}

void UnionMoves::add_back_cost(Collapse& collapse) const {
  const ShapePart part = stars_.around({collapse.keep, collapse.drop});
  const SphereId keep = part.part_id(collapse.keep);
  const SphereId drop = part.part_id(collapse.drop);
  const SphereMesh after = collapsed(part.shape, keep, drop, collapse.sphere);
  const SphereId kept = keep.index() + 1 == part.shape.spheres.size() ? drop : keep;
  collapse.cost += back_cost(after, {index_of(kept)}) - back_cost(part.shape, {index_of(keep), index_of(drop)});
}

SphereMesh UnionMoves::with_fewer_spheres(std::size_t count) const {
  std::vector<Collapse> candidates;
  for (std::size_t e = 0; e < gauge_.edge_count(); ++e) {
    const auto [ia, ib] = gauge_.edge_corners(e);
    SphereId a(ia);
    SphereId b(ib);
    if (fixed(b)) std::swap(a, b);
    if (a != b && !fixed(b)) candidates.push_back({a, b, {}});
  }
  const auto cheaper = [](const Collapse& a, const Collapse& b) { return a.cost < b.cost; };
  tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t k) { find_collapse(candidates[k]); });
  std::stable_sort(candidates.begin(), candidates.end(), cheaper);
  // Only what costs little seen from the input is worth a look from the other side.
  constexpr std::size_t kLooks = 6;
  candidates.resize(std::min(candidates.size(), kLooks * (count + 2)));
  tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t k) { add_back_cost(candidates[k]); });
  std::stable_sort(candidates.begin(), candidates.end(), cheaper);

  std::vector<bool> touched(shape_.spheres.size(), false);
  std::vector<Collapse> chosen;
  for (const Collapse& c : candidates) {
    if (chosen.size() == count) break;
    std::vector<SphereId> ring{c.keep, c.drop};
    for (const SphereId id : {c.keep, c.drop})
      ring.insert(ring.end(), stars_.neighbours(id).begin(), stars_.neighbours(id).end());
    if (touched[c.keep.index()] || touched[c.drop.index()]) continue;
    for (const SphereId id : ring) touched[id.index()] = true;
    chosen.push_back(c);
  }
  std::vector<SphereId> now(shape_.spheres.size());
  for (std::size_t k = 0; k < now.size(); ++k) now[k] = SphereId(k);
  SphereMesh result = shape_;
  for (const Collapse& c : chosen) {
    const SphereId keep = now[c.keep.index()];
    const SphereId drop = now[c.drop.index()];
    const SphereId last(result.spheres.size() - 1);
    result = collapsed(result, keep, drop, c.sphere);
    std::replace(now.begin(), now.end(), last, drop);
  }
  return result;
}

}  // namespace armature::sdk
