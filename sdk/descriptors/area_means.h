#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <armature/sdk/descriptors/descriptor.h>

namespace armature::sdk {

/// How unlike anything is to what covers nothing.
inline constexpr double kNothingAlike = std::numeric_limits<double>::infinity();
/// Whether two regions, which are written with their areas first, cover something.
[[nodiscard]] inline bool both_cover(std::span<const float> a, std::span<const float> b) noexcept {
  return a[0] > 0 && b[0] > 0;
}

/// Descriptors of which a region's is the mean over its area. A region is written as its area and the integrals over
/// it, which add up.
class AreaMeans : public Descriptor {
 public:
  /// `values` are [V][count], row-major; `areas` [V].
  AreaMeans(std::vector<float> values, std::size_t count, std::span<const double> areas)
      : values_(std::move(values)), count_(count), areas_(areas.begin(), areas.end()) {}

  [[nodiscard]] std::size_t size() const noexcept override { return areas_.size(); }
  [[nodiscard]] std::size_t width() const noexcept override { return 1 + count_; }
  void describe(VertexId vertex, std::span<float> out) const noexcept override {
    std::ranges::fill(out, 0.0F);
    add(out, vertex);
  }
  void add(std::span<float> into, VertexId vertex) const noexcept override {
    const float area = areas_[vertex.index()];
    const auto own = std::span(values_).subspan(vertex.index() * count_, count_);
    into[0] += area;
    for (std::size_t k = 0; k < count_; ++k) into[1 + k] += area * own[k];
  }
  [[nodiscard]] double area(std::span<const float> region) const noexcept override {
    return static_cast<double>(region[0]);
  }
  [[nodiscard]] double area(VertexId vertex) const noexcept override {
    return static_cast<double>(areas_[vertex.index()]);
  }

 protected:
  [[nodiscard]] std::size_t count() const noexcept { return count_; }

 private:
  std::vector<float> values_;
  std::size_t count_;
  std::vector<float> areas_;
};

}  // namespace armature::sdk
