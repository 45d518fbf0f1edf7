#pragma once

#include <array>

// The same operations with wider registers where the processor has them: the same results.
// (Programs end before main where the thread sanitizer instruments what chooses between them.)
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define ARMATURE_LANES __attribute__((target_clones("avx2", "default")))
#else
#define ARMATURE_LANES
#endif
/// What ends up within a function that is ARMATURE_LANES.
#define ARMATURE_INLINE [[gnu::always_inline]] inline

namespace armature::sdk {

/// Four numbers side by side.
using Four = double __attribute__((vector_size(32)));
/// The same wherever they are in memory.
using FourAnywhere = double __attribute__((vector_size(32), aligned(8), may_alias));

/// Four rows of four become four columns.
ARMATURE_INLINE void transpose(Four& a, Four& b, Four& c, Four& d) {
  const Four ab_low = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four ab_high = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four cd_low = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Four cd_high = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_low, cd_low, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_high, cd_high, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_low, cd_low, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_high, cd_high, 2, 3, 6, 7);
}

}  // namespace armature::sdk
