#include "tools/evaluation/planted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <random>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/measures.h>

#include "tools/evaluation/shapes.h"

namespace armature::tools {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// Numbers in [0, 1) that are the same on every machine.
class Random {
 public:
  explicit Random(std::uint32_t seed) : bits_(seed) {}
  double operator()() { return static_cast<double>(bits_() >> 11U) * 0x1p-53; }
  Vector3d direction() {
    const double z = 2 * (*this)() - 1;
    const double a = 2 * std::numbers::pi * (*this)();
    return {std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z};
  }
  Matrix3d turn() { return Eigen::AngleAxisd(2 * std::numbers::pi * (*this)(), direction()).toRotationMatrix(); }
  double scale(double largest) { return std::pow(largest, 2 * (*this)() - 1); }

 private:
  std::mt19937_64 bits_;
};

double knob(const Vector2d& x, double a, double b, double width) {
  return std::exp(-((x - Vector2d(a, b)).squaredNorm()) / (width * width));
}

/// Heights over a disc of radius 1, 0 at its edge: the shape that is looked for, and three others.
double relief(std::size_t shape, const Vector2d& x) {
  const double edge = std::pow(std::max(0.0, 1 - x.squaredNorm()), 2);
  switch (shape) {
    case 0: return edge * (0.2 + 0.3 * knob(x, 0.45, 0.1, 0.22) + 0.22 * knob(x, -0.15, 0.4, 0.18));
    case 1: return edge * 0.35;
    case 2: return edge * (0.1 + 0.3 * (knob(x, 0.4, 0, 0.2) + knob(x, -0.2, 0.35, 0.2) + knob(x, -0.2, -0.35, 0.2)));
    default: return edge * 0.3 * std::cos(7 * x.norm());
  }
}

/// A place on the unit ball: its tangents and normal as columns, and the disc of a relief about it.
struct Place {
  Matrix3d frame;
  double radius;
  double side;  // -1 mirrors
  [[nodiscard]] Vector2d on_disc(const Vector3d& point) const {
    const Vector3d x = frame.transpose() * point / radius;
    return x.z() > 0 ? Vector2d(x.x(), side * x.y()) : Vector2d(9, 9);
  }
  [[nodiscard]] Matrix4d ball_from_disc() const {
    Matrix4d T = Matrix4d::Identity();
    T.topLeftCorner<3, 3>() = radius * frame * Vector3d(1, side, 1).asDiagonal();
    T.topRightCorner<3, 1>() = std::sqrt(1 - radius * radius) * frame.col(2);
    return T;
  }
};

/// What a user would have brushed of a relief: less than the disc, and not round.
bool in_region(const Vector2d& x) {
  const double angle = std::atan2(x.y(), x.x());
  return x.norm() < 0.82 + 0.1 * std::cos(2 * angle) + 0.05 * std::sin(angle);
}

std::vector<sdk::FaceId> faces_where(const sdk::Mesh& mesh, const std::function<bool(const Vector3d&)>& wanted) {
  std::vector<sdk::FaceId> faces;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const sdk::FaceId face(f);
    if (wanted((mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3)) faces.push_back(face);
  }
  return faces;
}

sdk::Mesh noisy(const sdk::Mesh& mesh, const PlantOptions& options) {
  return options.noise_percent > 0 ? with_noise(mesh, options.noise_percent, options.seed) : mesh;
}

/// The mesh with its longest axis bent to an arc, towards its second longest.
sdk::Mesh bent(sdk::Mesh mesh, double angle) {
  const Eigen::AlignedBox3d box = sdk::bounding_box(mesh);
  const Vector3d sides = box.sizes();
  Eigen::Index along = 0;
  const double length = sides.maxCoeff(&along);
  const Eigen::Index towards = sides[(along + 1) % 3] > sides[(along + 2) % 3] ? (along + 1) % 3 : (along + 2) % 3;
  if (angle == 0 || !(length > 0)) return mesh;
  const double radius = length / angle;
  for (Vector3d& p : mesh.positions) {
    const Vector3d x = p - box.center();
    const double turn = x[along] / radius;
    p[along] = box.center()[along] + (radius - x[towards]) * std::sin(turn);
    p[towards] = box.center()[towards] + radius - (radius - x[towards]) * std::cos(turn);
  }
  return mesh;
}

double area_of(std::span<const double> areas, std::span<const sdk::FaceId> faces) {
  double sum = 0;
  for (const sdk::FaceId face : faces) sum += areas[face.index()];
  return sum;
}

}  // namespace

PlantedScene planted_reliefs(const PlantOptions& options, int rounds) {
  constexpr double kRadius = 0.16;
  constexpr std::size_t kOthers = 3;
  Random random(options.seed);
  std::vector<Place> places;
  for (int tries = 0; places.size() < (1 + kOthers) * (options.copies + 1) && tries < 100'000; ++tries) {
    const std::size_t shape = places.size() % (1 + kOthers);
    const bool is_copy = shape == 0 && !places.empty();
    Place place{random.turn(), kRadius * (places.empty() ? 1 : random.scale(options.largest_scale)), 1};
    if (is_copy && options.mirrored && places.size() / (1 + kOthers) % 2 == 1) place.side = -1;
    const bool alone = std::ranges::none_of(places, [&](const Place& other) {
      return (other.frame.col(2) - place.frame.col(2)).norm() < 1.1 * (other.radius + place.radius);
    });
    if (alone) places.push_back(place);
  }
  PlantedScene scene{icosphere(rounds)};
  const sdk::Mesh ball = scene.mesh;
  for (Vector3d& p : scene.mesh.positions)
    for (std::size_t i = 0; i < places.size(); ++i) {
      const Vector2d x = places[i].on_disc(p);
      if (x.norm() >= 1) continue;
      p *= 1 + places[i].radius * relief(i % (1 + kOthers), x);
      break;
    }
  const Matrix4d ball_from_reference = places[0].ball_from_disc();
  for (std::size_t i = 0; i < places.size(); i += 1 + kOthers) {
    auto faces = faces_where(ball, [&](const Vector3d& p) { return in_region(places[i].on_disc(p)); });
    if (i == 0) {
      scene.reference = std::move(faces);
    } else {
      scene.copies.push_back(
          {std::move(faces), ball_from_reference * places[i].ball_from_disc().inverse(), places[i].side < 0});
    }
  }
  scene.mesh = noisy(scene.mesh, options);
  return scene;
}

PlantedScene planted_models(const sdk::Mesh& model, std::span<const sdk::FaceId> region, const PlantOptions& options) {
  Random random(options.seed);
  const double apart = 1.5 * options.largest_scale * sdk::bounding_box_diagonal(model);
  PlantedScene scene;
  scene.reference.assign(region.begin(), region.end());
  for (std::size_t i = 0; i <= options.copies; ++i) {
    const bool mirrored = options.mirrored && i % 2 == 1;
    Matrix4d there = Matrix4d::Identity();
    if (i > 0) {
      there.topLeftCorner<3, 3>() =
          random.scale(options.largest_scale) * random.turn() * Vector3d(mirrored ? -1 : 1, 1, 1).asDiagonal();
      there(0, 3) = static_cast<double>(i % 4) * apart;
      there(1, 3) = static_cast<double>(i / 4) * apart;
      PlantedCopy copy{.reference_from_copy = there.inverse(), .mirrored = mirrored};
      for (const sdk::FaceId face : region) copy.faces.emplace_back(face.index() + scene.mesh.triangles.size());
      scene.copies.push_back(std::move(copy));
    }
    PlantOptions own = options;
    own.seed += static_cast<std::uint32_t>(i);
    const double bend = i > 0 && options.bend_rad > 0 ? options.bend_rad * (2 * random() - 1) : 0;
    const sdk::Mesh shaken = noisy(bent(model, bend), own);
    const std::size_t offset = scene.mesh.positions.size();
    for (const Vector3d& p : shaken.positions) scene.mesh.positions.push_back((there * p.homogeneous()).head<3>());
    for (auto [a, b, c] : shaken.triangles) {
      if (mirrored) std::swap(b, c);
      scene.mesh.triangles.push_back(
          {sdk::VertexId(a.index() + offset), sdk::VertexId(b.index() + offset), sdk::VertexId(c.index() + offset)});
    }
  }
  return scene;
}

PlantedScene planted_components(const PlantOptions& options, int rounds) {
  const sdk::Mesh blob = creature(rounds);
  std::vector<sdk::FaceId> all;
  for (std::size_t f = 0; f < blob.triangles.size(); ++f) all.emplace_back(f);
  PlantedScene scene = planted_models(blob, all, options);
  const std::array others = {icosphere(rounds), hollow_ball(rounds, 0.7), half_of(blob)};
  const double apart = 1.5 * options.largest_scale * sdk::bounding_box_diagonal(blob);
  for (std::size_t i = 0; i < others.size() * options.copies; ++i) {
    const sdk::Mesh& other = others[i % others.size()];
    const Vector3d shift(static_cast<double>(i % 5) * apart, static_cast<double>(i / 5) * apart, 3 * apart);
    const std::size_t offset = scene.mesh.positions.size();
    for (const Vector3d& p : other.positions) scene.mesh.positions.emplace_back(p + shift);
    for (const auto& [a, b, c] : other.triangles)
      scene.mesh.triangles.push_back(
          {sdk::VertexId(a.index() + offset), sdk::VertexId(b.index() + offset), sdk::VertexId(c.index() + offset)});
  }
  return scene;
}

std::vector<sdk::FaceId> region_about(const sdk::Mesh& mesh, sdk::VertexId vertex, double radius) {
  const sdk::Adjacency adjacency(mesh);
  const Vector3d centre = mesh.position(vertex);
  std::vector<bool> seen(mesh.triangles.size());
  std::vector<sdk::FaceId> reached;
  const auto reach = [&](std::span<const sdk::FaceId> faces) {
    for (const sdk::FaceId face : faces) {
      if (seen[face.index()]) continue;
      seen[face.index()] = true;
      const Vector3d middle = (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
      if ((middle - centre).norm() < radius) reached.push_back(face);
    }
  };
  reach(adjacency.faces(vertex));
  for (std::size_t i = 0; i < reached.size(); ++i)
    for (const sdk::VertexId corner : mesh.triangle(reached[i])) reach(adjacency.faces(corner));
  std::ranges::sort(reached);
  return reached;
}

sdk::VertexId farthest_vertex(const sdk::Mesh& mesh) {
  const Vector3d middle = sdk::bounding_box(mesh).center();
  const auto farthest =
      std::ranges::max_element(mesh.positions, {}, [&](const Vector3d& p) { return (p - middle).squaredNorm(); });
  return sdk::VertexId(farthest - mesh.positions.begin());
}

double overlap_of(std::span<const double> areas, std::span<const sdk::FaceId> a, std::span<const sdk::FaceId> b) {
  std::vector<sdk::FaceId> common;
  std::ranges::set_intersection(a, b, std::back_inserter(common));
  const double both = area_of(areas, common);
  return both / (area_of(areas, a) + area_of(areas, b) - both);
}

PlantedQuality quality_of(const PlantedScene& scene, const sdk::Expansion& expansion) {
  const std::vector<double> areas = sdk::face_areas(scene.mesh);
  std::vector<bool> found(scene.copies.size());
  PlantedQuality quality;
  double hits = 0;
  std::size_t counted = 0;
  for (const sdk::Match& match : expansion.first(expansion.size())) {
    if (counted == scene.copies.size()) break;
    if (std::ranges::any_of(scene.others_alike,
                            [&](const auto& faces) { return overlap_of(areas, match.faces, faces) > 0.5; }))
      continue;
    ++counted;
    for (std::size_t c = 0; c < scene.copies.size(); ++c) {
      const PlantedCopy& copy = scene.copies[c];
      const double overlap = overlap_of(areas, match.faces, copy.faces);
      if (!(overlap > 0.5)) continue;
      found[c] = true;
      ++hits;
      quality.overlap += overlap;
      const Matrix3d difference =
          match.reference_from_match.topLeftCorner<3, 3>() * copy.reference_from_copy.topLeftCorner<3, 3>().inverse();
      const double cosine = (difference.trace() / std::cbrt(std::abs(difference.determinant())) - 1) / 2;
      const bool as_planted = match.mirrored == copy.mirrored && cosine >= std::numbers::sqrt2 / 2;
      if (scene.turns_known && !as_planted) ++quality.flipped;
      break;
    }
  }
  const auto planted = static_cast<double>(scene.copies.size());
  quality.precision = hits / planted;
  quality.recall = static_cast<double>(std::ranges::count(found, true)) / planted;
  if (hits > 0) {
    quality.overlap /= hits;
    quality.flipped /= hits;
  }
  return quality;
}

}  // namespace armature::tools
