#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <armature/sdk/decimation/similar_decimation.h>

#include "sdk/decimation/counterparts.h"
#include "sdk/hierarchy/decimation.h"

namespace armature::sdk {

/// Tells which collapses are alike by the descriptors of the regions that they make, and which regions correspond. A
/// region of one vertex has no descriptor of its own here: it is made when it is looked at.
class SimilarRegions final : public SimilarCollapses {
 public:
  /// `correspondence` is that of find_correspondence(); empty, nothing has counterparts.
  SimilarRegions(const Descriptor& descriptor, const Correspondence& correspondence, const SimilarityOptions& options);

  void begin(std::uint32_t a, std::uint32_t b) override;
  void look(std::size_t count) override { looks_ -= std::min(looks_, count); }
  [[nodiscard]] bool ranks() const noexcept override { return options_.adaptive; }
  double dissimilarity(std::uint32_t a, std::uint32_t b) override;
  [[nodiscard]] double threshold(std::span<double> dissimilarities) const override;
  [[nodiscard]] double cost_ratio() const noexcept override { return options_.cost_ratio; }
  [[nodiscard]] std::size_t looks() const noexcept override { return looks_; }
  [[nodiscard]] std::span<const std::uint64_t> kinds() const noexcept override { return counterparts_.kinds(); }
  [[nodiscard]] std::span<const std::uint32_t> slots_like(std::uint32_t slot) const override {
    return counterparts_.like(slot);
  }
  void merged(std::uint32_t kept, std::uint32_t gone) override;
  std::span<const std::uint32_t> behind(std::uint32_t slot, std::size_t& walks) override {
    return counterparts_.behind(slot, walks);
  }
  std::uint32_t holder(std::uint32_t slot) override { return counterparts_.holder(slot); }
  [[nodiscard]] std::uint32_t copy(std::uint32_t slot) const noexcept override { return counterparts_.copy(slot); }
  [[nodiscard]] std::span<const std::uint32_t> copies_like(std::uint32_t copy) const override {
    return counterparts_.copies_like(copy);
  }
  [[nodiscard]] bool joined(std::uint32_t copy) const override { return counterparts_.joined(copy); }
  [[nodiscard]] bool even(std::uint32_t copy) const override { return counterparts_.even(copy); }
  [[nodiscard]] std::uint32_t least(std::uint32_t copy) const override { return counterparts_.least(copy); }
  [[nodiscard]] std::uint32_t surplus(std::uint32_t copy) const override { return counterparts_.surplus(copy); }

 private:
  /// Writes the descriptor of the union of two slots.
  void describe(std::uint32_t a, std::uint32_t b, std::span<float> out);
  void describe(std::uint32_t slot, std::span<float> out) const;
  [[nodiscard]] std::span<float> row(std::size_t place) noexcept {
    return std::span(rows_).subspan(place * width_, width_);
  }

  const Descriptor& descriptor_;
  Counterparts counterparts_;
  SimilarityOptions options_;
  std::size_t width_;
  std::vector<float> rows_;           // of regions that were joined
  std::vector<std::uint32_t> place_;  // by slot: its row; kNoIndex for a vertex alone
  std::vector<std::uint32_t> free_;   // rows that are not in use
  std::vector<float> areas_;          // by slot
  std::vector<float> reference_, other_;
  float area_ = 0;     // of the reference
  std::size_t looks_;  // that may still be taken
};

}  // namespace armature::sdk
