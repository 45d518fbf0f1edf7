#include "tools/evaluation/part_times.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/part_cut.h>

#include "tools/elapsed.h"
#include "tools/evaluation/shapes.h"

namespace armature::tools {

using Eigen::Vector3d;

std::vector<sdk::SurfacePoint> stroke_below(const sdk::PartModel& model, const PartTip& wanted) {
  const sdk::Surface& surface = model.surface();
  const sdk::Mesh& mesh = surface.mesh;
  const Eigen::VectorXd& phi = model.conformal_factor();
  const auto value = [&](sdk::VertexId v) { return phi[static_cast<Eigen::Index>(v.index())]; };
  sdk::VertexId tip(0);
  const auto better = [&](sdk::VertexId a, sdk::VertexId b) {
    if (!wanted.at) return value(a) > value(b);
    return (mesh.position(a) - *wanted.at).squaredNorm() < (mesh.position(b) - *wanted.at).squaredNorm();
  };
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    if (better(sdk::VertexId(v), tip)) tip = sdk::VertexId(v);
  // Down from the tip, always to the lowest neighbour.
  sdk::VertexId at = tip;
  while ((mesh.position(at) - mesh.position(tip)).norm() < wanted.below * surface.diagonal) {
    const auto neighbours = surface.adjacency.neighbours(at);
    if (neighbours.empty()) break;
    const auto lowest =
        *std::min_element(neighbours.begin(), neighbours.end(), [&](auto a, auto b) { return value(a) < value(b); });
    if (value(lowest) >= value(at)) break;
    at = lowest;
  }
  const Vector3d up = surface.vertex_normals[at.index()];
  const Vector3d across = up.cross(mesh.position(tip) - mesh.position(at)).stableNormalized();
  std::vector<std::pair<double, sdk::SurfacePoint>> found;
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    const auto& [a, b, c] = mesh.triangles[f];
    const auto [low, high] = std::minmax({value(a), value(b), value(c)});
    if (low > value(at) || high < value(at)) continue;
    const sdk::FaceId face(f);
    const Vector3d middle = (mesh.corner(face, 0) + mesh.corner(face, 1) + mesh.corner(face, 2)) / 3;
    if ((middle - mesh.position(at)).norm() > wanted.below / 2 * surface.diagonal) continue;
    if (sdk::area_vector(mesh, face).dot(up) <= 0) continue;
    found.push_back({middle.dot(across), {face, middle, Vector3d::Constant(1.0 / 3), 0}});
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  // As often as a mouse is asked.
  constexpr std::size_t kPoints = 12;
  std::vector<sdk::SurfacePoint> stroke;
  const std::size_t step = std::max<std::size_t>(1, found.size() / kPoints);
  for (std::size_t i = step / 2; i < found.size(); i += step) stroke.push_back(found[i].second);
  return stroke;
}

sdk::Expected<PartTimes> part_times(const sdk::Mesh& mesh, const PartTip& tip, int rounds, const sdk::Task& task) {
  if (!(sdk::surface_area(mesh) > 0)) return sdk::fail("the mesh has no area: there is nothing to draw on");
  constexpr double kNever = std::numeric_limits<double>::infinity();
  PartTimes best{kNever, kNever, kNever, kNever, 0, kNever};
  const auto keep = [](double& least, double ms) { least = std::min(least, ms); };
  for (int round = 0; round < rounds; ++round) {
    const auto loaded = std::chrono::steady_clock::now();
    auto start = loaded;
    const sdk::Surface surface(mesh);
    keep(best.load_ms, milliseconds_since(start));
    start = std::chrono::steady_clock::now();
    const auto model = sdk::PartModel::build(surface, task);
    if (!model) return tl::unexpected(model.error());
    keep(best.precompute_ms, milliseconds_since(start));
    const double ready_ms = milliseconds_since(loaded);

    const std::vector<sdk::SurfacePoint> stroke = stroke_below(*model, tip);
    start = std::chrono::steady_clock::now();
    sdk::PartCut cut(*model);
    const double begin_ms = milliseconds_since(start);
    std::vector<double> steps;
    for (const sdk::SurfacePoint& point : stroke) {
      start = std::chrono::steady_clock::now();
      cut.add_point(point);
      const auto faces = cut.faces();
      if (!faces) continue;
      steps.push_back(milliseconds_since(start));
      if (steps.size() == 1) keep(best.usable_ms, ready_ms + begin_ms + steps.front());
    }
    const auto part = cut.faces();
    if (!part) return tl::unexpected(part.error());
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    keep(best.step_ms, steps[steps.size() / 2]);

    start = std::chrono::steady_clock::now();
    const auto expansion = sdk::expand_part(*model, *part, {}, task);
    if (!expansion) return tl::unexpected(expansion.error());
    keep(best.expand_ms, milliseconds_since(start));
    best.strokes = expansion->size() + expansion->rejected().size();
  }
  return best;
}

sdk::Mesh horned_ball(int rounds, int horns) {
  sdk::Mesh mesh = icosphere(rounds);
  std::vector<Vector3d> directions;
  for (int i = 0; i < horns; ++i) {
    const double z = 1 - (2.0 * i + 1) / horns;
    const double turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    directions.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  constexpr double kLength = 0.6;
  constexpr double kWidth = 0.1;  // radians
  for (Vector3d& p : mesh.positions) {
    double height = 0;
    for (const Vector3d& direction : directions) {
      const double angle = std::acos(std::clamp(p.dot(direction), -1.0, 1.0));
      height = std::max(height, kLength * std::exp(-std::pow(angle / kWidth, 4)));
    }
    p *= 1 + height;
  }
  return mesh;
}

}  // namespace armature::tools
