#pragma once

#include <cstdint>
#include <string_view>

namespace armature::sdk {

/// CRC-32 as of IEEE 802.3 (reflected, polynomial 0xEDB88320), the one of gzip and PNG.
[[nodiscard]] std::uint32_t crc32(std::string_view bytes) noexcept;

}  // namespace armature::sdk
