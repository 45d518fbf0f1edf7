#pragma once

#include <cstdint>
#include <vector>

#include <armature/sdk/hierarchy/hierarchy.h>

#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/hierarchy/normalised_shape.h"

namespace armature::sdk {

/// Writes down what the collapses do as the parts of a hierarchy.
class Recorder {
 public:
  explicit Recorder(const NormalisedShape& shape);

  /// The next collapse: which slots, and the sphere of their union.
  void record(std::uint32_t kept, std::uint32_t gone, const Sphere& sphere);
  /// The slots in use, in ascending order.
  [[nodiscard]] std::vector<std::uint32_t> roots() const;
  /// All parts, once the last collapse is recorded.
  [[nodiscard]] Hierarchy::Parts finish(CollapseComplex& complex, const NormalisedShape& shape);

 private:
  void sort_triangles(const std::vector<std::uint32_t>& deaths, const NormalisedShape& shape);
  void pair_wires(const std::vector<CollapseComplex::WireEvent>& events);

  Hierarchy::Parts parts_;
  std::vector<std::uint32_t> node_in_;  // by slot; kNoIndex once it is gone
};

}  // namespace armature::sdk
