#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <string>

#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// The shortest decimal that reads back as the same number.
template <class Number>
void append_number(std::string& out, Number number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  out.append(text.data(), end);
}

/// Words of one line, a blank between them.
template <class... Numbers>
void append_line(std::string& out, Numbers... numbers) {
  ((append_number(out, numbers), out += ' '), ...);
  out.back() = '\n';
}

/// The number's bytes, the least significant one first.
template <class Number>
void append_binary(std::string& out, Number number) {
  std::array<char, sizeof(Number)> bytes{};
  std::memcpy(bytes.data(), &number, sizeof(Number));
  static_assert(std::endian::native == std::endian::little, "the bytes would have to be swapped");
  out.append(bytes.data(), bytes.size());
}

/// One element of a PLY file, as a line or as bytes.
class PlyRow {
 public:
  PlyRow(std::string& out, bool ascii) : out_(out), ascii_(ascii) {}

  template <class Number>
  void put(Number number) {
    if (!ascii_) return append_binary(out_, number);
    if constexpr (sizeof(Number) == 1)
      append_number(out_, int{number});
    else
      append_number(out_, number);
    out_ += ' ';
  }
  void put(const Colour& colour) {
    for (const std::uint8_t channel : colour) put(channel);
  }
  void end() {
    if (ascii_) out_.back() = '\n';
  }

 private:
  std::string& out_;
  bool ascii_;
};

}  // namespace armature::sdk
