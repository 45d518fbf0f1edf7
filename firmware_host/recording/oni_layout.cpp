#include "firmware_host/recording/oni_layout.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "firmware_host/depth_frame.h"

namespace armature {
namespace {

constexpr std::uint32_t kRecordMark = 0x0052494E;  // "NIR\0"
constexpr std::uint32_t kMaxNodes = 64;
constexpr std::size_t kMaxFieldsBytes = 1 << 20;  // a PrimeSense sensor's shift tables take 30 kB
constexpr std::size_t kMaxNameBytes = 80;         // the player's own limit
constexpr std::uint64_t kMaxFrameBytes = 16 << 20;
constexpr std::uint64_t kMaxTimestamp_us = 1'000'000'000'000'000;  // 31 years: in nanoseconds it still fits 63 bits
constexpr std::size_t kSeekEntryBytes = 20;
constexpr std::uint32_t kDeviceNode = 1;
constexpr std::uint32_t kDepthNode = 2;
constexpr std::uint64_t kDepthInMillimetres = 100;

constexpr std::uint32_t four_letters(const char (&name)[5]) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(name[i]);
  return value;
}

template <class T>
T load(const std::byte* from) noexcept {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

/// The fields of one record, taken from the front.
struct Fields {
  std::span<const std::byte> rest;

  template <class T>
  bool take(T& value) {
    if (rest.size() < sizeof value) return false;
    value = load<T>(rest.data());
    rest = rest.subspan(sizeof value);
    return true;
  }
  bool take_bytes(std::size_t count, std::span<const std::byte>& bytes) {
    if (rest.size() < count) return false;
    bytes = rest.first(count);
    rest = rest.subspan(count);
    return true;
  }
  // Length, then characters that end in a zero. Only ASCII: the player's hash of names has signed characters in it.
  bool take_name(std::string& name) {
    std::uint32_t count = 0;
    std::span<const std::byte> bytes;
    if (!take(count) || count == 0 || count > kMaxNameBytes || !take_bytes(count, bytes)) return false;
    if (bytes.back() != std::byte{0}) return false;
    name.assign(reinterpret_cast<const char*>(bytes.data()));
    return name.size() + 1 == count &&
           std::all_of(name.begin(), name.end(), [](char c) { return c >= 0x20 && c < 0x7f; });
  }
};

struct Node {
  std::uint32_t type = 0;
  std::uint32_t codec = 0;
  std::uint32_t frame_count = 0;
  std::uint32_t last_index = 0;
  std::uint64_t seek_table_offset = 0;
  std::string name;
  bool ready = false;
  bool data_begun = false;
  bool removed = false;
  bool cropping_stated = false;
  bool max_depth_stated = false;
  std::uint64_t required_frame_bytes = 0;
  bool has_seek_table = false;

  [[nodiscard]] bool generator() const { return type == kDepthNode || type == 3 || type == 5; }  // depth, image, IR
};

constexpr std::uint32_t kNotCountedYet = 0xFFFF'FFFF;

/// Holds the walk's state: the failure messages need the place they happened at.
class Walk {
 public:
  Walk(const ReadAt& read_at, std::uint64_t size, std::string_view name)
      : read_at_(read_at), size_(size), name_(name) {}

  Expected<OniLayout> run() {
    if (auto header = read_file_header(); !header) return tl::unexpected(header.error());
    offset_ = kOniFileHeaderBytes;
    for (;;) {
      std::array<std::byte, kOniRecordHeaderBytes> bytes{};
      if (size_ - offset_ < bytes.size() || !read_at_(offset_, bytes)) return unfinished_or_cut_off();
      OniRecordHeader header;
      if (!parse_record_header(bytes, header)) return wrong("expected a record ('NIR')");
      if (header.fields_bytes < kOniRecordHeaderBytes || header.fields_bytes > kMaxFieldsBytes)
        return wrong("a record's fields take " + std::to_string(header.fields_bytes) + " bytes");
      if (header.total_bytes() > size_ - offset_) return unfinished_or_cut_off();
      if (header.total_bytes() > kMaxOniPayloadBytes) return wrong("a record is larger than OpenNI2 can play");
      fields_.resize(header.fields_bytes - kOniRecordHeaderBytes);
      if (!read_at_(offset_ + kOniRecordHeaderBytes, fields_)) return cut_off();
      if (header.type == OniRecordType::End) {
        layout_.end_offset = offset_ + header.total_bytes();
        break;
      }
      if (header.node > max_node_) return wrong("node " + std::to_string(header.node) + " is not one of the file's");
      if (auto record = handle(header); !record) return tl::unexpected(record.error());
      offset_ += header.total_bytes();
    }
    return conclude();
  }

 private:
  tl::unexpected<Error> wrong(const std::string& what) const {
    return fail(name_ + ": corrupt recording: " + what + " at byte " + std::to_string(offset_));
  }
  tl::unexpected<Error> refused(const std::string& what) const { return fail(name_ + ": " + what); }
  tl::unexpected<Error> cut_off() const {
    return fail(name_ + ": truncated recording: it ends at byte " + std::to_string(size_) +
                " without its end record, after " + std::to_string(layout_.frames.size()) + " complete frames");
  }

  /// OpenNI2's recorder writes how many frames there are last: until then it says that nobody knows.
  Expected<OniLayout> unfinished_or_cut_off() {
    if (depth_ == nullptr || depth_->frame_count != kNotCountedYet || layout_.frames.empty()) return cut_off();
    layout_.unfinished = true;
    layout_.end_offset = offset_;
    return conclude();
  }

  Expected<void> read_file_header() {
    std::array<std::byte, kOniFileHeaderBytes> bytes{};
    if (size_ == 0) return refused("not an ONI recording: the file is empty");
    const auto available = std::min<std::uint64_t>(size_, bytes.size());
    if (!read_at_(0, std::span(bytes).first(available))) return refused("cannot be read");
    if (available < 4 || std::memcmp(bytes.data(), "NI10", 4) != 0) {
      std::string found;
      for (std::size_t i = 0; i < std::min<std::size_t>(available, 4); ++i) {
        const auto c = static_cast<unsigned char>(bytes[i]);
        constexpr const char* kHex = "0123456789abcdef";
        if (c >= 0x20 && c < 0x7f)
          found += static_cast<char>(c);
        else
          found += std::string("\\x") + kHex[c >> 4] + kHex[c & 15];
      }
      return refused("not an ONI recording: expected 'NI10' at byte 0, found '" + found + "'");
    }
    if (available < bytes.size()) return cut_off();
    const auto major = static_cast<unsigned>(bytes[4]);
    const auto minor = static_cast<unsigned>(bytes[5]);
    const auto maintenance = load<std::uint16_t>(&bytes[6]);
    const auto build = load<std::uint32_t>(&bytes[8]);
    if (major != 1 || minor != 0 || maintenance != 1 || build != 0)
      return refused("recording format " + std::to_string(major) + "." + std::to_string(minor) + "." +
                     std::to_string(maintenance) + "." + std::to_string(build) + ": expected 1.0.1.0, OpenNI2's own");
    max_timestamp_us_ = load<std::uint64_t>(&bytes[12]);
    max_node_ = load<std::uint32_t>(&bytes[20]);
    if (max_node_ > kMaxNodes) return wrong(std::to_string(max_node_) + " nodes announced");
    return {};
  }

  Expected<void> handle(const OniRecordHeader& header);
  Expected<void> add_node(const OniRecordHeader& header);
  Expected<void> take_property(const OniRecordHeader& header, Node& node);
  Expected<void> take_depth_property(Node& node, const std::string& property, std::span<const std::byte> data);
  Expected<void> take_frame(const OniRecordHeader& header, Node& node);
  Expected<OniLayout> conclude();

  const ReadAt& read_at_;
  std::uint64_t size_;
  std::string name_;
  std::uint64_t offset_ = 0;
  std::uint64_t max_timestamp_us_ = 0;
  std::uint32_t max_node_ = 0;
  std::vector<std::byte> fields_;
  std::map<std::uint32_t, Node> nodes_;
  const Node* depth_ = nullptr;  // one of nodes_
  OniLayout layout_;
};

Expected<void> Walk::handle(const OniRecordHeader& header) {
  const bool may_carry_payload = header.type == OniRecordType::NewData || header.type == OniRecordType::SeekTable;
  if (!may_carry_payload && header.payload_bytes != 0) return wrong("a payload where none belongs");
  if (header.type == OniRecordType::NodeAdded) return add_node(header);

  const auto found = nodes_.find(header.node);
  if (found == nodes_.end()) return wrong("a record of node " + std::to_string(header.node) + ", which was not added");
  Node& node = found->second;
  if (header.type == OniRecordType::SeekTable) {
    if (offset_ != node.seek_table_offset) return {};
    if (header.payload_bytes != (std::uint64_t{node.frame_count} + 1) * kSeekEntryBytes)
      return wrong("a seek table of another number of frames");
    node.has_seek_table = true;
    return {};
  }
  if (node.removed) return wrong("a record of a node that was removed");
  switch (header.type) {
    case OniRecordType::NodeRemoved: node.removed = true; return {};
    case OniRecordType::StateReady:
      // The player makes a node's codec here, from the properties that came before.
      if (node.type == kDepthNode && (layout_.width == 0 || !node.cropping_stated || !node.max_depth_stated))
        return wrong("the depth stream starts without its resolution, cropping and largest depth");
      node.ready = true;
      return {};
    case OniRecordType::DataBegin:
      if (!node.ready || !node.generator() || fields_.size() < 12) return wrong("data begin out of order");
      node.data_begun = true;
      return {};
    case OniRecordType::NewData: return take_frame(header, node);
    case OniRecordType::IntProperty:
    case OniRecordType::RealProperty:
    case OniRecordType::StringProperty:
    case OniRecordType::GeneralProperty: return take_property(header, node);
    default: return wrong("a record of unknown kind " + std::to_string(static_cast<std::uint32_t>(header.type)));
  }
}

Expected<void> Walk::add_node(const OniRecordHeader& header) {
  Fields fields{fields_};
  Node node;
  std::uint64_t min_timestamp = 0;
  std::uint64_t max_timestamp = 0;
  if (!fields.take_name(node.name) || !fields.take(node.type) || !fields.take(node.codec) ||
      !fields.take(node.frame_count) || !fields.take(min_timestamp) || !fields.take(max_timestamp) ||
      !fields.take(node.seek_table_offset))
    return wrong("a node without its name, type and codec");
  for (const auto& [id, other] : nodes_)
    if (id == header.node || other.name == node.name) return wrong("a node is added twice");

  const auto codec_named = [&](const char(&letters)[5]) { return node.codec == four_letters(letters); };
  if (node.type == kDepthNode) {
    if (depth_ != nullptr) return refused("holds two depth streams: expected one");
    if (codec_named("NONE"))
      layout_.codec = DepthCodec::Raw;
    else if (codec_named("16zP"))
      layout_.codec = DepthCodec::Differences;
    else if (codec_named("16zT"))
      layout_.codec = DepthCodec::TableDifferences;
    else
      return refused("the depth stream is in an unknown codec: expected '16zT', '16zP' or 'NONE'");
  } else if (node.generator() && !codec_named("NONE")) {
    return refused("stream '" + node.name + "' is compressed: expected a recording of depth, other streams raw");
  } else if (!node.generator() && node.type != kDeviceNode) {
    return wrong("a node of unknown type " + std::to_string(node.type));
  }
  node.max_depth_stated = layout_.codec != DepthCodec::TableDifferences;
  const auto added = nodes_.emplace(header.node, std::move(node)).first;
  if (added->second.type == kDepthNode) depth_ = &added->second;
  return {};
}

Expected<void> Walk::take_property(const OniRecordHeader& header, Node& node) {
  Fields fields{fields_};
  std::string property;
  std::uint32_t count = 0;
  std::span<const std::byte> data;
  if (!fields.take_name(property) || !fields.take(count) || !fields.take_bytes(count, data) || !fields.rest.empty())
    return wrong("a property whose sizes do not add up");
  const bool number = header.type == OniRecordType::IntProperty || header.type == OniRecordType::RealProperty;
  if (number && data.size() != sizeof(std::uint64_t)) return wrong("a number that is not 8 bytes long");
  if (header.type == OniRecordType::StringProperty && (data.empty() || data.back() != std::byte{0}))
    return wrong("a string without its end");
  // What an older format held instead; the player would read past it.
  if (property == "xnRealWorldTranslationData") return wrong("a property of an older format");
  if (node.type != kDepthNode) {
    // Sizes of streams that nobody opens do not matter, but the player copies these without looking at their length.
    if ((property == "xnFOV" && data.size() != 16) || (property == "xnMapOutputMode" && data.size() != 12))
      return wrong("property " + property + " has the wrong length");
    return {};
  }
  const bool integer = header.type == OniRecordType::IntProperty;
  const bool expects_integer =
      property == "oniPixelFormat" || property == "oniRequiredFrameSize" || property == "xnDeviceMaxDepth";
  const bool expects_bytes = property == "xnMapOutputMode" || property == "xnFOV" || property == "xnCropping";
  if ((expects_integer && !integer) || (expects_bytes && header.type != OniRecordType::GeneralProperty))
    return wrong("property " + property + " is of the wrong kind");
  return take_depth_property(node, property, data);
}

Expected<void> Walk::take_depth_property(Node& node, const std::string& property, std::span<const std::byte> data) {
  if (property == "xnMapOutputMode") {
    if (data.size() != 12) return wrong("property " + property + " has the wrong length");
    const auto width = load<std::uint32_t>(data.data());
    const auto height = load<std::uint32_t>(data.data() + 4);
    const auto fps = load<std::uint32_t>(data.data() + 8);
    if (width == 0 || height == 0 || width > kMaxImageSide || height > kMaxImageSide ||
        std::uint64_t{width} * height * 2 > kMaxOniPayloadBytes)
      return refused("resolution " + std::to_string(width) + " x " + std::to_string(height) +
                     ": expected sides of 1 to 4096 and at most 2880000 pixels");
    if (fps > 10000) return wrong(std::to_string(fps) + " frames per second");
    if (layout_.width != 0 && (layout_.width != static_cast<int>(width) || layout_.height != static_cast<int>(height)))
      return refused("changes its resolution at byte " + std::to_string(offset_) + ": expected one throughout");
    layout_.width = static_cast<int>(width);
    layout_.height = static_cast<int>(height);
    layout_.frames_per_second = static_cast<int>(fps);
  } else if (property == "xnFOV") {
    if (data.size() != 16) return wrong("property " + property + " has the wrong length");
    layout_.horizontal_fov_rad = load<double>(data.data());
    layout_.vertical_fov_rad = load<double>(data.data() + 8);
  } else if (property == "xnCropping") {
    if (data.size() != 12) return wrong("property " + property + " has the wrong length");
    if (load<std::uint32_t>(data.data()) != 0) return refused("holds cropped images: expected whole ones");
    node.cropping_stated = true;
  } else if (property == "oniPixelFormat") {
    if (load<std::uint64_t>(data.data()) != kDepthInMillimetres)
      return refused("depth is in pixel format " + std::to_string(load<std::uint64_t>(data.data())) +
                     ": expected 100, millimetres");
  } else if (property == "oniRequiredFrameSize" || property == "RequiredDataSize") {
    node.required_frame_bytes = load<std::uint64_t>(data.data());
    if (node.required_frame_bytes > kMaxFrameBytes) return wrong("a frame size beyond 16 MiB");
  } else if (property == "xnDeviceMaxDepth") {
    node.max_depth_stated = true;
  }
  return {};
}

Expected<void> Walk::take_frame(const OniRecordHeader& header, Node& node) {
  if (!node.data_begun) return wrong("an image before its stream began");
  Fields fields{fields_};
  OniFrameRecord frame;
  if (!fields.take(frame.timestamp_us) || !fields.take(frame.index) || !fields.rest.empty())
    return wrong("an image whose fields are not 12 bytes long");
  if (header.payload_bytes == 0) return wrong("an empty image");
  if (frame.index <= node.last_index || frame.index > node.frame_count)
    return wrong("image number " + std::to_string(frame.index) + " after " + std::to_string(node.last_index) + " of " +
                 std::to_string(node.frame_count));
  if (frame.timestamp_us > std::min(max_timestamp_us_, kMaxTimestamp_us))
    return wrong("an image later than the recording");
  node.last_index = frame.index;
  if (node.type != kDepthNode) return {};
  frame.payload_offset = offset_ + header.fields_bytes;
  frame.payload_bytes = header.payload_bytes;
  layout_.frames.push_back(frame);
  return {};
}

Expected<OniLayout> Walk::conclude() {
  if (depth_ == nullptr) return refused("holds no depth stream");
  for (const auto& [id, node] : nodes_) {
    if (!node.ready || (node.generator() && !node.data_begun)) return wrong("the file ends before its streams begin");
    if (!layout_.unfinished && node.frame_count > 0 && node.seek_table_offset != 0 && !node.has_seek_table)
      return wrong("the seek table of stream '" + node.name + "' is not where the file says");
  }
  const auto frame_bytes =
      std::uint64_t{2} * static_cast<unsigned>(layout_.width) * static_cast<unsigned>(layout_.height);
  if (depth_->required_frame_bytes != 0 && depth_->required_frame_bytes < frame_bytes)
    return wrong("a frame size smaller than the image");
  if (layout_.frames.empty()) return refused("holds no depth images");
  return std::move(layout_);
}

}  // namespace

bool parse_record_header(std::span<const std::byte, kOniRecordHeaderBytes> bytes, OniRecordHeader& header) noexcept {
  if (load<std::uint32_t>(bytes.data()) != kRecordMark) return false;
  header.type = static_cast<OniRecordType>(load<std::uint32_t>(&bytes[4]));
  header.node = load<std::uint32_t>(&bytes[8]);
  header.fields_bytes = load<std::uint32_t>(&bytes[12]);
  header.payload_bytes = load<std::uint32_t>(&bytes[16]);
  return true;
}

Expected<OniLayout> read_oni_layout(const ReadAt& read_at, std::uint64_t size, std::string_view name) {
  return Walk(read_at, size, name).run();
}

Expected<OniLayout> read_oni_layout(const FileReader& file, std::string_view name) {
  return read_oni_layout([&](std::uint64_t offset, std::span<std::byte> out) { return file.read_at(offset, out); },
                         file.size(), name);
}

}  // namespace armature
