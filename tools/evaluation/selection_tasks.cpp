#include "tools/evaluation/selection_tasks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/part_cut.h>
#include <armature/sdk/selection/patch_brush.h>

#include "tools/evaluation/shapes.h"

namespace armature::tools {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// What grows out of a unit ball around a direction: its height over a place, in the plane through the direction's tip,
/// whose first axis lies across the ball's up (z).
struct Feature {
  Vector3d towards;
  std::function<double(const Vector2d&)> height;
};

/// How one feature comes to lie on another that is like it: mirrored across its first axis if at all, then turned.
struct Symmetry {
  double turn_rad = 0;
  bool mirrored = false;
  [[nodiscard]] Vector2d undone(const Vector2d& x) const {
    const Vector2d back = Eigen::Rotation2Dd(-turn_rad) * x;
    return {mirrored ? -back.x() : back.x(), back.y()};
  }
};

/// What is round lies on itself however it is turned or mirrored.
std::vector<Symmetry> of_round_things() {
  constexpr int kTurns = 72;
  std::vector<Symmetry> all;
  for (int i = 0; i < kTurns; ++i)
    for (const bool mirrored : {false, true}) all.push_back({2 * std::numbers::pi * i / kTurns, mirrored});
  return all;
}

/// A ball with features, and which of its places belong to which.
class Figure {
 public:
  explicit Figure(std::vector<Feature> features)
      : features_(std::move(features)), ball_(icosphere(6)), tree_(ball_), mesh_(ball_) {
    for (Vector3d& p : mesh_.positions) {
      double height = 0;
      for (const Feature& feature : features_) height = std::max(height, feature.height(place(feature, p)));
      p *= 1 + height;
    }
  }

  [[nodiscard]] const sdk::Mesh& mesh() const { return mesh_; }

  /// Faces about the first feature, carried to another, place by place.
  [[nodiscard]] std::vector<sdk::FaceId> carried(const std::vector<sdk::FaceId>& faces, std::size_t to,
                                                 const Symmetry& by) const {
    const auto& [u, v, n] = axes(features_[0].towards);
    std::vector<sdk::FaceId> there;
    for (std::size_t f = 0; f < ball_.triangles.size(); ++f) {
      const sdk::FaceId face(f);
      const Vector3d middle = (ball_.corner(face, 0) + ball_.corner(face, 1) + ball_.corner(face, 2)) / 3;
      const Vector2d at = place(features_[to], middle);
      if (!(at.norm() < 1)) continue;
      const Vector2d from = by.undone(at);
      const Vector3d here = (n + from.x() * u + from.y() * v).normalized();
      if (std::ranges::binary_search(faces, tree_.closest(here).face)) there.push_back(face);
    }
    return there;
  }

  /// Where a place of a feature came to lie: the vertex that was nearest.
  [[nodiscard]] Vector3d point(std::size_t feature, const Vector2d& at) const {
    const auto& [u, v, n] = axes(features_[feature].towards);
    const Vector3d wanted = (n + at.x() * u + at.y() * v).normalized();
    const auto nearest = std::ranges::min_element(
        ball_.positions, {}, [&](const Vector3d& p) { return (p.normalized() - wanted).squaredNorm(); });
    return mesh_.positions[static_cast<std::size_t>(nearest - ball_.positions.begin())];
  }
  /// A stroke across the upper side of a feature, at so many radians from its direction.
  [[nodiscard]] std::vector<Vector3d> stroke_across(std::size_t feature, double at) const {
    std::vector<Vector3d> stroke;
    for (int i = 0; i <= 8; ++i) {
      const double turn = std::numbers::pi * (0.1 + 0.1 * i);
      stroke.push_back(point(feature, at * Vector2d(std::cos(turn), std::sin(turn))));
    }
    return stroke;
  }

 private:
  struct Axes {
    Vector3d u, v, n;
  };
  static Axes axes(const Vector3d& towards) {
    const Vector3d n = towards.normalized();
    const Vector3d up = std::abs(n.z()) > 0.9 ? Vector3d::UnitY() : Vector3d::UnitZ();
    const Vector3d u = up.cross(n).normalized();
    return {u, n.cross(u), n};
  }
  static Vector2d place(const Feature& feature, const Vector3d& p) {
    const auto& [u, v, n] = axes(feature.towards);
    if (!(p.dot(n) > 0)) return Vector2d::Constant(9);
    return Vector2d(p.dot(u), p.dot(v)) / p.dot(n);
  }

  std::vector<Feature> features_;
  sdk::Mesh ball_;
  sdk::MeshTree tree_;  // of that
  sdk::Mesh mesh_;
};

/// A limb with a flat end, or a low bump.
auto limb(double width, double height) {
  return [=](const Vector2d& x) { return height * std::exp(-std::pow(x.norm() / width, 4)); };
}
auto bump(double width, double height, const Vector2d& at = Vector2d::Zero()) {
  return [=](const Vector2d& x) { return height * std::exp(-(x - at).squaredNorm() / (width * width)); };
}

/// The truth is the reference carried by a symmetry of what is looked for. Of several, which nothing tells apart, the
/// one that a match comes closest to.
SelectionTask task_of(std::string name, const Figure& figure, sdk::Expansion expansion,
                      const std::vector<std::size_t>& others, const std::vector<Symmetry>& symmetries) {
  PlantedScene scene{.mesh = figure.mesh(), .reference = expansion.reference(), .turns_known = false};
  const std::vector<double> areas = sdk::face_areas(scene.mesh);
  for (const std::size_t feature : others) {
    PlantedCopy closest;
    double most = -1;
    for (const Symmetry& symmetry : symmetries) {
      PlantedCopy copy{.faces = figure.carried(scene.reference, feature, symmetry), .mirrored = symmetry.mirrored};
      for (const sdk::Match& match : expansion.first(others.size()))
        if (const double overlap = overlap_of(areas, match.faces, copy.faces); overlap > most) {
          most = overlap;
          closest = copy;
        }
    }
    scene.copies.push_back(std::move(closest));
  }
  return {std::move(name), std::move(scene), std::move(expansion)};
}

sdk::Expected<sdk::Expansion> expand_stroke(const Figure& figure, const std::vector<Vector3d>& stroke,
                                            const sdk::Task& task) {
  const sdk::Surface surface(figure.mesh());
  const auto model = sdk::PartModel::build(surface, task);
  if (!model) return tl::unexpected(model.error());
  const auto points = sdk::project_stroke(surface, stroke, "stroke");
  if (!points) return tl::unexpected(points.error());
  sdk::PartCut cut(*model);
  for (const sdk::SurfacePoint& point : *points) cut.add_point(point);
  const auto part = cut.faces();
  if (!part) return tl::unexpected(part.error());
  return sdk::expand_part(*model, *part, {}, task);
}

sdk::Expected<sdk::Expansion> expand_dabs(const Figure& figure, const sdk::PatchStrokes& drawn, const sdk::Task& task) {
  const sdk::Surface surface(figure.mesh());
  const auto patch = sdk::select_patch(surface, drawn);
  if (!patch) return tl::unexpected(patch.error());
  return sdk::expand_patch(surface, *patch, {}, task);
}

sdk::Expected<SelectionTask> legs_of_an_ant(const sdk::Task& task) {
  std::vector<Feature> features;
  for (const double x : {-0.5, 0.0, 0.5})
    for (const double y : {-0.8, 0.8}) features.push_back({{x, y, -0.5}, limb(0.16, 0.9)});
  for (const double y : {-0.4, 0.4}) features.push_back({{1, y, 0.4}, limb(0.1, 0.5)});
  features.push_back({{-1, 0, 0.2}, bump(0.5, 0.8)});
  const Figure ant(std::move(features));
  return expand_stroke(ant, ant.stroke_across(0, 0.17), task).map([&](sdk::Expansion expansion) {
    return task_of("six legs of an ant", ant, std::move(expansion), {1, 2, 3, 4, 5}, of_round_things());
  });
}

sdk::Expected<SelectionTask> bumps_of_average_size(const sdk::Task& task) {
  constexpr int kBumps = 24;
  constexpr double kMiddling = 0.14;
  std::vector<Feature> features;
  std::vector<std::size_t> others;
  for (int i = 0; i < kBumps; ++i) {
    const double z = 1 - (2.0 * i + 1) / kBumps;
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double width = kMiddling * std::array{1.0, 0.6, 1.5}[static_cast<std::size_t>(i) % 3];
    features.push_back(
        {{std::sqrt(1 - z * z) * std::cos(turn), std::sqrt(1 - z * z) * std::sin(turn), z}, bump(0.7 * width, width)});
    if (i > 0 && i % 3 == 0) others.push_back(static_cast<std::size_t>(i));
  }
  const Figure ball(std::move(features));
  const sdk::PatchStrokes dab{.strokes = {{ball.point(0, {0, 0})}}, .radius = 0.5 * kMiddling};
  return expand_dabs(ball, dab, task).map([&](sdk::Expansion expansion) {
    return task_of("bumps of average size", ball, std::move(expansion), others, of_round_things());
  });
}

sdk::Expected<SelectionTask> eyes_of_a_face(const sdk::Task& task) {
  // A pupil, and a lid towards the temple.
  const auto eye = [](double side) {
    return [=](const Vector2d& x) {
      const double ball = 0.08 * std::exp(-std::pow(x.norm() / 0.15, 4));
      return ball + bump(0.05, 0.04, {-side * 0.03, 0})(x) + bump(0.06, 0.04, {side * 0.08, 0.06})(x);
    };
  };
  std::vector<Feature> features = {{{1, -0.45, 0.3}, eye(-1)}, {{1, 0.45, 0.3}, eye(1)}};
  features.push_back({{1, 0, 0}, bump(0.15, 0.3)});
  features.push_back({{1, 0, -0.45}, [](const Vector2d& x) {
                        return 0.08 * std::exp(-std::pow(x.x() / 0.3, 4) - std::pow(x.y() / 0.06, 2));
                      }});
  for (const double y : {-1.0, 1.0}) features.push_back({{0, y, 0.1}, limb(0.2, 0.3)});
  const Figure face(std::move(features));
  const sdk::PatchStrokes dab{.strokes = {{face.point(0, {-0.05, 0}), face.point(0, {0.05, 0})}}, .radius = 0.08};
  return expand_dabs(face, dab, task).map([&](sdk::Expansion expansion) {
    return task_of("two eyes", face, std::move(expansion), {1}, {{.mirrored = true}});
  });
}

sdk::Expected<SelectionTask> hands_of_a_figure(const sdk::Task& task) {
  // An arm, thicker at its end by a thumb that points forward.
  const auto arm = [](double side) {
    return [=](const Vector2d& x) { return limb(0.2, 1.2)(x) + bump(0.06, 0.35, {side * 0.09, 0})(x); };
  };
  std::vector<Feature> features = {{{0, -1, 0.2}, arm(1)}, {{0, 1, 0.2}, arm(-1)}};
  for (const double y : {-0.4, 0.4}) features.push_back({{0, y, -1}, limb(0.25, 1.5)});
  features.push_back({{0, 0, 1}, limb(0.4, 0.6)});
  const Figure figure(std::move(features));
  return expand_stroke(figure, figure.stroke_across(0, 0.2), task).map([&](sdk::Expansion expansion) {
    // Upper side and lower side are alike.
    return task_of("two hands", figure, std::move(expansion), {1},
                   {{.mirrored = true}, {.turn_rad = std::numbers::pi}});
  });
}

}  // namespace

sdk::Expected<std::vector<SelectionTask>> selection_tasks(const sdk::Task& task) {
  std::vector<SelectionTask> tasks;
  for (const auto& make : {legs_of_an_ant, bumps_of_average_size, eyes_of_a_face, hands_of_a_figure}) {
    auto made = make(task);
    if (!made) return tl::unexpected(made.error());
    tasks.push_back(std::move(*made));
  }
  return tasks;
}

}  // namespace armature::tools
