#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Dense>
#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/parallel_for.h>

#include "sdk/expansion/enclosing_ball.h"
#include "sdk/expansion/surface_samples.h"
#include "sdk/selection/flood.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr int kBins = 10;               // along distance and along angle
constexpr double kSamples = 1000;       // of a component, about
constexpr std::size_t kPairs = 64;      // places at which two components are held against each other
constexpr double kCopy = 0.02;          // how far those of copies may leave each other, of the root mean square radius
constexpr double kClearlyBetter = 0.5;  // a mirror image must fit so much better than the thing itself

/// Spreads a mass over the bins on both sides of a place, in [0, 1].
struct Binned {
  int bin;
  double share;  // of the next bin
  explicit Binned(double place) {
    const double at = std::clamp(place * kBins - 0.5, 0.0, kBins - 1.0);
    bin = std::min(static_cast<int>(at), kBins - 2);
    share = at - bin;
  }
};

/// The approximate shape context of algorithm 1, of the surface that faces away from its middle.
Histogram context_of(const std::vector<SurfaceSample>& samples, const EnclosingBall& ball) {
  double volume = 0;
  for (const SurfaceSample& s : samples) volume += s.area * s.normal.dot(s.point - ball.centre);
  const double outward = volume < 0 ? -1 : 1;
  Histogram context(std::size_t{kBins} * kBins, 0.0F);
  for (const SurfaceSample& s : samples) {
    const Vector3d from_centre = s.point - ball.centre;
    const double distance = from_centre.norm();
    const double cosine = distance > 0 ? outward * s.normal.dot(from_centre) / distance : 1;
    const Binned d(ball.radius > 0 ? distance / ball.radius : 0);
    const Binned theta(std::acos(std::clamp(cosine, -1.0, 1.0)) / std::numbers::pi);
    const auto add = [&](int i, int j, double mass) {
      context[static_cast<std::size_t>(i * kBins + j)] += static_cast<float>(mass);
    };
    add(d.bin, theta.bin, s.area * (1 - d.share) * (1 - theta.share));
    add(d.bin, theta.bin + 1, s.area * (1 - d.share) * theta.share);
    add(d.bin + 1, theta.bin, s.area * d.share * (1 - theta.share));
    add(d.bin + 1, theta.bin + 1, s.area * d.share * theta.share);
  }
  normalise(context);
  return context;
}

constexpr std::array<std::array<Eigen::Index, 3>, 10> kCubic = {
    {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 1, 1}, {0, 1, 2}, {0, 2, 2}, {1, 1, 1}, {1, 1, 2}, {1, 2, 2}, {2, 2, 2}}};

ComponentShape shape_of(const Mesh& mesh, std::span<const FaceId> faces) {
  std::vector<Vector3d> corners;
  for (const FaceId face : faces)
    for (std::size_t k = 0; k < 3; ++k) corners.push_back(mesh.corner(face, k));
  const EnclosingBall ball = smallest_enclosing_ball(corners);
  double total = 0;
  for (const FaceId face : faces) total += area_vector(mesh, face).norm();
  const std::vector<SurfaceSample> samples = samples_of(mesh, faces, total / kSamples);

  ComponentShape shape{.radius = ball.radius};
  shape.context = context_of(samples, ball);
  shape.centroid = ball.centre;
  if (samples.empty()) return shape;
  Vector3d first = Vector3d::Zero();  // moments about the ball's centre
  Matrix3d second = Matrix3d::Zero();
  for (const SurfaceSample& s : samples) {
    const Vector3d x = s.point - ball.centre;
    const Vector3d weighted = s.area * x;
    shape.area += s.area;
    first += weighted;
    second += weighted * x.transpose();
  }
  first /= shape.area;
  shape.centroid += first;
  const Matrix3d covariance = second / shape.area - first * first.transpose();
  const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(covariance);
  shape.axes = principal.eigenvectors().rowwise().reverse();
  if (shape.axes.determinant() < 0) shape.axes.col(2) *= -1;
  shape.spread = principal.eigenvalues().reverse().cwiseMax(0);
  const double rms = std::sqrt(shape.spread.sum());
  if (!(rms > 0)) return shape;
  const Matrix3d to_axes = shape.axes.transpose() / rms;
  for (const SurfaceSample& s : samples) {
    const Vector3d x = to_axes * (s.point - shape.centroid);
    const double share = s.area / shape.area;
    for (std::size_t m = 0; m < kCubic.size(); ++m)
      shape.skew[m] += share * x[kCubic[m][0]] * x[kCubic[m][1]] * x[kCubic[m][2]];
  }
  return shape;
}

/// A turn, mirrored or not, and how badly it fits: 0 is well.
struct Turn {
  Matrix3d reference_from_match = Matrix3d::Identity();
  double misfit = 0;
};

/// One that keeps the handedness, and one that does not.
struct Turns {
  Turn proper, mirrored;
  [[nodiscard]] bool prefer_mirrored(double worth_it) const {
    return proper.misfit > worth_it && mirrored.misfit < kClearlyBetter * proper.misfit;
  }
};

/// The turns that take principal axes to principal axes, with the ends that the third moments choose.
Turns turns_of_axes(const ComponentShape& match, const ComponentShape& reference) {
  constexpr double kNone = 1e300;
  Turns turns{{.misfit = kNone}, {.misfit = kNone}};
  for (unsigned ends = 0; ends < 8; ++ends) {
    const Vector3d sign((ends & 1U) != 0 ? -1 : 1, (ends & 2U) != 0 ? -1 : 1, (ends & 4U) != 0 ? -1 : 1);
    double misfit = 0;
    for (std::size_t m = 0; m < kCubic.size(); ++m) {
      const auto& [i, j, k] = kCubic[m];
      misfit += std::pow(sign[i] * sign[j] * sign[k] * match.skew[m] - reference.skew[m], 2);
    }
    misfit = std::sqrt(misfit);
    Turn& best = sign.prod() > 0 ? turns.proper : turns.mirrored;
    if (misfit < best.misfit) best = {reference.axes * sign.asDiagonal() * match.axes.transpose(), misfit};
  }
  return turns;
}

/// The turns that lay the faces of one component onto those of another in their order, as if it were its copy (Kabsch
/// 1976). The misfit is the root mean square distance over the reference's root mean square radius.
Turns turns_of_copies(const Mesh& mesh, std::span<const FaceId> match, const ComponentShape& match_shape,
                      const Mesh& reference_mesh, std::span<const FaceId> reference,
                      const ComponentShape& reference_shape, double scale) {
  const std::size_t pairs = std::min(kPairs, match.size());
  Matrix3d covariance = Matrix3d::Zero();
  double spread = 0;
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::size_t place = i * match.size() / pairs;
    const Vector3d m = scale * (middle(mesh, match[place]) - match_shape.centroid);
    const Vector3d r = middle(reference_mesh, reference[place]) - reference_shape.centroid;
    covariance += r * m.transpose();
    spread += r.squaredNorm() + m.squaredNorm();
  }
  const Eigen::JacobiSVD<Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Vector3d& s = svd.singularValues();
  const Matrix3d whole = svd.matrixU() * svd.matrixV().transpose();
  const Matrix3d turned = svd.matrixU() * Vector3d(1, 1, -1).asDiagonal() * svd.matrixV().transpose();
  const double size = static_cast<double>(pairs) * reference_shape.spread.sum();
  const auto misfit = [&](double trace) { return std::sqrt(std::max(0.0, spread - 2 * trace) / size); };
  const Turn with{whole, misfit(s.sum())};
  const Turn without{turned, misfit(s[0] + s[1] - s[2])};
  return whole.determinant() > 0 ? Turns{with, without} : Turns{without, with};
}

/// "a copy, mirrored, 1.5 times as large".
std::string reason_of(bool copy, double likeness, bool mirrored, double match_over_reference) {
  std::array<char, 32> digits{};
  std::string reason;
  reason.reserve(80);
  if (copy) {
    reason += "a copy";
  } else {
    const auto end = std::to_chars(digits.begin(), digits.end(), std::lround(100 * likeness));
    reason.append("area lies ").append(digits.begin(), end.ptr).append(" % alike about the centre");
  }
  if (mirrored) reason += ", mirrored";
  if (std::abs(match_over_reference - 1) < 0.01) return reason += ", of the same size";
  const auto end = std::to_chars(digits.begin(), digits.end(), match_over_reference, std::chars_format::general, 3);
  return reason.append(", ").append(digits.begin(), end.ptr).append(" times as large");
}

/// In blocks of memory, where a vector's own constructor goes face by face.
std::vector<FaceId> copy_of(std::span<const FaceId> faces) {
  std::vector<FaceId> copy(faces.size());
  std::copy(faces.begin(), faces.end(), copy.begin());
  return copy;
}

}  // namespace

Expected<ComponentIndex> ComponentIndex::build(const Mesh& mesh, const Adjacency& adjacency, const Task& task) {
  ComponentIndex index;
  index.mesh_ = &mesh;
  Components components = find_components(mesh, adjacency, LinkedBy::Edges);
  index.starts_.assign(components.count + 1, 0);
  for (const std::uint32_t c : components.of_face)
    if (c != Components::kNone) ++index.starts_[c + 1];
  for (std::size_t c = 0; c < components.count; ++c) index.starts_[c + 1] += index.starts_[c];
  index.faces_.resize(index.starts_.back());
  std::vector<std::size_t> next(index.starts_.begin(), index.starts_.end() - 1);
  for (std::size_t f = 0; f < components.of_face.size(); ++f)
    if (components.of_face[f] != Components::kNone) index.faces_[next[components.of_face[f]]++] = FaceId(f);
  index.of_face_ = std::move(components.of_face);
  if (task.stopped()) return cancelled();

  index.shapes_.resize(components.count);
  tbb::parallel_for(std::size_t{0}, components.count, [&](std::size_t c) {
    if (!task.stopped()) index.shapes_[c] = shape_of(mesh, index.faces(c));
  });
  if (task.stopped()) return cancelled();
  return index;
}

Expected<std::uint32_t> ComponentIndex::component_of(FaceId face) const {
  if (face.index() >= of_face_.size())
    return fail("face " + std::to_string(face.index()) + " is not there: the mesh has faces 0 to " +
                std::to_string(of_face_.size()) + ", less one");
  if (of_face_[face.index()] == Components::kNone)
    return fail("face " + std::to_string(face.index()) +
                " names a vertex twice and belongs to no component; click another");
  return of_face_[face.index()];
}

Expected<std::vector<FaceId>> ComponentIndex::select(FaceId face) const {
  return component_of(face).map([this](std::uint32_t component) {
    const auto all = faces(component);
    return std::vector<FaceId>(all.begin(), all.end());
  });
}

Expected<Expansion> ComponentIndex::expand(FaceId face) const {
  return expand(*this, face);
}

Expected<Expansion> ComponentIndex::expand(const ComponentIndex& of, FaceId face) const {
  const auto chosen = of.component_of(face);
  if (!chosen) return tl::unexpected(chosen.error());
  const ComponentShape& reference = of.shapes_[*chosen];
  const auto reference_faces = of.faces(*chosen);
  std::vector<std::optional<Candidate>> found(size());
  constexpr std::size_t kGrain = 32;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, size(), kGrain), [&](const auto& range) {
    for (std::size_t c = range.begin(); c < range.end(); ++c) {
      if ((&of == this && c == *chosen) || !(shapes_[c].area > 0) || !(reference.area > 0)) continue;
      const ComponentShape& shape = shapes_[c];
      const auto its_faces = faces(c);
      const double scale = std::sqrt(reference.spread.sum() / shape.spread.sum());
      std::optional<Turns> turns;
      bool mirrored = false;
      if (its_faces.size() == reference_faces.size()) {
        const Turns of_copies = turns_of_copies(*mesh_, its_faces, shape, *of.mesh_, reference_faces, reference, scale);
        mirrored = of_copies.prefer_mirrored(1e-6);
        if ((mirrored ? of_copies.mirrored : of_copies.proper).misfit < kCopy) turns = of_copies;
      }
      const bool copy = turns.has_value();
      if (!copy) {
        turns = turns_of_axes(shape, reference);
        mirrored = turns->prefer_mirrored(0.01);
      }
      const double score = 1 - chi_square(shape.context, reference.context);
      Match match{.faces = copy_of(its_faces), .score = score, .mirrored = mirrored};
      const Matrix3d A = scale * (mirrored ? turns->mirrored : turns->proper).reference_from_match;
      match.reference_from_match.topLeftCorner<3, 3>() = A;
      match.reference_from_match.topRightCorner<3, 1>() = reference.centroid - A * shape.centroid;
      match.reason = reason_of(copy, score, mirrored, 1 / scale);
      found[c] = {std::move(match), shape.context};
    }
  });
  std::vector<Candidate> candidates;
  std::vector<Rejected> rejected;
  candidates.reserve(size());
  for (std::size_t c = 0; c < size(); ++c) {
    if (found[c]) {
      candidates.push_back(std::move(*found[c]));
    } else if (&of != this || c != *chosen) {
      rejected.push_back({faces(c)[faces(c).size() / 2], "it or the reference has no area"});
    }
  }
  return Expansion(copy_of(reference_faces), std::move(candidates), std::move(rejected));
}

}  // namespace armature::sdk
