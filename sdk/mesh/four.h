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
/// The same wherever they are in memory. (Written behind the `=`, clang forgets the alignment of what is const.)
using FourAnywhere [[gnu::aligned(8), gnu::may_alias]] = Four;

/// Half as precise.
using FourFloats = float __attribute__((vector_size(16)));
using FourFloatsAnywhere [[gnu::aligned(4), gnu::may_alias]] = FourFloats;

/// Four rows of four become four columns.
template <class Four>
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

/// Four vectors side by side.
struct FourVectors {
  Four x, y, z;
};
template <class Vector>
ARMATURE_INLINE FourVectors four_vectors(const Vector& a, const Vector& b, const Vector& c, const Vector& d) {
  return {Four{a.x(), b.x(), c.x(), d.x()}, Four{a.y(), b.y(), c.y(), d.y()}, Four{a.z(), b.z(), c.z(), d.z()}};
}
ARMATURE_INLINE FourVectors operator+(const FourVectors& a, const FourVectors& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
ARMATURE_INLINE FourVectors operator-(const FourVectors& a, const FourVectors& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
ARMATURE_INLINE FourVectors operator*(const Four& by, const FourVectors& v) {
  return {by * v.x, by * v.y, by * v.z};
}
ARMATURE_INLINE FourVectors cross(const FourVectors& a, const FourVectors& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// Adds four scalar products.
ARMATURE_INLINE void add_dot(const FourVectors& a, const FourVectors& b, Four& sum) {
  sum += a.x * b.x + a.y * b.y + a.z * b.z;
}

}  // namespace armature::sdk
