#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_host/error.h"
#include "firmware_host/recording/file_reader.h"

namespace armature {

/// How one depth image is stored: raw 16-bit pixels or one of OpenNI2's lossless codecs.
enum class DepthCodec : std::uint8_t { Raw, Differences, TableDifferences };

/// Where one depth image lies in an `.oni` file.
struct OniFrameRecord {
  std::uint64_t payload_offset = 0;
  std::uint32_t payload_bytes = 0;
  std::uint32_t index = 0;         ///< the recorder's frame number, counted from 1, strictly increasing
  std::uint64_t timestamp_us = 0;  ///< since the first frame
};

/// What an OpenNI2 recording says about its one depth stream.
struct OniLayout {
  int width = 0;
  int height = 0;
  int frames_per_second = 0;
  double horizontal_fov_rad = 0;  ///< 0 where the recording does not say
  double vertical_fov_rad = 0;
  DepthCodec codec = DepthCodec::TableDifferences;
  std::vector<OniFrameRecord> frames;  ///< in the order of the file
  bool unfinished = false;       ///< its recorder was killed: it ends with its last complete frame, and only we play it
  std::uint64_t end_offset = 0;  ///< where the end record ends; OpenNI2's recorder leaves as many zeros behind it
};

/// The largest record OpenNI2's player reads: 1600 x 1200 pixels of 3 bytes. What is larger cannot be replayed.
inline constexpr std::size_t kMaxOniPayloadBytes = std::size_t{1600} * 1200 * 3;

/// Bytes at an offset. False when they are not all there.
using ReadAt = std::function<bool(std::uint64_t offset, std::span<std::byte> out)>;

/// Walks the chain of records of an OpenNI2 recording (format 1.0.1.0) and checks everything that OpenNI2's own player
/// takes on trust: sizes, counts, the order of records, node numbers, the resolution, the codec. A layout that comes
/// back is safe to hand to the player, but for the images themselves, which decode_depth() checks. A recording that
/// was cut off after it was complete, one that is cropped, holds images in lossy compression or two depth streams is
/// refused. `name` opens the message of every failure.
[[nodiscard]] Expected<OniLayout> read_oni_layout(const ReadAt& read_at, std::uint64_t size, std::string_view name);

[[nodiscard]] Expected<OniLayout> read_oni_layout(const FileReader& file, std::string_view name);

/// Kinds of records (the format's own numbers) and the header every one of them opens with.
enum class OniRecordType : std::uint32_t {
  IntProperty = 0x03,
  RealProperty = 0x04,
  StringProperty = 0x05,
  GeneralProperty = 0x06,
  NodeRemoved = 0x07,
  DataBegin = 0x08,
  StateReady = 0x09,
  NewData = 0x0A,
  End = 0x0B,
  NodeAdded = 0x0D,
  SeekTable = 0x0E,
};

struct OniRecordHeader {
  OniRecordType type{};
  std::uint32_t node = 0;
  std::uint32_t fields_bytes = 0;  ///< of header and fields together
  std::uint32_t payload_bytes = 0;

  [[nodiscard]] std::uint64_t total_bytes() const noexcept { return std::uint64_t{fields_bytes} + payload_bytes; }
};

inline constexpr std::size_t kOniFileHeaderBytes = 24;
inline constexpr std::size_t kOniRecordHeaderBytes = 28;

/// The header in `bytes`; false when it does not open with the mark of a record.
[[nodiscard]] bool parse_record_header(std::span<const std::byte, kOniRecordHeaderBytes> bytes,
                                       OniRecordHeader& header) noexcept;

}  // namespace armature
