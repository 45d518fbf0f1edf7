#include "sdk/expansion/spread_context.h"

#include <cassert>

namespace armature::sdk {

PatchContext spread(std::span<const float> context) noexcept {
  constexpr std::size_t kWidth = PatchContexts::kAngles;
  constexpr std::size_t kHeight = PatchContexts::kDistances;
  assert(context.size() == kWidth * kHeight);
  PatchContext across{};
  for (std::size_t row = 0; row < kHeight; ++row) {
    const auto from = context.subspan(row * kWidth, kWidth);
    float* const to = across.data() + row * kWidth;
    to[0] = 0.75F * from[0] + 0.25F * from[1];
    for (std::size_t i = 1; i + 1 < kWidth; ++i) to[i] = 0.5F * from[i] + 0.25F * (from[i - 1] + from[i + 1]);
    to[kWidth - 1] = 0.75F * from[kWidth - 1] + 0.25F * from[kWidth - 2];
  }
  PatchContext result{};
  for (std::size_t row = 0; row < kHeight; ++row) {
    const float* const before = across.data() + (row > 0 ? row - 1 : row) * kWidth;
    const float* const here = across.data() + row * kWidth;
    const float* const after = across.data() + (row + 1 < kHeight ? row + 1 : row) * kWidth;
    for (std::size_t i = 0; i < kWidth; ++i) result[row * kWidth + i] = 0.5F * here[i] + 0.25F * (before[i] + after[i]);
  }
  return result;
}

}  // namespace armature::sdk
