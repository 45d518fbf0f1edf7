#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "firmware_host/recording/oni_layout.h"

namespace armature {

/// Decodes one depth image of a recording as OpenNI2's player does, but checks what the player takes on trust: no read
/// past the end of `payload`, no write past the end of `depth_mm`, no index past the end of the table. False when the
/// payload is corrupt or does not hold exactly depth_mm.size() pixels. The codecs: the first pixel whole, then
/// differences of half a byte, seven bits, or a whole value of 15 bits, and runs of equal pairs; TableDifferences codes
/// the positions in a table of the depths that occur.
[[nodiscard]] bool decode_depth(DepthCodec codec, std::span<const std::byte> payload,
                                std::span<std::uint16_t> depth_mm) noexcept;

}  // namespace armature
