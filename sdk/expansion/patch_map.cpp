#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include <armature/sdk/expansion/patch_map.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "sdk/expansion/enclosing_ball.h"
#include "sdk/expansion/point_tree.h"
#include "sdk/expansion/spread_context.h"

namespace armature::sdk {
namespace {

constexpr std::size_t kBlock = 256;  // points that are put into bins side by side
constexpr std::size_t kLanes = 8;    // copies of the bins, so that one sum does not wait for the last
constexpr std::size_t kRows = PatchContexts::kDistances + 1;  // and what lies outside
constexpr std::size_t kBins = kRows * PatchContexts::kAngles;
constexpr float kSmooth = 0.1F;     // normals are means over so much of the radius
constexpr float kMerge = 1 / 12.F;  // points so near are taken together, of the radius

/// Where bins end: squared distances rising, cosines falling.
struct Edges {
  std::array<float, PatchContexts::kDistances> distance2;
  std::array<float, PatchContexts::kAngles - 1> cosine;
};
const Edges kEdges = {{0.01F, 0.04F, 0.09F, 0.16F, 0.25F, 0.36F, 0.49F, 0.64F, 0.81F, 1.0F},
                      {0.951056516F, 0.809016994F, 0.587785252F, 0.309016994F, 0.0F, -0.309016994F, -0.587785252F,
                       -0.809016994F, -0.951056516F}};

using Bins = std::array<std::array<float, kBins>, kLanes>;

/// Adds the area of every point to the bin of its distance and its normal's angle. Same operations in the same order
/// whatever the registers are.
[[gnu::always_inline]] inline void add_areas(const PointColumns& points, const OrientedPoint& from, Bins& bins) {
  const Eigen::Vector3f p = from.position;
  const Eigen::Vector3f n = from.normal;
  std::array<std::int32_t, kBlock> bin;
  for (std::size_t begin = 0; begin < points.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - begin);
    const float* const x = points.x.data() + begin;
    const float* const y = points.y.data() + begin;
    const float* const z = points.z.data() + begin;
    const float* const nx = points.nx.data() + begin;
    const float* const ny = points.ny.data() + begin;
    const float* const nz = points.nz.data() + begin;
    const float* const area = points.area.data() + begin;
    for (std::size_t i = 0; i < count; ++i) {
      const float dx = x[i] - p.x();
      const float dy = y[i] - p.y();
      const float dz = z[i] - p.z();
      const float d2 = dx * dx + dy * dy + dz * dz;
      const float cosine = nx[i] * n.x() + ny[i] * n.y() + nz[i] * n.z();
      std::int32_t row = 0;
      for (const float edge : kEdges.distance2) row += d2 >= edge ? 1 : 0;
      std::int32_t column = 0;
      for (const float edge : kEdges.cosine) column += cosine < edge ? 1 : 0;
      bin[i] = row * static_cast<std::int32_t>(PatchContexts::kAngles) + column;
    }
    for (std::size_t i = 0; i < count; i += kLanes)  // padded: whole lanes
      for (std::size_t lane = 0; lane < kLanes; ++lane)
        bins[lane][static_cast<std::size_t>(bin[i + lane])] += area[i + lane];
  }
}

/// The mean normal, by area, of the points within a tenth of the radius that face the same way as one.
Eigen::Vector3f smoothed(const PointColumns& points, const OrientedPoint& from) {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const OrientedPoint near = points.at(i);
    if ((near.position - from.position).squaredNorm() < kSmooth * kSmooth && near.normal.dot(from.normal) > 0)
      sum += near.area * near.normal;
  }
  return sum.squaredNorm() > 0 ? sum.normalized() : from.normal;
}

void add_areas_plain(const PointColumns& points, const OrientedPoint& from, Bins& bins) {
  add_areas(points, from, bins);
}
#if defined(__x86_64__)
[[gnu::target("avx2")]] void add_areas_avx2(const PointColumns& points, const OrientedPoint& from, Bins& bins) {
  add_areas(points, from, bins);
}
bool has_avx2() {
  return __builtin_cpu_supports("avx2") != 0;
}
#else
constexpr auto add_areas_avx2 = add_areas_plain;
bool has_avx2() {
  return false;
}
#endif

/// The vertices of a surface in units of `radius` about the middle of all.
std::vector<OrientedPoint> scaled_points(const Surface& surface, double radius) {
  Eigen::AlignedBox3d all;
  for (const Eigen::Vector3d& p : surface.mesh.positions) all.extend(p);
  std::vector<OrientedPoint> points(surface.mesh.positions.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {((surface.mesh.positions[i] - all.center()) / radius).cast<float>(),
                 surface.vertex_normals[i].cast<float>(),
                 static_cast<float>(surface.vertex_areas[i] / (radius * radius))};
  return points;
}

}  // namespace

Expected<PatchBall> patch_ball(const Surface& surface, std::span<const FaceId> patch) {
  const Mesh& mesh = surface.mesh;
  std::vector<VertexId> vertices;
  for (const FaceId face : patch) {
    if (face.index() >= mesh.triangles.size())
      return fail("face " + std::to_string(face.index()) + " is not there: the mesh has " +
                  std::to_string(mesh.triangles.size()) + " faces");
    vertices.insert(vertices.end(), mesh.triangle(face).begin(), mesh.triangle(face).end());
  }
  std::vector<Eigen::Vector3d> points;
  for (const VertexId vertex : vertices) points.push_back(mesh.position(vertex));
  const EnclosingBall ball = smallest_enclosing_ball(points);
  if (!(ball.radius > 0)) return fail("the patch has no extent; select more of the surface");
  // Where the patch faces most: the side of a bump is nearer to the ball's centre than its top, but many sides are.
  Eigen::Vector3d facing = Eigen::Vector3d::Zero();
  for (const FaceId face : patch) facing += area_vector(mesh, face);
  if (facing.norm() > 0) facing.normalize();
  const auto centre = std::ranges::min_element(vertices, {}, [&](VertexId v) {
    const Eigen::Vector3d x = mesh.position(v) - ball.centre;
    const double aside = (x - x.dot(facing) * facing).norm();
    return std::pair(aside - 0.1 * x.dot(facing), v);
  });
  double radius = 0;
  for (const Eigen::Vector3d& point : points) radius = std::max(radius, (point - mesh.position(*centre)).norm());
  return PatchBall{*centre, radius};
}

struct PatchContexts::State {
  PointTree vertices;
  PointTree surface;                    // what is around them, points taken together
  std::vector<std::uint32_t> place_of;  // in `vertices`, by vertex

  explicit State(const std::vector<OrientedPoint>& points)
      : vertices(points), surface(merged(points, kMerge)), place_of(points.size()) {
    for (std::size_t at = 0; at < points.size(); ++at) place_of[vertices.order()[at]] = static_cast<std::uint32_t>(at);
  }

  /// Calls `visit(place, nearby)` for every point of a tree, `nearby` being what of the surface lies within `radius` of
  /// it and more.
  template <class Visit>
  bool for_each_point(const PointTree& tree, float radius, const Task& task, Visit&& visit) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, tree.groups(), 8), [&](const auto& range) {
      PointColumns nearby;
      for (std::size_t group = range.begin(); group != range.end() && !task.stopped(); ++group) {
        nearby.clear();
        surface.gather(tree.box_of(group), radius, nearby);
        nearby.pad(kLanes);
        for (std::size_t at = group * PointTree::kGroup; at < tree.end_of(group); ++at) visit(at, nearby);
      }
    });
    return !task.stopped();
  }

  [[nodiscard]] bool smooth_normals(const Task& task) {
    std::array<std::pair<PointTree*, std::vector<Eigen::Vector3f>>, 2> normals = {{{&vertices, {}}, {&surface, {}}}};
    for (auto& [tree, smooth] : normals) {
      smooth.resize(tree->points().size());
      const auto keep = [&, points = &tree->points(), out = &smooth](std::size_t at, const PointColumns& nearby) {
        (*out)[at] = smoothed(nearby, points->at(at));
      };
      if (!for_each_point(*tree, kSmooth, task, keep)) return false;
    }
    for (const auto& [tree, smooth] : normals)
      for (std::size_t at = 0; at < smooth.size(); ++at) tree->set_normal(at, smooth[at]);
    return true;
  }

  /// The context of a vertex by its place, of points that are near it.
  [[nodiscard]] PatchContext context(std::size_t at, const PointColumns& nearby) const {
    static const bool wide = has_avx2();
    Bins bins{};
    (wide ? add_areas_avx2 : add_areas_plain)(nearby, vertices.points().at(at), bins);
    PatchContext sums{};
    for (std::size_t bin = 0; bin < sums.size(); ++bin)
      for (const auto& lane : bins) sums[bin] += lane[bin];
    normalise(sums);
    return sums;
  }
};

PatchContexts::PatchContexts(std::unique_ptr<const State> state) : state_(std::move(state)) {}
PatchContexts::~PatchContexts() = default;
PatchContexts::PatchContexts(PatchContexts&&) noexcept = default;
PatchContexts& PatchContexts::operator=(PatchContexts&&) noexcept = default;

Expected<PatchContexts> PatchContexts::build(const Surface& surface, double radius, const Task& task) {
  if (!(radius > 0) || !std::isfinite(radius)) return fail("expected a positive radius of contexts");
  auto state = std::make_unique<State>(scaled_points(surface, radius));
  if (!state->smooth_normals(task)) return cancelled();
  return PatchContexts(std::move(state));
}

Histogram PatchContexts::of(VertexId vertex) const {
  const std::size_t at = state_->place_of[vertex.index()];
  PointColumns nearby;
  state_->surface.gather(state_->vertices.box_of(at / PointTree::kGroup), 1, nearby);
  nearby.pad(kLanes);
  const auto context = state_->context(at, nearby);
  return {context.begin(), context.end()};
}

Expected<std::vector<float>> PatchContexts::of_all(const Task& task) const {
  constexpr std::size_t kShares = std::tuple_size_v<PatchContext>;
  std::vector<float> contexts(state_->place_of.size() * kShares);
  const auto& order = state_->vertices.order();
  task.report("describing patches", 0);
  const bool done = state_->for_each_point(state_->vertices, 1, task, [&](std::size_t at, const PointColumns& nearby) {
    std::ranges::copy(state_->context(at, nearby), contexts.begin() + static_cast<std::ptrdiff_t>(order[at] * kShares));
  });
  if (!done) return cancelled();
  return contexts;
}

Expected<std::vector<float>> PatchContexts::similarity_to(std::span<const float> context, const Task& task) const {
  constexpr std::size_t kShares = std::tuple_size_v<PatchContext>;
  if (context.size() != kShares)
    return fail("expected a context of " + std::to_string(kShares) + " bins, found " + std::to_string(context.size()));
  std::vector<float> similarity(state_->place_of.size());
  const auto& order = state_->vertices.order();
  const auto& points = state_->vertices.points();
  const PatchContext wanted = spread(context);
  const bool done = state_->for_each_point(state_->vertices, 1, task, [&](std::size_t at, const PointColumns& nearby) {
    const bool on_a_face = points.area[at] > 0;
    similarity[order[at]] =
        on_a_face ? static_cast<float>(1 - chi_square(spread(state_->context(at, nearby)), wanted)) : 0;
  });
  if (!done) return cancelled();
  return similarity;
}

}  // namespace armature::sdk
