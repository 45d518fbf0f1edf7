#include <array>
#include <bit>
#include <cstring>

#include <armature/sdk/hierarchy/hierarchy_file.h>

#include "sdk/hierarchy/checksum.h"
#include "sdk/io/encode.h"
#include "sdk/io/file_bytes.h"

// A file is, little-endian:
//   8 bytes   89 'S' 'M' 'H' 0D 0A 1A 0A
//   u32       version
//   u32       CRC-32 of all that follows
//   u64       how many bytes follow
//   u32 x 5   vertices, collapses, triangles, wire edges, pinned vertices
//   f64 x 4   origin, scale
//   f32 x 3   by vertex: its centre
//   f32 x 4   by collapse: centre and radius of its sphere
//   u32, f32 x 4  by pinned vertex, ascending: which, and centre and radius of its sphere
// and then numbers in groups of seven bits, the lowest first, the eighth bit set on all but a number's last byte:
//   2 by collapse k       vertices + k - 1 - child
//   1 by level but the last: triangles that it has and the next has not
//   3 by triangle         its vertices
//   4 by wire edge        its vertices, its first level, levels from there to its last
// and, of a hierarchy whose collapses are done together in steps:
//   1 how many steps, and by step how many collapses it has
// Vertices are written as their difference to the one before in the same list, folded: 0, -1, 1, -2...
namespace armature::sdk {
namespace {

constexpr std::array<char, 8> kMagic{'\x89', 'S', 'M', 'H', '\r', '\n', '\x1a', '\n'};
constexpr std::size_t kHeaderBytes = kMagic.size() + 4 + 4 + 8;

void append_varint(std::string& out, std::uint32_t value) {
  for (; value >= 0x80; value >>= 7) out += static_cast<char>(value | 0x80U);
  out += static_cast<char>(value);
}

/// Vertices, each as its difference to the one before.
class DeltaWriter {
 public:
  explicit DeltaWriter(std::string& out) : out_(out) {}
  void put(std::uint32_t value) {
    const auto delta = static_cast<std::int32_t>(value - last_);
    append_varint(out_, (static_cast<std::uint32_t>(delta) << 1) ^ static_cast<std::uint32_t>(delta >> 31));
    last_ = value;
  }

 private:
  std::string& out_;
  std::uint32_t last_ = 0;
};

/// Reads what the writers wrote; past the end, or at a number that does not fit, it fails and stays failed.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size(); }

  template <class Number>
  Number get() noexcept {
    Number number{};
    if (bytes_.size() < sizeof(Number)) {
      ok_ = false;
      return number;
    }
    static_assert(std::endian::native == std::endian::little, "the bytes would have to be swapped");
    std::memcpy(&number, bytes_.data(), sizeof(Number));
    bytes_.remove_prefix(sizeof(Number));
    return number;
  }
  std::uint32_t varint() noexcept {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 35; shift += 7) {
      const auto byte = get<std::uint8_t>();
      value |= std::uint64_t{byte & 0x7FU} << shift;
      if (byte < 0x80) {
        ok_ = ok_ && value <= 0xFFFF'FFFFU;
        return static_cast<std::uint32_t>(value);
      }
    }
    ok_ = false;
    return 0;
  }
  std::uint32_t delta(std::uint32_t& last) noexcept {
    const std::uint32_t folded = varint();
    return last += (folded >> 1) ^ (~(folded & 1) + 1);
  }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

/// The parts behind the header; what they say is checked when they are assembled.
Expected<Hierarchy::Parts> parse_parts(Reader in, std::string_view name) {
  std::array<std::uint32_t, 5> counts{};
  for (auto& count : counts) count = in.get<std::uint32_t>();
  const auto [vertices, collapses, triangles, wires, pins] = counts;
  Hierarchy::Parts parts;
  for (double& coordinate : parts.origin) coordinate = in.get<double>();
  parts.scale = in.get<double>();
  // Every number takes a byte at least.
  const std::uint64_t least =
      12ULL * vertices + (16ULL + 2 + 1) * collapses + 3ULL * triangles + 4ULL * wires + 20ULL * pins;
  if (!in.ok() || in.left() < least)
    return fail(std::string(name) + ": expected at least " + std::to_string(least) + " bytes for " +
                std::to_string(vertices) + " vertices; found " + std::to_string(in.left()));

  parts.leaves.resize(vertices);
  for (auto& leaf : parts.leaves) leaf = in.get<std::array<float, 3>>();
  parts.spheres.resize(collapses);
  for (auto& sphere : parts.spheres) sphere = in.get<Hierarchy::PackedSphere>();
  parts.pinned.resize(pins);
  for (auto& [vertex, sphere] : parts.pinned) {
    vertex = in.get<std::uint32_t>();
    sphere = in.get<Hierarchy::PackedSphere>();
  }
  parts.children.resize(collapses);
  for (std::uint32_t k = 0; k < collapses; ++k)
    for (auto& child : parts.children[k]) child = vertices + k - 1 - in.varint();
  parts.lasting.resize(std::size_t{collapses} + 1);
  parts.lasting[0] = triangles;
  for (std::size_t k = 1; k <= collapses; ++k) parts.lasting[k] = parts.lasting[k - 1] - in.varint();
  std::uint32_t last = 0;
  parts.triangles.resize(triangles);
  for (auto& triangle : parts.triangles)
    for (auto& corner : triangle) corner = in.delta(last);
  parts.wire_edges.resize(wires);
  for (auto& wire : parts.wire_edges) {
    for (auto& end : wire.ends) end = in.delta(last);
    wire.first = in.varint();
    wire.last = wire.first + in.varint();
  }
  if (in.ok() && in.left() > 0) {
    const std::uint32_t steps = in.varint();
    if (!in.ok() || in.left() < steps) return fail(std::string(name) + ": the steps end early");
    parts.steps.resize(steps);
    std::uint32_t done = 0;
    for (auto& step : parts.steps) step = done += in.varint();
  }
  if (!in.ok()) return fail(std::string(name) + ": the contents end early or hold a number above 2^32");
  if (in.left() != 0) return fail(std::string(name) + ": " + std::to_string(in.left()) + " bytes too many");
  return parts;
}

}  // namespace

std::string encode_hierarchy(const Hierarchy& hierarchy) {
  const auto& parts = hierarchy.parts();
  std::string body;
  body.reserve(64 * parts.leaves.size() + 64);
  const auto vertices = static_cast<std::uint32_t>(parts.leaves.size());
  append_binary(body, vertices);
  append_binary(body, static_cast<std::uint32_t>(parts.children.size()));
  append_binary(body, static_cast<std::uint32_t>(parts.triangles.size()));
  append_binary(body, static_cast<std::uint32_t>(parts.wire_edges.size()));
  append_binary(body, static_cast<std::uint32_t>(parts.pinned.size()));
  for (const double coordinate : parts.origin) append_binary(body, coordinate);
  append_binary(body, parts.scale);
  for (const auto& leaf : parts.leaves) append_binary(body, leaf);
  for (const auto& sphere : parts.spheres) append_binary(body, sphere);
  for (const auto& [vertex, sphere] : parts.pinned) {
    append_binary(body, vertex);
    append_binary(body, sphere);
  }
  for (std::uint32_t k = 0; k < parts.children.size(); ++k)
    for (const auto child : parts.children[k]) append_varint(body, vertices + k - 1 - child);
  for (std::size_t k = 1; k < parts.lasting.size(); ++k) append_varint(body, parts.lasting[k - 1] - parts.lasting[k]);
  DeltaWriter delta(body);
  for (const auto& triangle : parts.triangles)
    for (const auto corner : triangle) delta.put(corner);
  for (const auto& wire : parts.wire_edges) {
    for (const auto end : wire.ends) delta.put(end);
    append_varint(body, wire.first);
    append_varint(body, wire.last - wire.first);
  }
  if (!parts.steps.empty()) {
    append_varint(body, static_cast<std::uint32_t>(parts.steps.size()));
    for (std::size_t k = 0; k < parts.steps.size(); ++k)
      append_varint(body, parts.steps[k] - (k == 0 ? 0 : parts.steps[k - 1]));
  }

  std::string file(kMagic.data(), kMagic.size());
  file.reserve(kHeaderBytes + body.size());
  append_binary(file, kHierarchyFileVersion);
  append_binary(file, crc32(body));
  append_binary(file, std::uint64_t{body.size()});
  file += body;
  return file;
}

Expected<Hierarchy> parse_hierarchy(std::string_view bytes, std::string_view name) {
  const auto wrong = [&](const std::string& what) { return fail(std::string(name) + ": " + what); };
  if (bytes.substr(0, kMagic.size()) != std::string_view(kMagic.data(), kMagic.size()))
    return wrong("expected a hierarchy of sphere-meshes; the first 8 bytes are not those of one");
  Reader in(bytes.substr(kMagic.size()));
  const auto version = in.get<std::uint32_t>();
  const auto checksum = in.get<std::uint32_t>();
  const auto size = in.get<std::uint64_t>();
  if (in.ok() && version != kHierarchyFileVersion)
    return wrong("expected version " + std::to_string(kHierarchyFileVersion) + ", found " + std::to_string(version));
  if (!in.ok() || size != in.left())
    return wrong("expected " + (in.ok() ? std::to_string(size) : "a size and as many") +
                 " bytes behind the header, found " + std::to_string(in.left()));
  if (crc32(bytes.substr(kHeaderBytes)) != checksum)
    return wrong("the checksum does not fit; the file was altered or damaged");
  auto parts = parse_parts(in, name);
  if (!parts) return tl::unexpected(parts.error());
  auto hierarchy = Hierarchy::assemble(std::move(*parts));
  if (!hierarchy) return wrong(hierarchy.error().message);
  return hierarchy;
}

Expected<Hierarchy> read_hierarchy(const std::filesystem::path& path, const Task& task) {
  task.report("reading", 0);
  const auto bytes = read_file_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  if (task.stopped()) return cancelled();
  return parse_hierarchy(*bytes, path.string());
}

Expected<void> write_hierarchy(const Hierarchy& hierarchy, const std::filesystem::path& path) {
  return write_file_bytes(path, encode_hierarchy(hierarchy));
}

}  // namespace armature::sdk
