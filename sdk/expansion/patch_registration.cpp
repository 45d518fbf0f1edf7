#include "sdk/expansion/patch_registration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

#include <Eigen/Dense>
#include <armature/sdk/mesh/measures.h>

#include "sdk/selection/flood.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr double kSamples = 600;  // of a patch's surroundings, about, and one a face at least
constexpr std::size_t kMostSamples = 1500;
constexpr std::size_t kFew = 120;   // that decide between angles
constexpr std::size_t kMany = 300;  // that decide where exactly
constexpr std::size_t kStarts = 4;  // that are tried, of each handedness
constexpr double kAstray = 0.25;    // how far from its place a centre is looked for, of the radius
constexpr int kAround = 6;          // in so many directions
constexpr int kFewRounds = 4;
constexpr int kManyRounds = 8;
constexpr double kNear = 0.4;            // what a sample may lie on, of the radius
constexpr double kHopeless = 0.01;       // a misfit that no closer look will mend
constexpr double kStill = 5e-4;          // a step that ends the search, of the radius
constexpr double kScaleRange = 1.3;      // how far the scale may leave what was looked for
constexpr double kWorthMirroring = 0.8;  // a mirror image must leave so much less than the thing itself
constexpr double kUndecided = 0.1;       // a closer look tells which of two is better that differ by less
constexpr double kAlike = 1e-5;          // misfits that differ by less tell nothing
constexpr std::size_t kCellRings = 5;    // of the cells that noise is averaged over
constexpr double kSure = 0.5;            // of the way to the border of the patch, all is on the same side
constexpr std::uint32_t kNotAsked = 0xFFFF'FFFF;
constexpr double kApart = 0.05;  // surfaces that do not lie on one another, of the radius
constexpr double kReach = 0.2;   // how far a face may lie from the patch that it belongs to, of the radius

/// The sector of one relief that a sector of the other comes to lie on.
std::size_t sector_onto(std::size_t sector, std::size_t shift, bool mirrored) {
  constexpr std::size_t n = PolarRelief::kSectors;
  return mirrored ? (shift + n - sector) % n : (shift + sector) % n;
}

double difference(const PolarRelief& reference, const PolarRelief& target, std::size_t shift, bool mirrored) {
  double sum = 0;
  double area = 0;
  for (std::size_t ring = 0; ring < PolarRelief::kRings; ++ring)
    for (std::size_t k = 0; k < PolarRelief::kSectors; ++k) {
      const std::size_t onto = sector_onto(k, shift, mirrored);
      const double both = std::min(reference.area[ring][k], target.area[ring][onto]);
      sum += both * std::pow(reference.height[ring][k] - target.height[ring][onto], 2);
      area += both;
    }
  return area > 0 ? sum / area : 0;
}

/// A place where the reference's centre may lie, and how the surface rises around it.
struct Centre {
  Vector3d point;
  PolarRelief relief;
};

/// A centre, and a shift by sectors against the reference.
struct Start {
  const Centre* at;
  std::size_t shift;
  double difference;
};

/// The starts at which reliefs agree best: local minima over the angle, best first.
std::vector<Start> best_starts(const PolarRelief& reference, const std::vector<Centre>& centres, bool mirrored) {
  constexpr std::size_t n = PolarRelief::kSectors;
  std::vector<Start> minima;
  for (const Centre& centre : centres) {
    std::array<double, n> differences{};
    for (std::size_t k = 0; k < n; ++k) differences[k] = difference(reference, centre.relief, k, mirrored);
    for (std::size_t k = 0; k < n; ++k)
      if (differences[k] <= differences[(k + 1) % n] && differences[k] <= differences[(k + n - 1) % n])
        minima.push_back({&centre, k, differences[k]});
  }
  std::ranges::stable_sort(minima, {}, &Start::difference);
  minima.resize(std::min(minima.size(), kStarts));
  return minima;
}

/// The turn that takes a relief's frame to another's, by a shift.
Matrix3d turn_by(const PolarRelief& reference, const PolarRelief& target, std::size_t shift, bool mirrored) {
  const double angle = 2 * std::numbers::pi * static_cast<double>(shift) / PolarRelief::kSectors;
  // A shift s takes sector k, whose middle is at k + 1/2, to s + k; mirrored, to s - k.
  const double a = mirrored ? angle + 2 * std::numbers::pi / PolarRelief::kSectors : angle;
  Matrix3d about_normal;
  about_normal << std::cos(a), mirrored ? std::sin(a) : -std::sin(a), 0,  //
      std::sin(a), mirrored ? -std::cos(a) : std::cos(a), 0,              //
      0, 0, 1;
  return target.frame * about_normal * reference.frame.transpose();
}

Vector3d apply(const Matrix4d& T, const Vector3d& point) {
  return T.topLeftCorner<3, 3>() * point + T.topRightCorner<3, 1>();
}

PolarRelief relief_of(const std::vector<SurfaceSample>& samples, const Vector3d& centre, double radius) {
  PolarRelief relief;
  Vector3d normal = Vector3d::Zero();
  for (const SurfaceSample& s : samples)
    if ((s.point - centre).norm() <= radius) normal += s.area * s.normal;
  if (!(normal.norm() > 0)) return relief;
  const Vector3d n = normal.normalized();
  const Vector3d u = n.unitOrthogonal();
  relief.frame << u, n.cross(u), n;
  double mean = 0;
  double all = 0;
  for (const SurfaceSample& s : samples) {
    const Vector3d x = relief.frame.transpose() * (s.point - centre) / radius;
    const double distance = x.head<2>().norm();
    if (distance >= 1) continue;
    const double turn = std::atan2(x.y(), x.x()) / (2 * std::numbers::pi);
    const auto sector = static_cast<std::size_t>((turn < 0 ? turn + 1 : turn) * PolarRelief::kSectors);
    const auto ring = static_cast<std::size_t>(distance * PolarRelief::kRings);
    const double area = s.area / (radius * radius);
    relief.height[ring][sector % PolarRelief::kSectors] += area * x.z();
    relief.area[ring][sector % PolarRelief::kSectors] += area;
    mean += area * x.z();
    all += area;
  }
  for (std::size_t ring = 0; ring < PolarRelief::kRings; ++ring)
    for (std::size_t k = 0; k < PolarRelief::kSectors; ++k) {
      const double area = relief.area[ring][k];
      relief.height[ring][k] = area > 0 ? relief.height[ring][k] / area - mean / all : 0;
    }
  return relief;
}

/// The border of a patch, as a mesh of faces that are edges.
Mesh border_of(const Surface& surface, std::span<const FaceId> patch) {
  Mesh border{.positions = surface.mesh.positions};
  std::vector<bool> in_patch(surface.mesh.triangles.size());
  for (const FaceId face : patch) in_patch[face.index()] = true;
  for (const FaceId face : patch)
    for (const EdgeId edge : surface.adjacency.edges(face)) {
      if (!edge.valid()) continue;
      const auto sharing = surface.adjacency.faces(edge);
      const auto& [a, b] = surface.adjacency.edge(edge);
      if (std::ranges::any_of(sharing, [&](FaceId other) { return !in_patch[other.index()]; }))
        border.triangles.push_back({a, b, b});
    }
  return border;
}

/// Where the centre may lie: noise leads the maxima of contexts astray.
std::vector<Centre> centres_about(const PatchSurroundings& there, double radius) {
  std::vector<Centre> centres = {{there.centre, there.relief}};
  for (int k = 0; k < kAround; ++k) {
    const double angle = 2 * std::numbers::pi * k / kAround;
    const Vector3d aside(std::cos(angle), std::sin(angle), 0);
    const Vector3d point = there.centre + kAstray * radius * (there.relief.frame * aside);
    centres.push_back({point, relief_of(there.samples, point, radius)});
  }
  return centres;
}

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

}  // namespace

PatchSurroundings::PatchSurroundings(const Surface& surface, VertexId at, double radius, double reach)
    : centre(surface.mesh.position(at)) {
  const Mesh& mesh = surface.mesh;
  faces = flood(surface.adjacency, surface.adjacency.faces(at), mesh.triangles.size(), [&](FaceId face) {
    return std::ranges::any_of(mesh.triangle(face),
                               [&](VertexId v) { return (mesh.position(v) - centre).norm() <= reach; });
  });
  samples = samples_of(mesh, faces, std::numbers::pi * radius * radius / kSamples);
  std::erase_if(samples, [&](const SurfaceSample& s) { return (s.point - centre).norm() > reach; });
  if (const std::size_t every = samples.size() / kMostSamples; every > 1) {
    // Faces come ring by ring, so that every n-th of them are spread evenly.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples.size(); i += every) samples[kept++] = samples[i];
    samples.erase(samples.begin() + static_cast<std::ptrdiff_t>(kept), samples.end());
  }
  relief = relief_of(samples, centre, radius);
}

PatchReference::PatchReference(const Surface& surface, std::span<const FaceId> patch, const PatchBall& ball)
    : surface_(&surface),
      ball_(ball),
      around_(surface, ball.centre, ball.radius, ball.radius),
      in_patch_(surface.mesh.triangles.size()),
      cells_(cells_of(around_, ball.radius)),
      border_(border_of(surface, patch)) {
  for (const FaceId face : patch) in_patch_[face.index()] = true;
}

Registration PatchReference::lay_onto(const Surface& target, VertexId at, double scale, bool mirrored_too) const {
  const double radius = scale * ball_.radius;
  const PatchSurroundings there(target, at, radius, (1 + kAstray) * radius);
  const std::vector<Centre> centres = centres_about(there, radius);
  const auto best_of = [&](bool mirrored) {
    std::optional<Registration> best;
    for (const Start& start : best_starts(around_.relief, centres, mirrored)) {
      Registration tried{.scale = scale, .mirrored = mirrored};
      const Matrix3d A = scale * turn_by(around_.relief, start.at->relief, start.shift, mirrored);
      tried.target_from_reference.topLeftCorner<3, 3>() = A;
      tried.target_from_reference.topRightCorner<3, 1>() = start.at->point - A * around_.centre;
      improve(target, tried, scale, kFew, kFewRounds);
      if (!best || tried.misfit < best->misfit) best = tried;
    }
    return *best;
  };
  Registration best = best_of(false);
  if (mirrored_too) {
    Registration mirrored = best_of(true);
    for (Registration* laid : {&best, &mirrored}) improve(target, *laid, scale, kMany, kFewRounds);
    if (mirrored.misfit + kAlike < kWorthMirroring * best.misfit) best = mirrored;
  }
  if (best.misfit < kHopeless) improve(target, best, scale, kMany, kManyRounds);
  return best;
}

void PatchReference::improve(const Surface& target, Registration& registration, double scale, std::size_t samples,
                             int rounds) const {
  struct Pair {
    Vector3d from, to, normal;
    double distance, facing;
    std::size_t cell;
  };
  const double radius = scale * ball_.radius;
  const std::size_t stride = std::max<std::size_t>(1, around_.samples.size() / samples);
  std::vector<Pair> pairs;
  std::vector<double> distances;
  std::vector<FaceId> hints((around_.samples.size() + stride - 1) / stride);
  const auto find_pairs = [&] {
    pairs.clear();
    const Matrix4d& T = registration.target_from_reference;
    FaceId near;
    for (std::size_t i = 0; i < around_.samples.size(); i += stride) {
      const SurfaceSample& sample = around_.samples[i];
      const Vector3d from = apply(T, sample.point);
      FaceId& hint = hints[i / stride];
      if (hint.valid()) near = hint;
      const SurfacePoint to = target.tree.closest(from, {.within = kNear * radius, .hint = near});
      if (!to.face.valid()) continue;
      hint = near = to.face;
      Vector3d normal = Vector3d::Zero();
      for (std::size_t k = 0; k < 3; ++k)
        normal += to.barycentric[static_cast<Eigen::Index>(k)] *
                  target.vertex_normals[target.mesh.triangle(to.face)[k].index()];
      if (normal.norm() > 0) normal.normalize();
      const double facing = (T.topLeftCorner<3, 3>() * sample.normal).normalized().dot(normal);
      pairs.push_back({from, to.point, normal, to.distance, facing, cells_[i]});
    }
  };
  for (int round = 0; round < rounds; ++round) {
    find_pairs();
    if (pairs.size() < 6) break;
    distances.clear();
    for (const Pair& pair : pairs) distances.push_back(pair.distance);
    const auto half = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::ranges::nth_element(distances, half);
    const double usual = std::max(0.01 * radius, 1.5 * *half);

    // from + w x (from - o) + t + l (from - o) in the plane at `to`: n.(...) = 0, in units of the radius about o.
    const Vector3d o = apply(registration.target_from_reference, around_.centre);
    Eigen::Matrix<double, 7, 7> H = Eigen::Matrix<double, 7, 7>::Zero();
    Eigen::Matrix<double, 7, 1> g = Eigen::Matrix<double, 7, 1>::Zero();
    for (const Pair& pair : pairs) {
      const double weight = std::max(0.0, pair.facing) / std::pow(1 + std::pow(pair.distance / usual, 2), 2);
      const Vector3d x = (pair.from - o) / radius;
      Eigen::Matrix<double, 7, 1> row;
      row << x.cross(pair.normal), pair.normal, pair.normal.dot(x);
      H += weight * row * row.transpose();
      g += weight * row * pair.normal.dot(pair.to - pair.from) / radius;
    }
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
    if (step.norm() < kStill) break;
  }
  find_pairs();
  // A twentieth of the radius apart is as bad as nothing there.
  double sum = 0;
  std::array<double, 3 * kCellRings * kCellRings> apart{};
  std::array<double, 3 * kCellRings * kCellRings> count{};
  for (const Pair& pair : pairs) {
    sum += std::max(0.0, pair.facing) * std::exp(-std::pow(pair.distance / (kApart * radius), 2));
    apart[pair.cell] += std::clamp(pair.normal.dot(pair.to - pair.from) / radius, -kReach, kReach);
    ++count[pair.cell];
  }
  registration.fit = hints.empty() ? 0 : sum / static_cast<double>(hints.size());
  // Where nothing lies near, the surfaces are apart by the reach.
  double squares = kReach * kReach * static_cast<double>(hints.size() - pairs.size());
  for (std::size_t cell = 0; cell < count.size(); ++cell)
    if (count[cell] > 0) squares += apart[cell] * apart[cell] / count[cell];
  registration.misfit = hints.empty() ? 0 : squares / static_cast<double>(hints.size());
}

std::vector<FaceId> PatchReference::extent(const Surface& target, const Registration& registration) const {
  const Mesh& mesh = target.mesh;
  const Matrix4d reference_from_target = registration.target_from_reference.inverse();
  const SurfacePoint start = target.tree.closest(apply(registration.target_from_reference, around_.centre));
  if (!start.face.valid()) return {};
  const double reach = (1 + kReach) * ball_.radius;
  const auto near = flood(target.adjacency, std::span(&start.face, 1), mesh.triangles.size(), [&](FaceId face) {
    return face == start.face || (apply(reference_from_target, middle(mesh, face)) - around_.centre).norm() < reach;
  });
  // Where the patch's boundary is far, what holds for one face holds for those around it.
  struct Asked {
    Vector3d at;
    double valid_within;
    bool inside;
  };
  const auto ask = [&](FaceId face, const Vector3d& at) {
    const SurfacePoint on = surface_->tree.closest(at, {.within = kReach * ball_.radius});
    const double border = border_.closest(at).distance;
    const bool lies_there = on.face.valid() && in_patch_[on.face.index()];
    const Vector3d facing = reference_from_target.topLeftCorner<3, 3>() * area_vector(mesh, face);
    return Asked{at, kSure * border, lies_there && facing.dot(area_vector(surface_->mesh, on.face)) >= 0};
  };
  std::vector<Asked> asked;
  std::vector<std::uint32_t> answer(mesh.triangles.size(), kNotAsked);  // by face
  std::vector<FaceId> inside;
  std::vector<bool> is_inside(mesh.triangles.size());
  for (const FaceId face : near) {
    const Vector3d at = apply(reference_from_target, middle(mesh, face));
    std::uint32_t& mine = answer[face.index()];
    for (const EdgeId edge : target.adjacency.edges(face)) {
      if (!edge.valid()) continue;
      for (const FaceId next : target.adjacency.faces(edge)) {
        const std::uint32_t theirs = answer[next.index()];
        if (theirs != kNotAsked && (asked[theirs].at - at).norm() < asked[theirs].valid_within) mine = theirs;
      }
    }
    if (mine == kNotAsked) {
      mine = static_cast<std::uint32_t>(asked.size());
      asked.push_back(ask(face, at));
    }
    if (!asked[mine].inside) continue;
    inside.push_back(face);
    is_inside[face.index()] = true;
  }
  std::vector<FaceId> largest;
  double most = -1;
  for (const FaceId face : inside) {
    if (!is_inside[face.index()]) continue;
    auto piece = flood(target.adjacency, std::span(&face, 1), mesh.triangles.size(),
                       [&](FaceId f) { return bool{is_inside[f.index()]}; });
    double area = 0;
    for (const FaceId f : piece) {
      is_inside[f.index()] = false;
      area += area_vector(mesh, f).norm();
    }
    if (area > most) {
      most = area;
      largest = std::move(piece);
    }
  }
  std::ranges::sort(largest);
  return largest;
}

}  // namespace armature::sdk
