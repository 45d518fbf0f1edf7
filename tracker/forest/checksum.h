#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace armature {

/// CRC-32 as of IEEE 802.3 (reflected, polynomial 0xEDB88320), the one of gzip and PNG.
[[nodiscard]] std::uint32_t crc32(std::span<const std::byte> bytes) noexcept;

}  // namespace armature
