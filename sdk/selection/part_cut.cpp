#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_set>
#include <utility>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/part_cut.h>

#include "sdk/selection/best_isoline.h"
#include "sdk/selection/surface_walk.h"
#include "sdk/selection/trace_isoline.h"

namespace armature::sdk {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

/// The mean normal of the surface within a radius, so that small folds do not matter.
Vector3d normal_around(const Surface& surface, const SurfacePoint& at, double radius) {
  const Mesh& mesh = surface.mesh;
  Vector3d sum = area_vector(mesh, at.face);
  std::vector<FaceId> found = {at.face};
  std::unordered_set<FaceId> seen = {at.face};
  constexpr std::size_t kMost = 500;
  for (std::size_t i = 0; i < found.size() && i < kMost; ++i)
    for (const EdgeId edge : surface.adjacency.edges(found[i]))
      for (const FaceId face : surface.adjacency.faces(edge)) {
        if ((mesh.corner(face, 0) - at.point).norm() > radius || !seen.insert(face).second) continue;
        found.push_back(face);
        sum += area_vector(mesh, face);
      }
  return sum.stableNormalized();
}

/// The neighbour of a vertex that lies farthest along a direction.
VertexId farthest_neighbour(const Surface& surface, VertexId vertex, const Vector3d& direction) {
  const auto neighbours = surface.adjacency.neighbours(vertex);
  return *std::max_element(neighbours.begin(), neighbours.end(), [&](VertexId a, VertexId b) {
    return (surface.mesh.position(a) - surface.mesh.position(b)).dot(direction) < 0;
  });
}

}  // namespace

PartCut::PartCut(const PartModel& model) : model_(&model), factor_(model.factor()), component_(Components::kNone) {
  // Far above the entries of L, far below what would cost the factor its digits.
  constexpr double kWeight = 1e3;
  const auto diagonal = model.laplacian().stiffness.diagonal();
  weight_ = diagonal.size() == 0 ? kWeight : kWeight * std::max(diagonal.mean(), 1.0);
}

void PartCut::begin_stroke() {
  if (!strokes_.empty() && strokes_.back().points.empty()) return;
  strokes_.emplace_back();
}

void PartCut::add_sample(Stroke& stroke, const SurfacePoint& at, const Vector3d& direction) {
  const Surface& surface = model_->surface();
  const double offset = model_->offset(at.face);
  const Vector3d up = normal_around(surface, at, offset);
  const Vector3d leftwards = up.cross(direction).stableNormalized();
  if (leftwards.isZero()) return;
  const auto side = [&](const Vector3d& towards) {
    return closest_corner(surface.mesh, walk(surface.mesh, surface.adjacency, at, towards, up, offset));
  };
  Sample sample{at, side(leftwards), side(-leftwards)};
  if (sample.left == sample.right) sample.right = farthest_neighbour(surface, sample.left, -leftwards);
  if (sample.left == sample.right) return;
  factor_.add_to_diagonal(sample.left, weight_);
  factor_.add_to_diagonal(sample.right, weight_);
  if (field_.size() > 0 && strokes_.size() > 1)
    stroke.lean += (turned_ ? -1 : 1) *
                   (field_[static_cast<Index>(sample.left.index())] - field_[static_cast<Index>(sample.right.index())]);
  stroke.samples.push_back(sample);
  ++stroke.points.back().samples;
}

void PartCut::add_lone_point(Stroke& stroke) {
  // Where it leads is not known: probably along the conformal factor's isoline.
  const SurfacePoint& at = stroke.points.back().at;
  const Eigen::VectorXd& phi = model_->conformal_factor();
  const Triangle& corners = model_->surface().mesh.triangle(at.face);
  double isovalue = 0;
  for (Index k = 0; k < 3; ++k)
    isovalue += at.barycentric[k] * phi[static_cast<Index>(corners[static_cast<std::size_t>(k)].index())];
  constexpr double kReach = 12;
  const double offset = model_->offset(at.face);
  const auto way = spread_along(trace_isoline(model_->surface(), {phi.data(), static_cast<std::size_t>(phi.size())},
                                              at.face, isovalue, kReach * offset),
                                2 * offset, 2 * static_cast<std::size_t>(kReach));
  for (std::size_t i = 1; i < way.size(); ++i) add_sample(stroke, way[i], way[i].point - way[i - 1].point);
  if (stroke.points.back().samples == 0) {
    const Mesh& mesh = model_->surface().mesh;
    add_sample(stroke, at, mesh.corner(at.face, 1) - mesh.corner(at.face, 0));
  }
}

void PartCut::remove_samples(Stroke& stroke, std::size_t count) {
  for (; count > 0; --count) {
    const Sample& sample = stroke.samples.back();
    factor_.add_to_diagonal(sample.left, -weight_);
    factor_.add_to_diagonal(sample.right, -weight_);
    stroke.samples.pop_back();
  }
}

void PartCut::add_point(const SurfacePoint& drawn) {
  const Surface& surface = model_->surface();
  // The model's surface may be a calmer one.
  SurfacePoint point = drawn;
  point.point = Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    point.point += point.barycentric[static_cast<Index>(k)] * surface.mesh.corner(point.face, k);
  const auto component_of = [&](FaceId face) { return model_->components().of_face[face.index()]; };
  if (component_of(point.face) == Components::kNone) return;
  if (component_ == Components::kNone) {
    component_ = component_of(point.face);
    take_component();
  }
  if (component_of(point.face) != component_) return;
  if (strokes_.empty()) strokes_.emplace_back();
  // A stroke leans by the field of those before it.
  if (strokes_.back().points.empty() && strokes_.size() > 1) solve();
  Stroke& stroke = strokes_.back();
  solved_ = false;
  if (stroke.points.empty()) {
    stroke.points.push_back({point});
    add_lone_point(stroke);
    return;
  }
  const SurfacePoint last = stroke.points.back().at;
  const Vector3d way = point.point - last.point;
  if (!(way.norm() > 0)) {
    stroke.points.push_back({point});
    return;
  }
  if (stroke.points.size() == 1) {
    // Now it is.
    remove_samples(stroke, std::exchange(stroke.points.back().samples, 0));
    stroke.lean = 0;
    add_sample(stroke, last, way);
  }
  stroke.points.push_back({point});
  const auto pieces = static_cast<int>(std::min(1e4, std::ceil(way.norm() / (2 * model_->offset(point.face)))));
  SurfacePoint at = last;
  for (int i = 1; i <= pieces; ++i) {
    at = i == pieces ? point : surface.tree.closest(last.point + way * i / pieces, {.hint = at.face});
    if (component_of(at.face) == component_) add_sample(stroke, at, way);
  }
}

void PartCut::take_component() {
  const Mesh& mesh = model_->surface().mesh;
  component_faces_.clear();
  component_vertices_.clear();
  std::vector<bool> seen(mesh.positions.size(), false);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (model_->components().of_face[f] != component_) continue;
    component_faces_.emplace_back(f);
    for (const VertexId vertex : mesh.triangles[f]) seen[vertex.index()] = true;
  }
  for (std::size_t v = 0; v < seen.size(); ++v)
    if (seen[v]) component_vertices_.push_back(static_cast<Index>(v));
}

bool PartCut::undo_point() {
  while (!strokes_.empty() && strokes_.back().points.empty()) strokes_.pop_back();
  if (strokes_.empty()) return false;
  Stroke& stroke = strokes_.back();
  solved_ = false;
  const bool second = stroke.points.size() == 2;
  remove_samples(stroke, stroke.points.back().samples);
  stroke.points.pop_back();
  if (second) {
    remove_samples(stroke, std::exchange(stroke.points.back().samples, 0));
    add_lone_point(stroke);
  }
  if (stroke.points.empty()) strokes_.pop_back();
  if (strokes_.empty()) {
    component_ = Components::kNone;
    factor_.reset();
  }
  return true;
}

void PartCut::swap_sides() {
  swapped_ = !swapped_;
}

void PartCut::solve() {
  if (solved_) return;
  solved_ = true;
  std::vector<SparseFactor::Entry> b;
  for (const Stroke& stroke : strokes_)
    for (const Sample& sample : stroke.samples) b.push_back({stroke.lean < 0 ? sample.right : sample.left, weight_});
  field_ = b.empty() ? Eigen::VectorXd() : Eigen::VectorXd(factor_.solve(b).cwiseMax(0).cwiseMin(1));
  if (field_.size() > 0) choose_cut();
}

void PartCut::choose_cut() {
  const Eigen::VectorXd& mass = model_->laplacian().mass;
  // How area spreads over the field. Isovalues that leave less than half of what lies above 1/2, or below it, go around
  // single constraints rather than around the part.
  constexpr std::size_t kBins = 1U << 13U;
  constexpr std::size_t kMiddle = kBins / 2;
  std::vector<double> area(kBins, 0.0);
  for (const Index v : component_vertices_)
    area[std::min(kBins - 1, static_cast<std::size_t>(field_[v] * kBins))] += mass[v];
  const auto middle = area.begin() + kMiddle;
  const double half_above = std::accumulate(middle, area.end(), 0.0) / 2;
  const double half_below = std::accumulate(area.begin(), middle, 0.0) / 2;
  std::size_t upper = kMiddle;
  for (double passed = 0; upper < kBins - 1 && passed + area[upper] < half_above; ++upper) passed += area[upper];
  std::size_t lower = kMiddle;
  for (double passed = 0; lower > 1 && passed + area[lower - 1] < half_below; --lower) passed += area[lower - 1];
  constexpr double kLeast = 1e-3;
  const CutSearch search{.faces = component_faces_,
                         .lower = std::min(static_cast<double>(lower) / kBins, 0.5 - kLeast),
                         .upper = std::max(static_cast<double>(upper) / kBins, 0.5 + kLeast),
                         .scale = 2 * model_->offset(component_faces_.front())};
  isovalue_ = best_isovalue(model_->surface(), {field_.data(), static_cast<std::size_t>(field_.size())}, search);

  // What protrudes is the part: the conformal factor has mean 0, so its integral is positive on one side. Where that is
  // nearly all, as about a dent, the part is what was cut off.
  constexpr double kNearlyAll = 0.9;
  double integral = 0;
  double above = 0;
  for (const Index v : component_vertices_) {
    if (!(field_[v] > isovalue_)) continue;
    integral += mass[v] * model_->conformal_factor()[v];
    above += mass[v];
  }
  turned_ = integral < 0;
  const double all = std::accumulate(area.begin(), area.end(), 0.0);
  if ((turned_ ? all - above : above) > kNearlyAll * all) turned_ = !turned_;
  if (!turned_) return;
  for (const Index v : component_vertices_) field_[v] = 1 - field_[v];
  isovalue_ = 1 - isovalue_;
}

Expected<std::vector<FaceId>> PartCut::faces() {
  solve();
  if (field_.size() == 0) return fail("no part: the stroke has no point on a face; draw along the cut");
  const Surface& surface = model_->surface();
  std::vector<VertexId> seeds;
  Eigen::VectorXd turned;
  if (swapped_) turned = -field_;
  const Eigen::VectorXd& field = swapped_ ? turned : field_;
  const double isovalue = swapped_ ? -isovalue_ : isovalue_;
  for (const Stroke& stroke : strokes_)
    for (const Sample& sample : stroke.samples)
      for (const VertexId vertex : {sample.left, sample.right})
        if (field[static_cast<Index>(vertex.index())] > isovalue) seeds.push_back(vertex);
  std::vector<FaceId> region = region_above(surface, {field.data(), surface.mesh.positions.size()}, isovalue, seeds);
  if (region.empty() || region.size() == component_faces_.size())
    return fail("no part: no face lies between the stroke and the edge; draw farther from it or swap sides");
  return region;
}

const Eigen::VectorXd& PartCut::field() {
  solve();
  return field_;
}

double PartCut::isovalue() {
  solve();
  return isovalue_;
}

}  // namespace armature::sdk
