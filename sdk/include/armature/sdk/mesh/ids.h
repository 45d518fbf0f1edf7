#pragma once

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>

namespace armature::sdk {

/// The place of an element in its array, with a type of its own so that a vertex cannot be taken for a face.
template <class Tag>
class Id {
 public:
  /// Names no element.
  constexpr Id() noexcept = default;
  /// Names the element at `index`, which must be below 2^32 - 1.
  template <std::integral Index>
  constexpr explicit Id(Index index) noexcept : value_(static_cast<std::uint32_t>(index)) {}

  /// The place in the array.
  [[nodiscard]] constexpr std::size_t index() const noexcept { return value_; }
  /// Whether it names an element at all.
  [[nodiscard]] constexpr bool valid() const noexcept { return value_ != kNone; }

  friend constexpr bool operator==(Id, Id) noexcept = default;
  // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 takes the comparison with 0 for one of pointers.
  friend constexpr std::strong_ordering operator<=>(Id, Id) noexcept = default;

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t value_ = kNone;
};

using VertexId = Id<struct VertexTag>;  ///< of a mesh
using EdgeId = Id<struct EdgeTag>;      ///< of a mesh, undirected
using FaceId = Id<struct FaceTag>;      ///< a triangle of a mesh
using SphereId = Id<struct SphereTag>;  ///< of a sphere-mesh

}  // namespace armature::sdk

/// Ids as keys of unordered containers.
template <class Tag>
struct std::hash<armature::sdk::Id<Tag>> {
  /// By the place in the array.
  std::size_t operator()(armature::sdk::Id<Tag> id) const noexcept { return std::hash<std::size_t>{}(id.index()); }
};
