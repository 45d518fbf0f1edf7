#include <algorithm>
#include <memory>
#include <utility>

#include <armature/sdk/deformation/session.h>

#include "sdk/deformation/in_range.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using ColumnPointer = std::shared_ptr<const WeightColumn>;

/// What is left of a sphere's weights without those of a part of it.
ColumnPointer without(const WeightColumn& whole, const WeightColumn& part) {
  auto rest = std::make_shared<WeightColumn>();
  std::size_t k = 0;
  for (std::size_t i = 0; i < whole.vertices.size(); ++i) {
    while (k < part.vertices.size() && part.vertices[k] < whole.vertices[i]) ++k;
    const bool shared = k < part.vertices.size() && part.vertices[k] == whole.vertices[i];
    const float weight = whole.weights[i] - (shared ? part.weights[k] : 0);
    if (!(weight > 0)) continue;
    rest->vertices.push_back(whole.vertices[i]);
    rest->weights.push_back(weight);
  }
  return rest;
}

bool holds(const std::array<std::uint32_t, 2>& range, const std::array<std::uint32_t, 2>& other) {
  return range[0] <= other[0] && other[1] <= range[1];
}

}  // namespace

Expected<DeformationSession> DeformationSession::start(const Mesh& mesh, const Hierarchy& hierarchy,
                                                       std::size_t spheres, const DeformOptions& options,
                                                       const Task& task) {
  if (const auto same = check_same(mesh, hierarchy); !same) return tl::unexpected(same.error());
  auto diffusion = HeatDiffusion::of(mesh, options.heat, task);
  if (!diffusion) return tl::unexpected(diffusion.error());
  DeformationSession session(hierarchy, std::move(*diffusion), mesh, options);
  if (const auto there = session.go_to(spheres); !there) return tl::unexpected(there.error());
  return session;
}

DeformationSession::DeformationSession(const Hierarchy& hierarchy, HeatDiffusion diffusion, const Mesh& mesh,
                                       DeformOptions options)
    : mesh_(&mesh),
      hierarchy_(&hierarchy),
      diffusion_(std::make_unique<const HeatDiffusion>(std::move(diffusion))),
      options_(options),
      refit_(mesh, hierarchy),
      weights_(*diffusion_, hierarchy),
      level_({.columns = {}, .totals = std::vector<double>(mesh.positions.size(), 1.0)}, {}, mesh),
      positions_(mesh.positions) {}

Expected<void> DeformationSession::check_level(std::size_t spheres) const {
  if (spheres < hierarchy_->min_spheres() || spheres > hierarchy_->leaf_count())
    return fail("expected " + std::to_string(hierarchy_->min_spheres()) + " to " +
                std::to_string(hierarchy_->leaf_count()) + " spheres, found " + std::to_string(spheres));
  return {};
}

Expected<void> DeformationSession::go_to(std::size_t spheres) {
  if (auto checked = check_level(spheres); !checked) return checked;
  cancel();
  show_level(spheres);
  return {};
}

void DeformationSession::show_level(std::size_t spheres) {
  nodes_ = hierarchy_->nodes_of_level(spheres);
  shape_ = *hierarchy_->level(spheres);
  fit();
  weigh();
}

void DeformationSession::fit() {
  std::vector<bool> wanted(nodes_.size());
  for (std::size_t s = 0; s < nodes_.size(); ++s) wanted[s] = !fits_.contains(nodes_[s]);
  const auto fitted = refit_.fit(nodes_, level_.mesh().positions, wanted);
  std::unordered_map<NodeId, FittedSphere> fits;
  for (std::size_t s = 0; s < nodes_.size(); ++s) {
    const FittedSphere& fit = wanted[s] ? fitted[s] : fits_.at(nodes_[s]);
    fits.emplace(nodes_[s], fit);
    shape_.spheres[s] = fit.sphere;
  }
  fits_ = std::move(fits);
}

void DeformationSession::weigh() {
  surface_.reset();
  held_.assign(nodes_.size(), false);
  for (std::size_t s = 0; s < nodes_.size(); ++s)
    held_[s] = std::ranges::any_of(
        pinned_, [&](NodeId pin) { return holds(hierarchy_->range(pin), hierarchy_->range(nodes_[s])); });
  level_.set_level(weights_around_pins(), shape_);
}

SkinWeights DeformationSession::weights_around_pins() {
  SkinWeights skin = options_.weights == WeightSource::Clusters
                         ? weights_.of(nodes_)
                         : closest_primitive_weights(*diffusion_, *hierarchy_, *mesh_, nodes_.size());
  // A pinned part of a sphere weighs on its own; it never moves.
  for (const NodeId pin : pinned_)
    for (std::size_t s = 0; s < nodes_.size(); ++s)
      if (pin != nodes_[s] && holds(hierarchy_->range(nodes_[s]), hierarchy_->range(pin)))
        skin.columns[s] = without(*skin.columns[s], *weights_.of(pin));
  return skin;
}

SphereMove DeformationSession::in_model(const SphereMove& move, MoveFrame frame) const {
  if (frame == MoveFrame::Model || move.spheres.empty()) return move;
  std::array<std::uint32_t, 2> all = hierarchy_->range(nodes_[move.spheres[0].index()]);
  for (const SphereId sphere : move.spheres) {
    const auto range = hierarchy_->range(nodes_[sphere.index()]);
    all = {std::min(all[0], range[0]), std::max(all[1], range[1])};
  }
  NodeId above = nodes_[move.spheres[0].index()];
  do {
    const NodeId next = hierarchy_->parent(above);
    if (!next.valid()) break;
    above = next;
  } while (!holds(hierarchy_->range(above), all));
  const RegionFrame region = refit_.frame(above, level_.mesh().positions);
  SphereMove moved = move;
  moved.translate = region.scale * (region.turn * move.translate);
  moved.rotate = region.turn * move.rotate;
  if (move.about) moved.about = region(*move.about);
  if (move.radius) moved.radius = region.scale * *move.radius;
  return moved;
}

Expected<void> DeformationSession::preview(const SphereMove& move, const MoveOptions& options) {
  if (const auto checked = check(move, nodes_.size()); !checked) {
    cancel();
    return checked;
  }
  previewed_ = Step{.level = nodes_.size(), .move = move, .options = options};
  auto motions = at_rest(level_.shape().spheres);
  move_spheres(in_model(move, options.frame), motions, held_);
  const bool keep = options_.keep_volume && options.surface_rings == 0;
  level_.move(motions, options_.blend, positions_, keep ? Volume::KeptByTurns : Volume::Free);
  if (options.surface_rings > 0)
    if (const auto moved = move_surface(move, motions, options.surface_rings); !moved) {
      cancel();
      return moved;
    }
  if (!std::ranges::all_of(positions_, in_range)) {
    cancel();
    return fail("the move takes vertices out of range; use smaller numbers");
  }
  for (std::size_t s = 0; s < motions.size(); ++s) shape_.spheres[s] = motions[s].after;
  return {};
}

Expected<void> DeformationSession::move_surface(const SphereMove& move, std::span<const SphereMotion> motions,
                                                std::size_t rings) {
  std::vector<bool> moves(nodes_.size(), false);
  for (const SphereId sphere : move.spheres) moves[sphere.index()] = !held_[sphere.index()];
  std::vector<bool> near = moves;
  for (std::size_t ring = 0; ring < rings; ++ring) {
    std::vector<bool> wider = near;
    const auto join = [&](SphereId a, SphereId b) {
      if (near[a.index()]) wider[b.index()] = true;
      if (near[b.index()]) wider[a.index()] = true;
    };
    for (const auto& [a, b] : shape_.edges) join(a, b);
    for (const auto& [a, b, c] : shape_.triangles) join(a, b), join(b, c), join(c, a);
    if (wider == near) break;
    near = std::move(wider);
  }
  std::vector<bool> free(nodes_.size());
  for (std::size_t s = 0; s < free.size(); ++s) free[s] = near[s] && !moves[s] && !held_[s];
  const auto& rest = level_.mesh().positions;
  const auto is_pinned = [&](VertexId vertex) {
    const std::uint32_t place = hierarchy_->place(vertex);
    return std::ranges::any_of(pinned_, [&](NodeId pin) { return holds(hierarchy_->range(pin), {place, place + 1}); });
  };
  std::vector<bool> is_free(rest.size(), false);
  for (std::size_t s = 0; s < nodes_.size(); ++s) {
    SphereMotion motion = motions[s];
    if (motion.before.radius > 0 && motion.after.radius > 0) motion.scale = motion.after.radius / motion.before.radius;
    for (const VertexId vertex : hierarchy_->vertices(nodes_[s])) {
      const bool stays = (!moves[s] && !free[s]) || is_pinned(vertex);
      is_free[vertex.index()] = free[s] && !stays;
      if (!free[s] || stays) positions_[vertex.index()] = stays ? rest[vertex.index()] : motion(rest[vertex.index()]);
    }
  }
  if (!laplacian_) laplacian_ = laplacian(level_.mesh(), Adjacency(level_.mesh()));
  if (!surface_ || surface_->free != free) {
    auto solver = AsRigidAsPossible::of(*laplacian_, rest, is_free);
    if (!solver) return tl::unexpected(solver.error());
    surface_.emplace(Surface{std::move(free), std::move(*solver)});
  }
  surface_->solver.solve(positions_);
  return {};
}

void DeformationSession::cancel() {
  if (!previewed_) return;
  shape_.spheres = level_.shape().spheres;
  positions_ = level_.mesh().positions;
  previewed_.reset();
}

void DeformationSession::commit() {
  if (!previewed_) return;
  Step step = std::move(*previewed_);
  previewed_.reset();
  const auto& before = level_.mesh().positions;
  for (std::size_t v = 0; v < before.size(); ++v)
    if (positions_[v] != before[v]) {
      step.changed.emplace_back(v);
      step.others.push_back(positions_[v]);
    }
  step_over(step, true);
  done_.push_back(std::move(step));
  undone_.clear();
}

Expected<void> DeformationSession::move(const SphereMove& move, const MoveOptions& options) {
  return preview(move, options).map([&] { commit(); });
}

Expected<void> DeformationSession::pin(std::span<const SphereId> spheres, bool pinned) {
  SphereMove named{.spheres = {spheres.begin(), spheres.end()}};
  if (const auto checked = check(named, nodes_.size()); !checked) return checked;
  cancel();
  Step step{.level = nodes_.size(), .move = std::move(named), .pins = pinned};
  for (const SphereId sphere : spheres)
    if (pinned_.contains(nodes_[sphere.index()]) != pinned) step.nodes.push_back(nodes_[sphere.index()]);
  step_over(step, true);
  done_.push_back(std::move(step));
  undone_.clear();
  return {};
}

void DeformationSession::swap_over(Step& step, bool forward) {
  for (const NodeId node : step.nodes) {
    if (*step.pins == forward)
      pinned_.insert(node);
    else
      pinned_.erase(node);
  }
  for (std::size_t i = 0; i < step.changed.size(); ++i) std::swap(positions_[step.changed[i].index()], step.others[i]);
}

/// Goes back to so many steps, and to a level; nothing can be done again of them. Spheres are fitted once.
void DeformationSession::take_back(std::size_t steps, std::size_t level) {
  positions_ = level_.mesh().positions;
  for (; done_.size() > steps; done_.pop_back()) swap_over(done_.back(), false);
  fits_.clear();
  std::vector<Vector3d> rest = positions_;
  level_.set_rest(rest, level_.shape().spheres);
  show_level(level);
}

void DeformationSession::step_over(Step& step, bool forward) {
  positions_ = level_.mesh().positions;
  swap_over(step, forward);
  if (step.pins) return weigh();
  surface_.reset();
  fits_.clear();
  std::vector<Vector3d> rest = positions_;
  level_.set_rest(rest, level_.shape().spheres);
  fit();
  level_.set_rest(rest = positions_, shape_.spheres);
}

bool DeformationSession::undo() {
  cancel();
  if (done_.empty()) return false;
  step_over(done_.back(), false);
  undone_.push_back(std::move(done_.back()));
  done_.pop_back();
  return true;
}

bool DeformationSession::redo() {
  cancel();
  if (undone_.empty()) return false;
  step_over(undone_.back(), true);
  done_.push_back(std::move(undone_.back()));
  undone_.pop_back();
  return true;
}

}  // namespace armature::sdk
