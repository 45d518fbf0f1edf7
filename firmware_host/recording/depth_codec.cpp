#include "firmware_host/recording/depth_codec.h"

#include <cstring>

namespace armature {
namespace {

constexpr unsigned kLongValue = 0x0F;  // in half a byte: a seven-bit difference or a whole value follows
constexpr unsigned kPadding = 0x0D;    // in the second half of the last byte of an odd number of differences
constexpr unsigned kRun = 0xE0;        // plus the number of pairs of equal pixels
constexpr unsigned kEscape = 0xFF;     // kLongValue alone

std::uint16_t load16(const std::byte* from) noexcept {
  std::uint16_t value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// The output side: looks values up in the table where there is one.
struct Pixels {
  std::span<std::uint16_t> out;
  const std::byte* table;
  std::size_t table_size;  // 0: values are depths
  std::size_t count = 0;

  bool put(std::uint16_t value) noexcept {
    if (count == out.size()) return false;
    if (table_size != 0) {
      if (value >= table_size) return false;
      value = load16(table + std::size_t{2} * value);
    }
    out[count++] = value;
    return true;
  }
};

bool decode_differences(std::span<const std::byte> in, Pixels pixels) noexcept {
  if (in.size() < 2) return false;
  std::uint16_t value = load16(in.data());
  if (!pixels.put(value)) return false;
  std::size_t at = 2;

  const auto long_value = [&]() noexcept {
    if (at == in.size()) return false;
    const auto first = std::to_integer<unsigned>(in[at++]);
    if ((first & 0x80) != 0) {
      value = static_cast<std::uint16_t>(value - (first - 192));
    } else {
      if (at == in.size()) return false;
      value = static_cast<std::uint16_t>(first << 8 | std::to_integer<unsigned>(in[at++]));
    }
    return pixels.put(value);
  };
  const auto difference = [&](unsigned half) noexcept {
    value = static_cast<std::uint16_t>(value - (half - 6));
    return pixels.put(value);
  };

  while (at < in.size()) {
    const auto byte = std::to_integer<unsigned>(in[at++]);
    if (byte == kEscape) {
      if (!long_value()) return false;
    } else if (byte >= kRun) {
      for (unsigned i = 0; i < 2 * (byte - kRun); ++i)
        if (!pixels.put(value)) return false;
    } else {
      const unsigned second = byte & 0x0F;
      if (!difference(byte >> 4)) return false;
      if (second == kLongValue) {
        if (!long_value()) return false;
      } else if (second != kPadding) {
        if (!difference(second)) return false;
      }
    }
  }
  return pixels.count == pixels.out.size();
}

}  // namespace

bool decode_depth(DepthCodec codec, std::span<const std::byte> payload, std::span<std::uint16_t> depth_mm) noexcept {
  switch (codec) {
    case DepthCodec::Raw:
      if (payload.size() != depth_mm.size_bytes()) return false;
      if (!payload.empty()) std::memcpy(depth_mm.data(), payload.data(), payload.size());
      return true;
    case DepthCodec::Differences: return decode_differences(payload, {depth_mm, nullptr, 0});
    case DepthCodec::TableDifferences: {
      if (payload.size() < 2) return false;
      const std::size_t table_size = load16(payload.data());
      if (table_size == 0 || payload.size() - 2 < 2 * table_size) return false;
      return decode_differences(payload.subspan(2 + 2 * table_size), {depth_mm, payload.data() + 2, table_size});
    }
  }
  return false;
}

}  // namespace armature
