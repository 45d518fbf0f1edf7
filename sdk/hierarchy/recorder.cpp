#include "sdk/hierarchy/recorder.h"

#include <algorithm>
#include <numeric>

namespace armature::sdk {

Recorder::Recorder(const NormalisedShape& shape) {
  parts_.origin = shape.origin;
  parts_.scale = shape.scale;
  parts_.leaves.reserve(shape.positions.size());
  for (const auto& p : shape.positions)
    parts_.leaves.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  parts_.spheres.reserve(shape.positions.size());
  parts_.children.reserve(shape.positions.size());
  node_in_.resize(shape.positions.size());
  std::iota(node_in_.begin(), node_in_.end(), 0U);
}

void Recorder::record(std::uint32_t kept, std::uint32_t gone, const Sphere& sphere) {
  const auto node = static_cast<std::uint32_t>(parts_.leaves.size() + parts_.children.size());
  parts_.children.push_back({node_in_[kept], node_in_[gone]});
  node_in_[kept] = node;
  node_in_[gone] = kNoIndex;
  const Eigen::Vector3f centre = sphere.centre.cast<float>();
  parts_.spheres.push_back({centre.x(), centre.y(), centre.z(), static_cast<float>(sphere.radius)});
}

std::vector<std::uint32_t> Recorder::roots() const {
  std::vector<std::uint32_t> slots;
  for (std::uint32_t slot = 0; slot < node_in_.size(); ++slot)
    if (node_in_[slot] != kNoIndex) slots.push_back(slot);
  return slots;
}

Hierarchy::Parts Recorder::finish(CollapseComplex& complex, const NormalisedShape& shape) {
  sort_triangles(complex.take_deaths(), shape);
  pair_wires(complex.take_wire_events());
  return std::move(parts_);
}

void Recorder::sort_triangles(const std::vector<std::uint32_t>& deaths, const NormalisedShape& shape) {
  const std::size_t levels = parts_.children.size() + 1;
  // ends[k]: how many triangles have k as their first level without them; those that stay count at the last place.
  std::vector<std::uint32_t> ends(levels + 1, 0);
  const auto end_of = [&](std::uint32_t death) { return death == kNoIndex ? levels : death; };
  for (const auto death : deaths)
    if (death != CollapseComplex::kNever) ++ends[end_of(death)];
  // What a level has are those that end after it, which stand before all others.
  parts_.lasting.resize(levels);
  std::uint32_t count = 0;
  for (std::size_t k = levels; k-- > 0;) parts_.lasting[k] = count += ends[k + 1];
  std::vector<std::uint32_t> place(parts_.lasting);
  place.push_back(0);
  parts_.triangles.resize(count);
  for (std::size_t t = 0; t < deaths.size(); ++t)
    if (deaths[t] != CollapseComplex::kNever) parts_.triangles[place[end_of(deaths[t])]++] = shape.triangles[t];
}

void Recorder::pair_wires(const std::vector<CollapseComplex::WireEvent>& events) {
  const auto levels = static_cast<std::uint32_t>(parts_.children.size() + 1);
  std::uint32_t edges = 0;
  for (const auto& event : events) edges = std::max(edges, event.edge + 1);
  std::vector<std::uint32_t> open(edges, kNoIndex);
  auto& wires = parts_.wire_edges;
  for (const auto& event : events) {
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
