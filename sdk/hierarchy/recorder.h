#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <armature/sdk/hierarchy/hierarchy.h>
#include <armature/sdk/mesh/mesh.h>

#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/mesh/normalised_shape.h"

namespace armature::sdk {

/// Writes down what the collapses do as the parts of a hierarchy.
class Recorder {
 public:
  explicit Recorder(std::size_t vertices);

  /// What a vertex is from the finest level on.
  void pin(std::uint32_t vertex, const Sphere& sphere);
  /// The next collapse: which slots, and the sphere of their union.
  void record(std::uint32_t kept, std::uint32_t gone, const Sphere& sphere);
  /// The slots in use, in ascending order.
  [[nodiscard]] std::vector<std::uint32_t> roots() const;
  /// Takes what the complex knows, once the last collapse is recorded.
  void take(CollapseComplex& complex);
  /// Takes where the steps of collapses that belong together end; none: each is a step of its own.
  void take_steps(std::vector<std::uint32_t> ends) { parts_.steps = std::move(ends); }
  /// Forgets all collapses but the first ones, once everything is taken.
  void keep(std::uint32_t collapses);
  /// After so many collapses, the number of the region that each vertex is in.
  [[nodiscard]] std::vector<std::uint32_t> regions(std::uint32_t collapses) const;
  /// All parts, once everything is taken.
  [[nodiscard]] Hierarchy::Parts finish(const Mesh& mesh, const NormalisedShape& shape);

 private:
  void sort_triangles(const Mesh& mesh);
  void pair_wires();

  Hierarchy::Parts parts_;
  std::vector<std::uint32_t> deaths_;  // by triangle
  std::vector<CollapseComplex::WireEvent> wire_events_;
  std::vector<std::uint32_t> node_in_;  // by slot; kNoIndex once it is gone
};

}  // namespace armature::sdk
