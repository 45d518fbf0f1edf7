#pragma once

#include <array>
#include <cstddef>

#include "sdk/mesh/four.h"

namespace armature::sdk {

/// A vertex and a direction, which need not be as precise: side by side, as whoever asks for one asks for both.
struct DirectedVertex {
  std::array<double, 3> position;
  std::array<float, 4> direction;  ///< x y z 0
};
static_assert(sizeof(DirectedVertex) == 3 * sizeof(double) + sizeof(FourFloats));

/// Directions of four vertices, as precise.
struct FourDirections {
  FourFloats x, y, z;

  FourDirections() = default;
  ARMATURE_INLINE explicit FourDirections(const FourVectors& v)
      : x(__builtin_convertvector(v.x, FourFloats)),
        y(__builtin_convertvector(v.y, FourFloats)),
        z(__builtin_convertvector(v.z, FourFloats)) {}
  [[nodiscard]] ARMATURE_INLINE FourVectors vectors() const {
    // One by one becomes one instruction; __builtin_convertvector() goes by way of memory.
    return {Four{double{x[0]}, double{x[1]}, double{x[2]}, double{x[3]}},
            Four{double{y[0]}, double{y[1]}, double{y[2]}, double{y[3]}},
            Four{double{z[0]}, double{z[1]}, double{z[2]}, double{z[3]}}};
  }
};

/// Four vertices and their directions.
struct FourDirectedVertices {
  FourVectors positions, directions;

  /// Wherever they are.
  ARMATURE_INLINE static FourDirectedVertices of(const DirectedVertex& a, const DirectedVertex& b,
                                                 const DirectedVertex& c, const DirectedVertex& d) {
    // Four numbers are read where three are wanted: the fourth is a part of the direction, and goes nowhere.
    Four x = reinterpret_cast<const FourAnywhere&>(a), y = reinterpret_cast<const FourAnywhere&>(b),
         z = reinterpret_cast<const FourAnywhere&>(c), none = reinterpret_cast<const FourAnywhere&>(d);
    transpose(x, y, z, none);
    FourDirections to;
    to.x = reinterpret_cast<const FourFloatsAnywhere&>(a.direction);
    to.y = reinterpret_cast<const FourFloatsAnywhere&>(b.direction);
    to.z = reinterpret_cast<const FourFloatsAnywhere&>(c.direction);
    FourFloats zeros = reinterpret_cast<const FourFloatsAnywhere&>(d.direction);
    transpose(to.x, to.y, to.z, zeros);
    return {{x, y, z}, to.vectors()};
  }

  /// One behind the other.
  ARMATURE_INLINE void store(DirectedVertex* out) const {
    std::array<Four, 4> at{positions.x, positions.y, positions.z, Four{}};
    transpose(at[0], at[1], at[2], at[3]);
    const FourDirections rounded(directions);
    std::array<FourFloats, 4> to{rounded.x, rounded.y, rounded.z, FourFloats{}};
    transpose(to[0], to[1], to[2], to[3]);
    for (std::size_t k = 0; k < 4; ++k) {
      reinterpret_cast<FourAnywhere&>(out[k]) = at[k];
      reinterpret_cast<FourFloatsAnywhere&>(out[k].direction) = to[k];
    }
  }
};

}  // namespace armature::sdk
