#include "sdk/expansion/patch_registration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Dense>
#include <armature/sdk/mesh/measures.h>

#include "sdk/expansion/sample_grid.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr double kSamples = 600;  // of a patch's surroundings, about, and one a face at least
constexpr std::size_t kMostSamples = 1500;
constexpr std::size_t kFew = 120;   // that decide between angles
constexpr std::size_t kSome = 150;  // that decide between ways that differ
constexpr std::size_t kMany = 300;  // that decide where exactly
constexpr std::size_t kAll = kMostSamples;
constexpr std::size_t kStarts = 8;           // that are tried, of each handedness
constexpr std::array kAstray = {0.25, 0.5};  // how far from its place a centre is looked for, of the radius
constexpr double kGathered = 1.25;  // of the radius; the farther centres see their far side cut off, and find as many
constexpr int kAround = 6;          // in so many directions
constexpr int kFewRounds = 4;
constexpr int kManyRounds = 8;
constexpr double kDoubtful = 0.02;       // how far what is nearest may lie before another fold is tried, of the radius
constexpr double kNear = 0.4;            // what a sample may lie on, of the radius
constexpr double kHopeless = 0.01;       // a misfit that no closer look will mend
constexpr double kProgress = 0.98;       // half of the samples are hardly nearer than before: it has settled
constexpr double kStill = 5e-4;          // a step that ends the search, of the radius
constexpr double kScaleRange = 1.3;      // how far the scale may leave what was looked for
constexpr double kWorthMirroring = 0.9;  // a mirror image must leave so much less than the thing itself
constexpr double kRoughlyUndecided = 0.2;  // of two misfits, the smaller over the larger: beyond, a closer look tells
constexpr double kUndecided = 0.4;         // the same after that look
constexpr double kAnotherTurn = std::numbers::pi / 6;  // ways that differ by less are one
constexpr double kLikely = 5e-4;                       // a misfit of the same shape in noise
constexpr double kAlike = 2e-6;                        // misfits that differ by less tell nothing
constexpr std::size_t kCellRings = 5;                  // of the cells that noise is averaged over
constexpr double kApart = 0.05;                        // surfaces that do not lie on one another, of the radius
constexpr double kReach = 0.2;                         // surfaces that are not there, of the radius

/// A place where the reference's centre may lie, and how the surface rises around it.
struct Centre {
  Vector3d point;
  PolarRelief relief;
};

/// A centre, and a shift by sectors against the reference.
struct Start {
  const Centre* at;
  std::size_t shift;
  float difference;
};

/// The starts at which reliefs agree best: local minima over the angle, best first.
std::vector<Start> best_starts(const PolarRelief& reference, const std::vector<Centre>& centres, bool mirrored) {
  constexpr std::size_t n = PolarRelief::kSectors;
  std::vector<Start> minima;
  for (const Centre& centre : centres) {
    const auto apart = differences(reference, centre.relief, mirrored);
    for (std::size_t k = 0; k < n; ++k)
      if (apart[k] <= apart[(k + 1) % n] && apart[k] <= apart[(k + n - 1) % n])
        minima.push_back({&centre, k, apart[k]});
  }
  std::ranges::stable_sort(minima, {}, &Start::difference);
  minima.resize(std::min(minima.size(), kStarts));
  return minima;
}

/// Where the centre may lie: noise leads the maxima of contexts astray.
std::vector<Centre> centres_about(const PatchSurroundings& there, double radius) {
  std::vector<Centre> centres = {{there.centre, there.relief}};
  for (const double astray : kAstray)
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      const Vector3d aside(std::cos(angle), std::sin(angle), 0);
      const Vector3d point = there.centre + astray * radius * (there.relief.frame * aside);
      centres.push_back({point, relief_of(there.samples, point, radius)});
    }
  return centres;
}

/// Where a point of the reference comes to lie.
struct OnTarget {
  Vector3d point, normal;
};

/// The cell of every sample, around the mean normal: kCellRings of equal width, the k-th of 2 k + 1 thirds.
std::vector<std::size_t> cells_of(const PatchSurroundings& around, double radius) {
  std::vector<std::size_t> cells;
  for (const SurfaceSample& s : around.samples) {
    const Vector3d x = around.relief.frame.transpose() * (s.point - around.centre) / radius;
    const auto ring = std::min<std::size_t>(kCellRings - 1, static_cast<std::size_t>(kCellRings * x.head<2>().norm()));
    const std::size_t sectors = 3 * (2 * ring + 1);
    const double turn = std::atan2(x.y(), x.x()) / (2 * std::numbers::pi) + 0.5;
    const auto sector = std::min(sectors - 1, static_cast<std::size_t>(turn * static_cast<double>(sectors)));
    cells.push_back(3 * ring * ring + sector);
  }
  return cells;
}

/// The angle of the turn from one registration to another of the same handedness.
double angle_between(const PatchFit& a, const PatchFit& b) {
  const Matrix3d A = a.target_from_reference.topLeftCorner<3, 3>() / a.scale;
  const Matrix3d B = b.target_from_reference.topLeftCorner<3, 3>() / b.scale;
  return std::acos(std::clamp(((A.transpose() * B).trace() - 1) / 2, -1.0, 1.0));
}

double area_of(const Surface& surface, std::span<const FaceId> patch) {
  double area = 0;
  for (const FaceId face : patch) area += area_vector(surface.mesh, face).norm();
  return area;
}

}  // namespace

std::vector<SurfaceSample> samples_about(const FaceGraph& graph, VertexId at, double radius, double reach) {
  const Surface& surface = graph.surface();
  const Vector3d& centre = surface.mesh.position(at);
  std::vector<FaceId> faces =
      graph.flood(surface.adjacency.faces(at), [&](FaceId face) { return graph.touches(face, centre, reach); });
  // Faces come ring by ring, so that every n-th of them, or of their samples, are spread evenly.
  const auto thin_out = [](auto& things) {
    const std::size_t every = things.size() / kMostSamples;
    if (every < 2) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < things.size(); i += every) things[kept++] = things[i];
    things.erase(things.begin() + static_cast<std::ptrdiff_t>(kept), things.end());
  };
  thin_out(faces);
  auto samples = samples_of(surface.mesh, faces, std::numbers::pi * radius * radius / kSamples);
  std::erase_if(samples, [&](const SurfaceSample& s) { return (s.point - centre).squaredNorm() > reach * reach; });
  thin_out(samples);
  return samples;
}

PatchSurroundings::PatchSurroundings(const FaceGraph& graph, VertexId at, double radius, double reach)
    : centre(graph.surface().mesh.position(at)),
      samples(samples_about(graph, at, radius, reach)),
      relief(relief_of(samples, centre, radius)) {}

SurfacePoint closest_near(const FaceGraph& graph, const SampleGrid& grid, FaceId last, const Vector3d& point,
                          double radius) {
  SurfacePoint nearest;
  if (last.valid()) nearest = graph.closest_from(last, point);
  if (nearest.distance > kDoubtful * radius)
    if (const SurfaceSample* near = grid.near(point))
      if (const SurfacePoint other = graph.closest_from(near->face, point); other.distance < nearest.distance)
        nearest = other;
  return nearest;
}

PatchReference::PatchReference(const FaceGraph& graph, std::span<const FaceId> patch, const PatchBall& ball)
    : graph_(&graph),
      surface_(&graph.surface()),
      ball_(ball),
      area_(area_of(*surface_, patch)),
      around_(graph, ball.centre, ball.radius, ball.radius),
      grid_(samples_about(graph, ball.centre, ball.radius, (1 + kReach) * ball.radius), around_.centre,
            (1 + kReach) * ball.radius),
      shares_(*surface_, patch),
      to_border_(surface_->mesh.positions.size(), -1),
      cells_(cells_of(around_, ball.radius)),
      border_(border_of(*surface_, patch)) {
  measure_border(graph);
}

RoughlyLaid PatchReference::lay_roughly(const FaceGraph& graph, VertexId at, double scale, bool mirrored_too) const {
  const double radius = scale * ball_.radius;
  const PatchSurroundings there(graph, at, radius, kGathered * radius);
  const std::vector<Centre> centres = centres_about(there, radius);
  SampleGrid grid(there.samples, there.centre, kGathered * radius);
  const auto near_there = [&](std::size_t, const Vector3d& from) -> std::optional<OnTarget> {
    const SurfaceSample* near = grid.near(from);
    if (near == nullptr) return std::nullopt;
    return OnTarget{near->point, near->normal};
  };
  RoughlyLaid laid{scale, {}, {}};
  for (const bool mirrored : {false, true}) {
    if (mirrored && !mirrored_too) break;
    std::vector<PatchFit> ways;
    for (const Start& start : best_starts(around_.relief, centres, mirrored)) {
      PatchFit tried{.scale = scale, .mirrored = mirrored};
      const Matrix3d A = scale * turn_by(around_.relief, start.at->relief, start.shift, mirrored);
      tried.target_from_reference.topLeftCorner<3, 3>() = A;
      tried.target_from_reference.topRightCorner<3, 1>() = start.at->point - A * around_.centre;
      improve(tried, scale, kFew, kFewRounds, near_there);
      ways.push_back(tried);
    }
    std::ranges::stable_sort(ways, {}, &PatchFit::misfit);
    const auto other = std::ranges::find_if(
        ways, [&](const PatchFit& way) { return angle_between(ways.front(), way) > kAnotherTurn; });
    laid.ways.push_back(ways.front());
    if (other != ways.end()) laid.ways.push_back(*other);
  }
  std::ranges::stable_sort(laid.ways, {}, &PatchFit::misfit);
  laid.grid = std::move(grid);
  return laid;
}

PatchFit PatchReference::lay_closely(const FaceGraph& graph, const RoughlyLaid& roughly) const {
  const Surface& target = graph.surface();
  const double radius = roughly.scale * ball_.radius;
  // From what was found for a sample in the round before.
  const auto nearest = [&] {
    return [&, last = std::vector<FaceId>(around_.samples.size())](
               std::size_t i, const Vector3d& from) mutable -> std::optional<OnTarget> {
      const SurfacePoint to = closest_near(graph, roughly.grid, last[i], from, radius);
      if (!to.face.valid()) return std::nullopt;
      last[i] = to.face;
      if (to.distance > kNear * radius) return std::nullopt;
      Vector3d normal = Vector3d::Zero();
      for (std::size_t k = 0; k < 3; ++k)
        normal += to.barycentric[static_cast<Eigen::Index>(k)] *
                  target.vertex_normals[target.mesh.triangle(to.face)[k].index()];
      return OnTarget{to.point, normal.norm() > 0 ? normal.normalized() : normal};
    };
  };
  std::vector<PatchFit> ways = roughly.ways;
  const auto look_closer = [&](std::size_t samples, double least) {
    const double best = std::ranges::min(ways, {}, &PatchFit::misfit).misfit;
    std::erase_if(ways, [&](const PatchFit& way) { return best < least * way.misfit; });
    if (ways.size() == 1) return;
    for (PatchFit& way : ways) improve(way, roughly.scale, samples, kFewRounds, nearest());
  };
  if (roughly.misfit() < kHopeless) look_closer(kSome, kRoughlyUndecided);
  // Where noise might decide, all samples do.
  if (std::ranges::min(ways, {}, &PatchFit::misfit).misfit < kLikely) look_closer(kAll, kUndecided);
  PatchFit best = std::ranges::min(ways, {}, [](const PatchFit& way) {
    return way.mirrored ? (way.misfit + kAlike) / kWorthMirroring : way.misfit;
  });
  improve(best, roughly.scale, kMany, best.misfit < kHopeless ? kManyRounds : 0, nearest());
  return best;
}

template <class Find>
void PatchReference::improve(PatchFit& registration, double scale, std::size_t samples, int rounds, Find&& find) const {
  struct Pair {
    Vector3d from, to, normal;
    double distance, facing;
    std::size_t cell;
  };
  const double radius = scale * ball_.radius;
  const std::size_t stride = std::max<std::size_t>(1, around_.samples.size() / samples);
  const double asked = static_cast<double>((around_.samples.size() + stride - 1) / stride);
  std::vector<Pair> pairs;
  std::vector<double> distances;
  double before = std::numeric_limits<double>::infinity();
  const auto find_pairs = [&] {
    pairs.clear();
    const Matrix4d& T = registration.target_from_reference;
    const Matrix3d turn = T.topLeftCorner<3, 3>() / registration.scale;
    for (std::size_t i = 0; i < around_.samples.size(); i += stride) {
      const SurfaceSample& sample = around_.samples[i];
      const Vector3d from = apply(T, sample.point);
      if (const auto to = find(i, from))
        pairs.push_back({from, to->point, to->normal, (to->point - from).norm(), (turn * sample.normal).dot(to->normal),
                         cells_[i]});
    }
  };
  bool moved = true;  // since the pairs were found
  for (int round = 0; round < rounds; ++round) {
    find_pairs();
    moved = false;
    if (pairs.size() < 6) break;
    distances.clear();
    for (const Pair& pair : pairs) distances.push_back(pair.distance);
    const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, half);
    if (registration.misfit > kLikely && *half > kProgress * before) break;
    before = *half;
    const double usual = std::max(0.01 * radius, 1.5 * *half);

    // from + w x (from - o) + t + l (from - o) in the plane at `to`: n.(...) = 0, in units of the radius about o; the
    // last column is the right side.
    const Vector3d o = apply(registration.target_from_reference, around_.centre);
    Eigen::Matrix<double, 8, 8> sums = Eigen::Matrix<double, 8, 8>::Zero();
    for (const Pair& pair : pairs) {
      const double weight = std::max(0.0, pair.facing) / std::pow(1 + std::pow(pair.distance / usual, 2), 2);
      const Vector3d x = (pair.from - o) / radius;
      Eigen::Matrix<double, 8, 1> row;
      row << x.cross(pair.normal), pair.normal, pair.normal.dot(x), pair.normal.dot(pair.to - pair.from) / radius;
      sums.noalias() += (weight * row) * row.transpose();
    }
    Eigen::Matrix<double, 7, 7> H = sums.topLeftCorner<7, 7>();
    const Eigen::Matrix<double, 7, 1> g = sums.topRightCorner<7, 1>();
    H.diagonal().array() += 1e-4 * H.trace() / 7 + 1e-12;  // what the surface does not tell stays
    Eigen::Matrix<double, 7, 1> step = H.ldlt().solve(g);
    if (!step.allFinite()) break;
    const double most = step.head<3>().norm();
    if (most > 0.5) step *= 0.5 / most;
    const double wanted = registration.scale * std::exp(step[6]);
    const double allowed = std::clamp(wanted, scale / kScaleRange, scale * kScaleRange);
    const double grow = allowed / registration.scale;
    registration.scale = allowed;
    const double turn = step.head<3>().norm();
    const Matrix3d R =
        turn > 0 ? Eigen::AngleAxisd(turn, step.head<3>() / turn).toRotationMatrix() : Matrix3d(Matrix3d::Identity());
    Matrix4d move = Matrix4d::Identity();
    move.topLeftCorner<3, 3>() = grow * R;
    move.topRightCorner<3, 1>() = o + radius * step.segment<3>(3) - grow * R * o;
    registration.target_from_reference = move * registration.target_from_reference;
    moved = true;
    if (step.norm() < kStill) break;
  }
  if (moved) find_pairs();
  // A twentieth of the radius apart is as bad as nothing there.
  double sum = 0;
  std::array<double, 3 * kCellRings * kCellRings> apart{};
  std::array<double, 3 * kCellRings * kCellRings> count{};
  for (const Pair& pair : pairs) {
    sum += std::max(0.0, pair.facing) * std::exp(-std::pow(pair.distance / (kApart * radius), 2));
    apart[pair.cell] += std::clamp(pair.normal.dot(pair.to - pair.from) / radius, -kReach, kReach);
    ++count[pair.cell];
  }
  registration.fit = asked > 0 ? sum / asked : 0;
  // Where nothing lies near, the surfaces are apart by the reach.
  double squares = kReach * kReach * (asked - static_cast<double>(pairs.size()));
  for (std::size_t cell = 0; cell < count.size(); ++cell)
    if (count[cell] > 0) squares += apart[cell] * apart[cell] / count[cell];
  registration.misfit = asked > 0 ? squares / asked : 0;
}

}  // namespace armature::sdk
