#include "sdk/hierarchy/recorder.h"

#include <algorithm>
#include <numeric>

namespace armature::sdk {

namespace {

Hierarchy::PackedSphere packed(const Sphere& sphere) {
  const Eigen::Vector3f centre = sphere.centre.cast<float>();
  return {centre.x(), centre.y(), centre.z(), static_cast<float>(sphere.radius)};
}

}  // namespace

Recorder::Recorder(std::size_t vertices) : node_in_(vertices) {
  parts_.spheres.reserve(vertices);
  parts_.children.reserve(vertices);
  std::iota(node_in_.begin(), node_in_.end(), 0U);
}

void Recorder::pin(std::uint32_t vertex, const Sphere& sphere) {
  parts_.pinned.push_back({vertex, packed(sphere)});
}

void Recorder::record(std::uint32_t kept, std::uint32_t gone, const Sphere& sphere) {
  const auto node = static_cast<std::uint32_t>(node_in_.size() + parts_.children.size());
  parts_.children.push_back({node_in_[kept], node_in_[gone]});
  node_in_[kept] = node;
  node_in_[gone] = kNoIndex;
  parts_.spheres.push_back(packed(sphere));
}

std::vector<std::uint32_t> Recorder::roots() const {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < node_in_.size(); ++slot)
    if (node_in_[slot] != kNoIndex) slots.push_back(slot);
  return slots;
}

void Recorder::take(CollapseComplex& complex) {
  deaths_ = complex.take_deaths();
  wire_events_ = complex.take_wire_events();
}

void Recorder::keep(std::uint32_t collapses) {
  parts_.children.resize(collapses);
  parts_.spheres.resize(collapses);
  for (auto& death : deaths_)
    if (death != CollapseComplex::kNever && death > collapses) death = kNoIndex;
  std::erase_if(wire_events_, [&](const auto& event) { return event.level > collapses; });
}

std::vector<std::uint32_t> Recorder::regions(std::uint32_t collapses) const {
  const std::size_t vertices = node_in_.size();
  std::vector<std::uint32_t> regions(vertices + collapses, kNoIndex);
  std::uint32_t count = 0;
  // Nodes come after what they hold.
  for (std::size_t node = regions.size(); node-- > 0;) {
    if (regions[node] == kNoIndex) regions[node] = count++;
    if (node < vertices) continue;
    for (const std::uint32_t child : parts_.children[node - vertices]) regions[child] = regions[node];
  }
  regions.resize(vertices);
  return regions;
}

Hierarchy::Parts Recorder::finish(const Mesh& mesh, const NormalisedShape& shape) {
  parts_.origin = shape.origin;
  parts_.scale = shape.scale;
  // The hierarchy's axes are the model's.
  const Eigen::Matrix3f back = shape.turn.transpose().cast<float>();
  if (!shape.turn.isIdentity(0)) {
    const auto turn = [&](Hierarchy::PackedSphere& sphere) {
      auto& [x, y, z, radius] = sphere;
      const Eigen::Vector3f centre = back * Eigen::Vector3f(x, y, z);
      x = centre.x();
      y = centre.y();
      z = centre.z();
    };
    for (auto& sphere : parts_.spheres) turn(sphere);
    for (auto& pin : parts_.pinned) turn(pin.sphere);
  }
  std::ranges::sort(parts_.pinned, {}, &Hierarchy::Pinned::vertex);
  parts_.leaves.reserve(mesh.positions.size());
  for (const auto& position : mesh.positions) {
    const Eigen::Vector3f p = ((position - shape.origin) / shape.scale).cast<float>();
    parts_.leaves.push_back({p.x(), p.y(), p.z()});
  }
  sort_triangles(mesh);
  pair_wires();
  return std::move(parts_);
}

void Recorder::sort_triangles(const Mesh& mesh) {
  const std::size_t levels = parts_.children.size() + 1;
  // ends[k]: how many triangles have k as their first level without them; those that stay count at the last place.
  std::vector<std::uint32_t> ends(levels + 1, 0);
  const auto end_of = [&](std::uint32_t death) { return death == kNoIndex ? levels : death; };
  for (const auto death : deaths_)
    if (death != CollapseComplex::kNever) ++ends[end_of(death)];
  // What a level has are those that end after it, which stand before all others.
  parts_.lasting.resize(levels);
  std::uint32_t count = 0;
  for (std::size_t k = levels; k-- > 0;) parts_.lasting[k] = count += ends[k + 1];
  std::vector<std::uint32_t> place(parts_.lasting);
  place.push_back(0);
  parts_.triangles.resize(count);
  for (std::size_t t = 0; t < deaths_.size(); ++t) {
    if (deaths_[t] == CollapseComplex::kNever) continue;
    auto& corners = parts_.triangles[place[end_of(deaths_[t])]++];
    for (std::size_t k = 0; k < 3; ++k) corners[k] = static_cast<std::uint32_t>(mesh.triangles[t][k].index());
  }
}

void Recorder::pair_wires() {
  const auto levels = static_cast<std::uint32_t>(parts_.children.size() + 1);
  std::uint32_t edges = 0;
  for (const auto& event : wire_events_) edges = std::max(edges, event.edge + 1);
  std::vector<std::uint32_t> open(edges, kNoIndex);
  auto& wires = parts_.wire_edges;
  for (const auto& event : wire_events_) {
    if (event.a == kNoIndex) {
      wires[open[event.edge]].last = event.level;
      continue;
    }
    open[event.edge] = static_cast<std::uint32_t>(wires.size());
    wires.push_back({{event.a, event.b}, event.level, levels});
  }
  std::stable_sort(wires.begin(), wires.end(), [](const auto& x, const auto& y) { return x.last > y.last; });
}

}  // namespace armature::sdk
