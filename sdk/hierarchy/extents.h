#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace armature::sdk {

/// The directions in which the extent of a region is measured (thesis, section 4.6.3): a half of the 66 vertices of an
/// octahedron subdivided twice, among them the three axes.
inline constexpr std::size_t kDirections = 33;
[[nodiscard]] const std::array<Eigen::Vector3f, kDirections>& half_sphere_directions() noexcept;

/// The extent of a region along every direction, in 65534ths of the unit that the coordinates are normalised to; they
/// must lie within half a unit of the origin. 16 bits halve the memory of floats and eight of them fit a register;
/// what is lost is 1.5e-5 of the model's size.
class Extents {
 public:
  /// Holds nothing.
  Extents() noexcept { values_.fill(kNothing); }

  /// The smallest extent over all directions of the union of two regions; 0 where both are empty.
  [[nodiscard]] friend float smallest_extent(const Extents& left, const Extents& right) noexcept {
#if defined(__SSE2__)
    // hi + lo is unsigned, and SSE2 compares signed: the bias turns one order into the other.
    const __m128i bias = _mm_set1_epi16(std::int16_t(-32768));
    __m128i least = _mm_set1_epi16(32767);
    for (std::size_t k = 0; k < kBlock; k += 8) {
      const __m128i hi = _mm_max_epi16(load(left, k), load(right, k));
      const __m128i lo = _mm_max_epi16(load(left, kBlock + k), load(right, kBlock + k));
      least = _mm_min_epi16(least, _mm_add_epi16(_mm_add_epi16(hi, lo), bias));
    }
    least = _mm_min_epi16(least, _mm_srli_si128(least, 8));
    least = _mm_min_epi16(least, _mm_srli_si128(least, 4));
    least = _mm_min_epi16(least, _mm_srli_si128(least, 2));
    int narrowest = static_cast<std::int16_t>(_mm_extract_epi16(least, 0)) + 32768;
#else
    int narrowest = 65535;
    for (std::size_t k = 0; k < kBlock; ++k) narrowest = std::min(narrowest, extent(left, right, k, kBlock + k));
#endif
    const int last = std::max<int>(left.values_[2 * kBlock], right.values_[2 * kBlock]) +
                     std::max<int>(left.values_[2 * kBlock + 1], right.values_[2 * kBlock + 1]);
    narrowest = std::min(narrowest, last);
    // An empty union's extents wrap; they are told by the axis that was added apart.
    return last < 0 ? 0.0F : static_cast<float>(narrowest) / 65534.0F;
  }

  /// The union.
  Extents& operator|=(const Extents& other) noexcept {
#if defined(__SSE2__)
    for (std::size_t k = 0; k < kSize; k += 8)
      _mm_store_si128(reinterpret_cast<__m128i*>(&values_[k]), _mm_max_epi16(load(*this, k), load(other, k)));
#else
    for (std::size_t k = 0; k < kSize; ++k) values_[k] = std::max(values_[k], other.values_[k]);
#endif
    return *this;
  }

  /// The extents of every vertex's barycentric cell: the vertex, the midpoints of its edges and the centroids of its
  /// triangles. Positions are normalised.
  [[nodiscard]] static std::vector<Extents> of_cells(const std::vector<Eigen::Vector3d>& positions,
                                                     const std::vector<std::array<std::uint32_t, 3>>& triangles);
  /// The extents of discs about points, of these areas; none of a point without area.
  [[nodiscard]] static std::vector<Extents> of_discs(const std::vector<Eigen::Vector3d>& positions,
                                                     const std::vector<Eigen::Vector3d>& normals,
                                                     const std::vector<double>& areas);

 private:
  /// Of one point, by its coordinate along each direction in 65534ths of a unit.
  [[nodiscard]] static Extents of_point(const std::array<float, kDirections>& along) noexcept;

  static constexpr std::size_t kBlock = 32;             // directions that fill whole registers; one is left over
  static constexpr std::size_t kSize = 2 * kBlock + 8;  // highest values, negated lowest, the last of each, nothing
  static constexpr std::int16_t kNothing = -32768;

#if defined(__SSE2__)
  [[nodiscard]] static __m128i load(const Extents& extents, std::size_t k) noexcept {
    return _mm_load_si128(reinterpret_cast<const __m128i*>(&extents.values_[k]));
  }
#else
  [[nodiscard]] static int extent(const Extents& l, const Extents& r, std::size_t hi, std::size_t lo) noexcept {
    return static_cast<std::uint16_t>(std::max(l.values_[hi], r.values_[hi]) + std::max(l.values_[lo], r.values_[lo]));
  }
#endif

  alignas(16) std::array<std::int16_t, kSize> values_;
};

}  // namespace armature::sdk
