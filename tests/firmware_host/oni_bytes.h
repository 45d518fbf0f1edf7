#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "firmware_host/recording/oni_layout.h"

namespace armature::test {

/// Builds the bytes of an OpenNI2 recording, right or wrong, one record at a time.
class OniBytes {
 public:
  explicit OniBytes(std::uint32_t max_node = 1) {
    bytes = "NI10";
    bytes += std::string("\x01\x00\x01\x00\x00\x00\x00\x00", 8);  // 1.0.1.0
    put(~std::uint64_t{0});                                       // the largest time stamp there may be
    put(max_node);
  }

  /// A number, as it lies in the file.
  template <class T>
  static std::string raw(T value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
  }
  static std::string name(const std::string& text) {
    return raw(static_cast<std::uint32_t>(text.size() + 1)) + text + '\0';
  }

  OniBytes& record(OniRecordType type, std::uint32_t node, const std::string& fields, const std::string& payload = {}) {
    put(std::uint32_t{0x0052494E});
    put(static_cast<std::uint32_t>(type));
    put(node);
    put(static_cast<std::uint32_t>(28 + fields.size()));
    put(static_cast<std::uint32_t>(payload.size()));
    put(std::uint64_t{0});
    bytes += fields + payload;
    return *this;
  }

  OniBytes& node(std::uint32_t id, const std::string& title, std::uint32_t type, const std::string& codec,
                 std::uint32_t frames, std::uint64_t seek_table = 0) {
    return record(OniRecordType::NodeAdded, id,
                  name(title) + raw(type) + codec + raw(frames) + raw(std::uint64_t{0}) + raw(~std::uint64_t{0}) +
                      raw(seek_table));
  }
  OniBytes& integer(const std::string& title, std::uint64_t value, std::uint32_t id = 1) {
    return record(OniRecordType::IntProperty, id, name(title) + raw(std::uint32_t{8}) + raw(value));
  }
  OniBytes& general(const std::string& title, const std::string& data, std::uint32_t id = 1) {
    return record(OniRecordType::GeneralProperty, id,
                  name(title) + raw(static_cast<std::uint32_t>(data.size())) + data);
  }
  OniBytes& mode(std::uint32_t width, std::uint32_t height, std::uint32_t fps = 30) {
    return general("xnMapOutputMode", raw(width) + raw(height) + raw(fps));
  }
  OniBytes& field_of_view(double horizontal = 1.02, double vertical = 0.8) {
    return general("xnFOV", raw(horizontal) + raw(vertical));
  }
  OniBytes& cropping(std::uint32_t enabled = 0) { return general("xnCropping", raw(enabled) + std::string(8, '\0')); }
  OniBytes& begin(std::uint32_t id = 1) {
    record(OniRecordType::StateReady, id, "");
    return record(OniRecordType::DataBegin, id, raw(~std::uint32_t{0}) + raw(~std::uint64_t{0}));
  }
  OniBytes& frame(std::uint32_t index, std::uint64_t timestamp_us, const std::string& payload, std::uint32_t id = 1) {
    return record(OniRecordType::NewData, id, raw(timestamp_us) + raw(index), payload);
  }
  OniBytes& end() { return record(OniRecordType::End, 0, ""); }

  /// All that a depth stream needs before its first image.
  OniBytes& depth_stream(std::uint32_t width, std::uint32_t height, std::uint32_t frames,
                         const std::string& codec = "NONE") {
    node(1, "Depth", 2, codec, frames);
    integer("oniPixelFormat", 100);
    integer("xnDeviceMaxDepth", 10000);
    mode(width, height).field_of_view().cropping();
    return begin();
  }

  [[nodiscard]] Expected<OniLayout> layout() const { return layout_of(bytes); }
  [[nodiscard]] static Expected<OniLayout> layout_of(const std::string& bytes) {
    return read_oni_layout(
        [&](std::uint64_t offset, std::span<std::byte> out) {
          if (offset > bytes.size() || bytes.size() - offset < out.size()) return false;
          if (!out.empty()) std::memcpy(out.data(), bytes.data() + offset, out.size());
          return true;
        },
        bytes.size(), "a.oni");
  }
  /// The message with which the layout is refused; empty when it is not.
  [[nodiscard]] std::string error() const {
    const auto result = layout();
    return result ? "" : result.error().message;
  }

  std::string bytes;

 private:
  template <class T>
  void put(T value) {
    bytes += raw(value);
  }
};

/// Two images of 4 x 2 pixels, 10 fps, not compressed.
inline OniBytes small_recording() {
  OniBytes file;
  file.depth_stream(4, 2, 2);
  file.frame(1, 0, std::string("\x01\x00\x02\x00\x03\x00\x04\x00\x05\x00\x06\x00\x07\x00\x08\x00", 16));
  file.frame(2, 100'000, std::string("\xe8\x03\xe9\x03\xea\x03\xeb\x03\xec\x03\xed\x03\xee\x03\xef\x03", 16));
  file.end();
  return file;
}

}  // namespace armature::test
