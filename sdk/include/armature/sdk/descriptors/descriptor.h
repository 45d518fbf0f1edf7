#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// What tells regions of a shape apart, by three operations (thesis, section 6.3.1): what is computed for every vertex,
/// how two regions' descriptors make that of their union, and how unlike two regions are. Every descriptor is `width()`
/// numbers. Immutable; any number of threads may use it.
class Descriptor {
 public:
  virtual ~Descriptor() = default;
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  /// How many vertices there are.
  [[nodiscard]] virtual std::size_t size() const noexcept = 0;
  /// How many numbers describe a region.
  [[nodiscard]] virtual std::size_t width() const noexcept = 0;
  /// Per-vertex computation: writes the descriptor of a vertex alone.
  virtual void describe(VertexId vertex, std::span<float> out) const noexcept = 0;
  /// Aggregation: makes `into` the descriptor of its region and that of `other` together.
  virtual void aggregate(std::span<float> into, std::span<const float> other) const noexcept;
  /// The same with a vertex alone.
  virtual void add(std::span<float> into, VertexId vertex) const noexcept = 0;
  /// How unlike two regions are, 0 for the same; 1 is nothing in common where it has a bound. Where that is `limit` or
  /// more, any number from `limit` on may be returned.
  [[nodiscard]] virtual double dissimilarity(std::span<const float> a, std::span<const float> b,
                                             double limit) const noexcept = 0;
  /// The area that a region covers, in the square of the model's unit.
  [[nodiscard]] virtual double area(std::span<const float> region) const noexcept = 0;
  /// The area that a vertex covers.
  [[nodiscard]] virtual double area(VertexId vertex) const noexcept = 0;

 protected:
  Descriptor() = default;
};

/// How unlike every vertex is to the region that `reference` makes, [V]. Uses all cores. Refused for no vertices, or
/// vertices that are not there.
[[nodiscard]] Expected<std::vector<float>> dissimilarities(const Descriptor& descriptor,
                                                           std::span<const VertexId> reference, const Task& task = {});

/// The similarity map of dissimilarities d: exp(-d^2 / 2 sigma^2), with sigma the value that the most alike `share` of
/// the vertices stay below; in [0, 1], 1 at what is the same. `share` lies in (0, 1].
[[nodiscard]] std::vector<float> similarity_map(std::span<const float> dissimilarities, double share = 0.05);

}  // namespace armature::sdk
