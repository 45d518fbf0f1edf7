#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <armature/sdk/error.h>

namespace armature::sdk {

/// What a number of a PLY file is.
enum class PlyType : std::uint8_t { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float32, Float64 };

/// How the numbers of a PLY file are laid out.
enum class PlyEncoding : std::uint8_t { Ascii, LittleEndian, BigEndian };

/// A number, or a list of numbers, of every element of a kind. Names point into the file.
struct PlyProperty {
  std::string_view name;
  PlyType type = PlyType::Float32;
  std::optional<PlyType> count = {};  ///< of a list: the type of its length
};

/// One kind of element.
struct PlyElement {
  std::string_view name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties = {};

  /// The place of the first property with one of these names.
  [[nodiscard]] std::optional<std::size_t> find(std::initializer_list<std::string_view> names) const noexcept;
};

/// What stands before "end_header".
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::Ascii;
  std::vector<PlyElement> elements = {};
  std::size_t bytes = 0;  ///< of the header
  std::size_t lines = 0;  ///< of the header
};

/// How many bytes a binary number has.
[[nodiscard]] std::size_t size_of(PlyType type) noexcept;

/// Reads a header. Counts are below 2^32 - 1; every element has a property.
[[nodiscard]] Expected<PlyHeader> parse_ply_header(std::string_view bytes, std::string_view name);

}  // namespace armature::sdk
