#include "sdk/expansion/part_registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

Vector3d apply(const Matrix4d& transform, const Vector3d& point) {
  return transform.topLeftCorner<3, 3>() * point + transform.topRightCorner<3, 1>();
}

double mean_square(const OrientedPoints& goal, const Matrix4d& transform, std::span<const Vector3d> points) {
  double sum = 0;
  for (const Vector3d& point : points) {
    const Vector3d p = apply(transform, point);
    sum += (goal.point(goal.closest(p)) - p).squaredNorm();
  }
  return sum / static_cast<double>(points.size());
}

double mean_square_to_planes(const OrientedPoints& goal, const Matrix4d& transform, std::span<const Vector3d> points) {
  double sum = 0;
  for (const Vector3d& point : points) {
    const Vector3d p = apply(transform, point);
    const std::size_t near = goal.closest(p);
    const double d = (goal.point(near) - p).dot(goal.normal(near));
    sum += d * d;
  }
  return sum / static_cast<double>(points.size());
}

/// Iterated closest points, to the planes of the surface there (Chen and Medioni 1992), with scale.
Matrix4d iterate(const OrientedPoints& goal, Matrix4d transform, std::span<const Vector3d> points) {
  using Vector7d = Eigen::Matrix<double, 7, 1>;
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix<double, 7, 7> A = Eigen::Matrix<double, 7, 7>::Zero();
    Vector7d b = Vector7d::Zero();
    Vector3d centre = Vector3d::Zero();
    for (const Vector3d& p : points) centre += apply(transform, p) / static_cast<double>(points.size());
    double spread = 0;
    for (const Vector3d& p : points) spread += (apply(transform, p) - centre).squaredNorm();
    spread = std::sqrt(spread / static_cast<double>(points.size()));
    if (!(spread > 0)) break;
    for (const Vector3d& point : points) {
      const Vector3d p = apply(transform, point);
      const std::size_t near = goal.closest(p);
      const Vector3d& normal = goal.normal(near);
      // Turn, growth and move, all in units of the spread.
      const Vector3d arm = (p - centre) / spread;
      Vector7d row;
      row << arm.cross(normal), arm.dot(normal), normal;
      A += row * row.transpose();
      b += (goal.point(near) - p).dot(normal) / spread * row;
    }
    // Where the surface leaves a motion open, such as along a tube, it stays as it is.
    constexpr double kRidge = 1e-3;
    A.diagonal().array() += kRidge * static_cast<double>(points.size());
    const Vector7d x = A.ldlt().solve(b);
    if (!x.allFinite()) break;
    const double angle = x.head<3>().norm();
    Matrix3d turn = std::exp(x[3]) * Matrix3d::Identity();
    if (angle > 0) turn = turn * Eigen::AngleAxisd(angle, x.head<3>() / angle).toRotationMatrix();
    Matrix4d motion = Matrix4d::Identity();
    motion.topLeftCorner<3, 3>() = turn;
    motion.topRightCorner<3, 1>() = centre + spread * x.tail<3>() - turn * centre;
    transform = motion * transform;
    constexpr double kStill = 1e-3;
    if (x.cwiseAbs().maxCoeff() < kStill) break;
  }
  return transform;
}

}  // namespace

PartFrame frame_of(const Surface& surface, std::span<const FaceId> faces) {
  const Mesh& mesh = surface.mesh;
  std::unordered_map<EdgeId, int> uses;
  Vector3d centroid = Vector3d::Zero();
  double area = 0;
  for (const FaceId face : faces) {
    const double a = area_vector(mesh, face).norm();
    centroid += a / 3 * (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2));
    area += a;
    for (const EdgeId edge : surface.adjacency.edges(face))
      if (edge.valid()) ++uses[edge];
  }
  if (area > 0) centroid /= area;
  Vector3d rim = Vector3d::Zero();
  double length = 0;
  // In the order of faces: the same sums on every run.
  for (const FaceId face : faces)
    for (const EdgeId edge : surface.adjacency.edges(face)) {
      if (!edge.valid() || uses[edge] != 1) continue;
      const Vector3d& a = mesh.position(surface.adjacency.edge(edge)[0]);
      const Vector3d& b = mesh.position(surface.adjacency.edge(edge)[1]);
      rim += (a - b).norm() * 0.5 * (a + b);
      length += (a - b).norm();
    }
  PartFrame frame{.size = std::sqrt(area)};
  const Vector3d origin = length > 0 ? Vector3d(rim / length) : centroid;
  Vector3d z = (centroid - origin).stableNormalized();
  if (z.isZero()) z = Vector3d::UnitZ();
  const Vector3d x = z.unitOrthogonal();
  frame.world_from_part.block<3, 1>(0, 0) = x;
  frame.world_from_part.block<3, 1>(0, 1) = z.cross(x);
  frame.world_from_part.block<3, 1>(0, 2) = z;
  frame.world_from_part.block<3, 1>(0, 3) = origin;
  return frame;
}

void OrientedPoints::add(const Vector3d& point, const Vector3d& normal) {
  const std::size_t place = normals_.size();
  if (place == x_.size())
    for (auto* axis : {&x_, &y_, &z_}) axis->resize(place + kTogether, std::numeric_limits<float>::infinity());
  x_[place] = static_cast<float>(point.x());
  y_[place] = static_cast<float>(point.y());
  z_[place] = static_cast<float>(point.z());
  normals_.push_back(normal);
}

std::size_t OrientedPoints::closest(const Vector3d& point) const noexcept {
  using Group = Eigen::Array<float, kTogether, 1>;
  const Eigen::Vector3f p = point.cast<float>();
  float best = std::numeric_limits<float>::infinity();
  std::size_t place = 0;
  for (std::size_t first = 0; first < x_.size(); first += kTogether) {
    const Group squares = (Eigen::Map<const Group>(&x_[first]) - p.x()).square() +
                          (Eigen::Map<const Group>(&y_[first]) - p.y()).square() +
                          (Eigen::Map<const Group>(&z_[first]) - p.z()).square();
    if (squares.minCoeff() >= best) continue;
    for (std::size_t k = 0; k < kTogether; ++k) {
      const float square = squares[static_cast<Eigen::Index>(k)];
      if (square >= best) continue;
      best = square;
      place = first + k;
    }
  }
  return place;
}

PartRegistration::PartRegistration(const Surface& surface, std::span<const FaceId> reference,
                                   std::span<const VertexId> around)
    : frame_(frame_of(surface, reference)) {
  const Mesh& mesh = surface.mesh;
  std::vector<FaceId> faces(reference.begin(), reference.end());
  for (const VertexId v : around) {
    const auto at = surface.adjacency.faces(v);
    faces.insert(faces.end(), at.begin(), at.end());
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  // Middles of faces and of their halves about each corner, so that coarse meshes have enough of them.
  constexpr std::size_t kMost = 800;
  const std::size_t all = 4 * faces.size();
  const std::size_t count = std::min(kMost, all);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = i * all / count;
    const Triangle& corners = mesh.triangle(faces[place / 4]);
    Vector3d weights = Vector3d::Constant(1.0 / 3);
    if (place % 4 < 3) {
      weights = Vector3d::Constant(1.0 / 6);
      weights[static_cast<Eigen::Index>(place % 4)] = 2.0 / 3;
    }
    Vector3d point = Vector3d::Zero();
    Vector3d normal = Vector3d::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      point += weights[static_cast<Eigen::Index>(k)] * mesh.position(corners[k]);
      normal += weights[static_cast<Eigen::Index>(k)] * surface.vertex_normals[corners[k].index()];
    }
    goal_.add(point, normal.stableNormalized());
  }
}

PartFit PartRegistration::lay(const PartFrame& part, double scale, std::span<const Vector3d> points) const {
  const Matrix4d part_from_world = part.world_from_part.inverse();
  // A few points tell which turn is right.
  constexpr std::size_t kFew = 32;
  std::vector<Vector3d> few;
  const std::size_t step = std::max<std::size_t>(1, points.size() / kFew);
  for (std::size_t i = step / 2; i < points.size(); i += step) few.push_back(points[i]);

  struct Start {
    Matrix4d reference_from_part = Matrix4d::Identity();
    double error = std::numeric_limits<double>::infinity();
  };
  // By handedness, the turns that are better than those beside them, best first.
  constexpr std::size_t kTurns = 12;
  std::array<std::vector<Start>, 2> starts;
  for (const bool mirrored : {false, true}) {
    Matrix4d flip = Matrix4d::Identity();
    if (mirrored) flip(0, 0) = -1;
    std::array<Start, kTurns> all;
    for (std::size_t turn = 0; turn < kTurns; ++turn) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(turn) / kTurns;
      Matrix4d turned = Matrix4d::Identity();
      turned.topLeftCorner<3, 3>() = scale * Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
      const Matrix4d candidate = frame_.world_from_part * turned * flip * part_from_world;
      all[turn] = {candidate, mean_square(goal_, candidate, few)};
    }
    auto& best = starts[mirrored ? 1 : 0];
    for (std::size_t turn = 0; turn < kTurns; ++turn)
      if (all[turn].error <= all[(turn + 1) % kTurns].error &&
          all[turn].error <= all[(turn + kTurns - 1) % kTurns].error)
        best.push_back(all[turn]);
    std::ranges::stable_sort(best, {}, &Start::error);
  }
  // What is much worse from the start will not come out best.
  constexpr double kHopeless = 4;
  constexpr std::size_t kTried = 3;
  constexpr double kWell = 0.005;  // of the root of the area: what fits so well lies right
  constexpr double kBetter = 0.8;  // round things fit as well at any turn: the first stays
  const double hopeless = kHopeless * std::min(starts[0].front().error, starts[1].front().error);
  const auto finished = [&](bool mirrored) {
    std::optional<PartFit> best;
    for (const Start& start :
         std::span(starts[mirrored ? 1 : 0]).first(std::min(kTried, starts[mirrored ? 1 : 0].size()))) {
      if (best && (start.error > hopeless || best->residual < kWell * frame_.size)) break;
      const PartFit laid = refine({start.reference_from_part, mirrored}, points);
      if (!best || laid.residual < kBetter * best->residual) best = laid;
    }
    return *best;
  };
  const PartFit plain = finished(false);
  // Most parts are like their mirror image: only one that fits clearly better counts.
  if (starts[1].front().error > kHopeless * starts[0].front().error) return plain;
  const PartFit mirrored = finished(true);
  constexpr double kClearlyBetter = 0.7;
  return mirrored.residual < kClearlyBetter * plain.residual ? mirrored : plain;
}

double PartRegistration::residual(const Matrix4d& reference_from_part, std::span<const Vector3d> points) const {
  return std::sqrt(mean_square_to_planes(goal_, reference_from_part, points));
}

PartFit PartRegistration::refine(const PartFit& start, std::span<const Vector3d> points) const {
  const Matrix4d& before = start.reference_from_part;
  Matrix4d fit = iterate(goal_, before, points);
  // What shrinks or swells has lost its way.
  constexpr double kMostGrowth = 2;
  const double growth = std::cbrt(fit.topLeftCorner<3, 3>().determinant() / before.topLeftCorner<3, 3>().determinant());
  if (!(growth < kMostGrowth && growth > 1 / kMostGrowth)) fit = before;
  return {fit, start.mirrored, residual(fit, points)};
}

}  // namespace armature::sdk
