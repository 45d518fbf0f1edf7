#include "sdk/hierarchy/checksum.h"

#include <array>

namespace armature::sdk {
namespace {

// kTables[k][b]: what byte b followed by k zero bytes leaves. Eight at a time are one step.
constexpr auto kTables = [] {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t rest = byte;
    for (int bit = 0; bit < 8; ++bit) rest = (rest >> 1) ^ ((rest & 1U) != 0 ? 0xEDB8'8320U : 0U);
    tables[0][byte] = rest;
  }
  for (std::size_t k = 1; k < 8; ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xFFU];
  return tables;
}();

}  // namespace

std::uint32_t crc32(std::string_view bytes) noexcept {
  std::uint32_t rest = 0xFFFF'FFFFU;
  const auto byte_at = [&](std::size_t k) { return static_cast<std::uint32_t>(static_cast<std::uint8_t>(bytes[k])); };
  std::size_t k = 0;
  for (; k + 8 <= bytes.size(); k += 8) {
    std::uint32_t next = 0;
    for (std::size_t j = 0; j < 4; ++j) next ^= kTables[7 - j][(byte_at(k + j) ^ (rest >> (8 * j))) & 0xFFU];
    for (std::size_t j = 4; j < 8; ++j) next ^= kTables[7 - j][byte_at(k + j)];
    rest = next;
  }
  for (; k < bytes.size(); ++k) rest = (rest >> 8) ^ kTables[0][(rest ^ byte_at(k)) & 0xFFU];
  return ~rest;
}

}  // namespace armature::sdk
