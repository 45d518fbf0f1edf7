#include "sdk/expansion/patch_registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
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
// Where little is in place yet, surfaces lie on one another best where one of them is small: turns first, then sizes.
constexpr Effort kRoughly = {120, 8, false, 0.1};  // which decides between starts
constexpr Effort kCloser = {150, 4};               // between ways that differ
constexpr Effort kDeciding = {400, 4};             // the same where noise might decide
constexpr Effort kExactly = {300, 8};              // where exactly
constexpr std::size_t kStarts = 8;                 // that are tried, of each handedness, by reliefs
constexpr std::array kAstray = {0.25, 0.5};        // how far from its place a centre is looked for, of the radius
constexpr double kGathered = 1.25;   // of the radius; the farther centres see their far side cut off, and find as many
constexpr int kAround = 6;           // in so many directions
constexpr double kDoubtful = 0.02;   // how far what is nearest may lie before another fold is tried, of the radius
constexpr double kNear = 0.4;        // what a sample may lie on, of the radius
constexpr double kProgress = 0.98;   // half of the samples are hardly nearer than before: it has settled
constexpr double kStill = 5e-4;      // a step that ends the search, of the radius
constexpr double kScaleRange = 1.3;  // how far the scale may leave what was looked for
constexpr double kRoughlyUndecided = 0.7;  // of two fits, the smaller over the larger: above, a closer look tells
constexpr double kUndecided = 0.9;         // the same after that look
constexpr double kLikely = 0.5;            // a fit of the same shape in noise
constexpr double kWorthMirroring = 0.005;  // a mirror image must fit so much better than the thing itself
constexpr double kAsWell = 0.01;           // fits that differ by less tell nothing
constexpr double kImage = 0.5;             // a fit of the reference onto itself that may be mistaken in noise
constexpr std::size_t kMostImages = 3;
constexpr double kAnotherTurn = std::numbers::pi / 6;  // ways that differ by less are one
constexpr double kReach = 0.2;                         // surfaces that are not there, of the radius

/// A place where the reference's centre may lie, and how the surface rises around it.
struct Centre {
  Vector3d point;
  PolarRelief relief;
};

/// The way that takes one point to another.
PatchFit way_of(const Matrix3d& A, const Vector3d& from, const Vector3d& to, double scale, bool mirrored) {
  PatchFit way{.scale = scale, .mirrored = mirrored};
  way.target_from_reference.topLeftCorner<3, 3>() = A;
  way.target_from_reference.topRightCorner<3, 1>() = to - A * from;
  return way;
}

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

PatchMoments moments_of(std::span<const SurfaceSample> samples, const Vector3d& centre, double radius) {
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  double area = 0;
  for (const SurfaceSample& s : samples) {
    const Vector3d x = s.point - centre;
    if (x.squaredNorm() > radius * radius) continue;
    first += s.area * x;
    second += s.area * x * x.transpose();
    area += s.area;
  }
  if (!(area > 0)) return {centre, Matrix3d::Identity()};
  first /= area;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(second / area - first * first.transpose());
  return {centre + first, solver.eigenvectors()};
}

/// The ways that lay one's moments onto another's, as they are or mirrored: axes know no sign.
std::vector<PatchFit> by_moments(const PatchMoments& reference, const PatchMoments& target, double scale,
                                 bool mirrored) {
  std::vector<PatchFit> ways;
  for (int signs = 0; signs < 8; ++signs) {
    const Vector3d turned((signs & 1) != 0 ? -1 : 1, (signs & 2) != 0 ? -1 : 1, (signs & 4) != 0 ? -1 : 1);
    const Matrix3d R = target.axes * turned.asDiagonal() * reference.axes.transpose();
    if ((R.determinant() < 0) == mirrored)
      ways.push_back(way_of(scale * R, reference.middle, target.middle, scale, mirrored));
  }
  return ways;
}

/// Whether two ways are not of the same handedness and nearly the same turn.
bool differ(const PatchFit& a, const PatchFit& b) {
  if (a.mirrored != b.mirrored) return true;
  const Matrix3d A = a.target_from_reference.topLeftCorner<3, 3>() / a.scale;
  const Matrix3d B = b.target_from_reference.topLeftCorner<3, 3>() / b.scale;
  return std::acos(std::clamp(((A.transpose() * B).trace() - 1) / 2, -1.0, 1.0)) > kAnotherTurn;
}

/// What a way is worth: a little less for a mirror image, so that what is its own mirror image is not one.
double worth(const PatchFit& way) {
  return way.mirrored ? way.fit - kWorthMirroring : way.fit;
}

/// What finds the targets near samples on a grid.
auto on_grid(const SampleGrid& grid) {
  return [&grid](std::size_t, const Vector3d& from) -> std::optional<OnTarget> {
    const SurfaceSample* near = grid.near(from);
    if (near == nullptr) return std::nullopt;
    return OnTarget{near->point, near->normal};
  };
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
  for (SurfaceSample& sample : samples) {
    Vector3d normal = Vector3d::Zero();
    for (const VertexId corner : surface.mesh.triangle(sample.face)) normal += surface.vertex_normals[corner.index()];
    if (normal.norm() > 0) sample.normal = normal.normalized();
  }
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
      moments_(moments_of(around_.samples, around_.centre, ball.radius)),
      grid_(samples_about(graph, ball.centre, ball.radius, (1 + kReach) * ball.radius), around_.centre,
            (1 + kReach) * ball.radius),
      shares_(*surface_, patch),
      to_border_(surface_->mesh.positions.size(), -1),
      border_(border_of(*surface_, patch)) {
  measure_border(graph);
  find_images();
}

auto PatchReference::on_surface(const FaceGraph& graph, const SampleGrid& grid, double scale) const {
  // From what was found for a sample in the round before.
  return [&graph, &grid, radius = scale * ball_.radius, last = std::vector<FaceId>(around_.samples.size())](
             std::size_t i, const Vector3d& from) mutable -> std::optional<OnTarget> {
    const SurfacePoint to = closest_near(graph, grid, last[i], from, radius);
    if (!to.face.valid()) return std::nullopt;
    last[i] = to.face;
    if (to.distance > kNear * radius) return std::nullopt;
    Vector3d normal = Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k)
      normal += to.barycentric[static_cast<Eigen::Index>(k)] *
                graph.surface().vertex_normals[graph.surface().mesh.triangle(to.face)[k].index()];
    return OnTarget{to.point, normal.norm() > 0 ? normal.normalized() : normal};
  };
}

void PatchReference::find_images() {
  const PatchFit itself;
  // Best first, none twice, nor one that has come to lie as the reference does.
  const auto keep_apart = [&] {
    std::ranges::stable_sort(images_, std::greater{}, &PatchFit::fit);
    std::vector<PatchFit> apart;
    for (const PatchFit& image : images_)
      if (differ(image, itself) &&
          std::ranges::all_of(apart, [&](const PatchFit& better) { return differ(image, better); }))
        apart.push_back(image);
    images_ = std::move(apart);
  };
  for (const bool mirrored : {false, true})
    std::ranges::move(by_moments(moments_, moments_, 1, mirrored), std::back_inserter(images_));
  keep_apart();
  for (PatchFit& image : images_) improve(image, 1, kRoughly, on_grid(grid_));
  keep_apart();
  images_.resize(std::min(images_.size(), kMostImages));
  for (PatchFit& image : images_) improve(image, 1, kCloser, on_surface(*graph_, grid_, 1));
  keep_apart();
  std::erase_if(images_, [](const PatchFit& image) { return image.fit < kImage; });
}

PatchFit PatchReference::lay(const FaceGraph& graph, VertexId at, double scale, bool mirrored_too) const {
  const double radius = scale * ball_.radius;
  const PatchSurroundings there(graph, at, radius, kGathered * radius);
  const std::vector<Centre> centres = centres_about(there, radius);
  SampleGrid grid(there.samples, there.centre, kGathered * radius);
  const PatchMoments moments = moments_of(there.samples, there.centre, radius);
  std::vector<PatchFit> best;  // of either handedness, two that differ by their turn
  for (const bool mirrored : {false, true}) {
    if (mirrored && !mirrored_too) break;
    std::vector<PatchFit> ways = by_moments(moments_, moments, scale, mirrored);
    for (const Start& start : best_starts(around_.relief, centres, mirrored)) {
      const Matrix3d turn = turn_by(around_.relief, start.at->relief, start.shift, mirrored);
      ways.push_back(way_of(scale * turn, around_.centre, start.at->point, scale, mirrored));
    }
    for (PatchFit& way : ways) improve(way, scale, kRoughly, on_grid(grid));
    std::ranges::stable_sort(ways, std::greater{}, &PatchFit::fit);
    const auto other = std::ranges::find_if(ways, [&](const PatchFit& way) { return differ(way, ways.front()); });
    best.push_back(ways.front());
    if (other != ways.end()) best.push_back(*other);
  }
  const PatchFit first = std::ranges::max(best, {}, &PatchFit::fit);
  for (const PatchFit& image : images_) {
    PatchFit way = first;
    way.target_from_reference = way.target_from_reference * image.target_from_reference;
    way.scale *= image.scale;
    way.mirrored = way.mirrored != image.mirrored;
    if (mirrored_too || !way.mirrored) best.push_back(way);
  }
  return best_of(std::move(best), graph, grid, scale);
}

PatchFit PatchReference::best_of(std::vector<PatchFit> ways, const FaceGraph& graph, const SampleGrid& grid,
                                 double scale) const {
  const auto improve_all = [&](const Effort& effort) {
    for (PatchFit& way : ways) improve(way, scale, effort, on_surface(graph, grid, scale));
  };
  const auto forget = [&](double least) {
    const double best = std::ranges::max(ways, {}, &PatchFit::fit).fit;
    std::erase_if(ways, [&](const PatchFit& way) { return way.fit < least * best; });
  };
  forget(kRoughlyUndecided);
  if (ways.size() > 1) improve_all(kCloser);
  forget(kUndecided);
  if (ways.size() > 1 && std::ranges::max(ways, {}, &PatchFit::fit).fit > kLikely) improve_all(kDeciding);
  PatchFit best = std::ranges::max(ways, {}, worth);
  for (const PatchFit& way : ways) {
    if (!differ(way, best) || way.fit <= best.fit - kAsWell) continue;
    (way.mirrored == best.mirrored ? best.turns_as_well : best.mirrors_as_well) = true;
  }
  improve(best, scale, kExactly, on_surface(graph, grid, scale));
  return best;
}

template <class Find>
void PatchReference::improve(PatchFit& way, double scale, const Effort& effort, Find&& find) const {
  struct Pair {
    Vector3d from, to, normal;
    double distance, facing;
  };
  const double radius = scale * ball_.radius;
  const std::size_t stride = std::max<std::size_t>(1, around_.samples.size() / effort.samples);
  const double asked = static_cast<double>((around_.samples.size() + stride - 1) / stride);
  std::vector<Pair> pairs;
  std::vector<double> distances;
  double before = std::numeric_limits<double>::infinity();
  const auto find_pairs = [&] {
    pairs.clear();
    const Matrix4d& T = way.target_from_reference;
    const Matrix3d turn = T.topLeftCorner<3, 3>() / way.scale;
    for (std::size_t i = 0; i < around_.samples.size(); i += stride) {
      const SurfaceSample& sample = around_.samples[i];
      const Vector3d from = apply(T, sample.point);
      if (const auto to = find(i, from))
        pairs.push_back(
            {from, to->point, to->normal, (to->point - from).norm(), (turn * sample.normal).dot(to->normal)});
    }
  };
  bool moved = true;  // since the pairs were found
  for (int round = 0; round < effort.rounds; ++round) {
    find_pairs();
    moved = false;
    if (pairs.size() < 6) break;
    distances.clear();
    for (const Pair& pair : pairs) distances.push_back(pair.distance);
    const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, half);
    if (effort.sized && *half > kProgress * before && way.fit < kLikely) break;
    before = *half;
    const double usual = std::max(0.01 * radius, 1.5 * *half);

    // from + w x (from - o) + t + l (from - o) in the plane at `to`: n.(...) = 0, in units of the radius about o; the
    // last column is the right side.
    const Vector3d o = apply(way.target_from_reference, around_.centre);
    Eigen::Matrix<double, 8, 8> sums = Eigen::Matrix<double, 8, 8>::Zero();
    for (const Pair& pair : pairs) {
      const double weight = std::max(0.0, pair.facing) / std::pow(1 + std::pow(pair.distance / usual, 2), 2);
      const Vector3d x = (pair.from - o) / radius;
      Eigen::Matrix<double, 8, 1> row;
      row << x.cross(pair.normal), pair.normal, pair.normal.dot(x), pair.normal.dot(pair.to - pair.from) / radius;
      sums.noalias() += (weight * row) * row.transpose();
    }
    Eigen::Matrix<double, 7, 7> H = sums.topLeftCorner<7, 7>();
    Eigen::Matrix<double, 7, 1> g = sums.topRightCorner<7, 1>();
    if (!effort.sized) {
      H.row(6).setZero();
      H.col(6).setZero();
      H(6, 6) = 1;
      g[6] = 0;
    }
    H.diagonal().array() += 1e-4 * H.trace() / 7 + 1e-12;  // what the surface does not tell stays
    Eigen::Matrix<double, 7, 1> step = H.ldlt().solve(g);
    if (!step.allFinite()) break;
    const double most = step.head<3>().norm();
    if (most > 0.5) step *= 0.5 / most;
    const double wanted = way.scale * std::exp(step[6]);
    const double allowed = std::clamp(wanted, scale / kScaleRange, scale * kScaleRange);
    const double grow = allowed / way.scale;
    way.scale = allowed;
    const double turn = step.head<3>().norm();
    const Matrix3d R =
        turn > 0 ? Eigen::AngleAxisd(turn, step.head<3>() / turn).toRotationMatrix() : Matrix3d(Matrix3d::Identity());
    Matrix4d move = Matrix4d::Identity();
    move.topLeftCorner<3, 3>() = grow * R;
    move.topRightCorner<3, 1>() = o + radius * step.segment<3>(3) - grow * R * o;
    way.target_from_reference = move * way.target_from_reference;
    moved = true;
    if (step.norm() < kStill) break;
  }
  if (moved) find_pairs();
  double sum = 0;
  for (const Pair& pair : pairs)
    sum += std::max(0.0, pair.facing) * std::exp(-std::pow(pair.distance / (effort.apart * radius), 2));
  way.fit = asked > 0 ? sum / asked : 0;
}

}  // namespace armature::sdk
