#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>

#include "sdk/io/mesh_parsers.h"
#include "sdk/io/place.h"
#include "sdk/io/polygons.h"
#include "sdk/io/text_scanner.h"

namespace armature::sdk {
namespace {

/// Gives equal corners one vertex, numbered as they first appear.
class Welder {
 public:
  explicit Welder(Polygons& polygons) : polygons_(polygons) {}

  void add_corner(const Eigen::Vector3d& position) {
    Key key{};
    // Adding zero makes one zero of the two.
    for (int k = 0; k < 3; ++k) key[static_cast<std::size_t>(k)] = std::bit_cast<std::uint64_t>(position[k] + 0.0);
    const auto [found, is_new] = vertices_.try_emplace(key, VertexId(polygons_.positions.size()));
    if (is_new) polygons_.positions.push_back(position);
    polygons_.corners.push_back(found->second);
  }

 private:
  using Key = std::array<std::uint64_t, 3>;
  struct Hash {
    std::size_t operator()(const Key& key) const noexcept {
      std::uint64_t hash = 0;
      for (const std::uint64_t word : key) {
        hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 32U;
      }
      return hash;
    }
  };
  Polygons& polygons_;
  std::unordered_map<Key, VertexId, Hash> vertices_;
};

constexpr std::size_t kHeaderBytes = 84;  // 80 of comment, 4 of count
constexpr std::size_t kFacetBytes = 50;   // normal, three corners, two bytes of attributes

std::uint32_t little_endian(std::string_view bytes) noexcept {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  return value;
}

/// The number of facets a binary file announces.
std::size_t announced(std::string_view bytes) noexcept {
  return little_endian(bytes.substr(kHeaderBytes - 4));
}

Expected<Mesh> parse_binary(std::string_view bytes, std::string_view name, const Task& task) {
  if (bytes.size() < kHeaderBytes)
    return fail_at_byte(name, bytes.size(), "expected 'solid' or a header of 84 bytes; the file ends here");
  const std::size_t facets = announced(bytes);
  if (bytes.size() != kHeaderBytes + kFacetBytes * facets)
    return fail_at_byte(name, kHeaderBytes - 4,
                        "expected " + std::to_string(kHeaderBytes + kFacetBytes * facets) + " bytes for the " +
                            std::to_string(facets) + " facets announced; the file has " + std::to_string(bytes.size()));
  Polygons polygons;
  polygons.counts.assign(facets, 3);
  polygons.corners.reserve(3 * facets);
  Welder welder(polygons);
  ReadingPace pace(task);
  for (std::size_t i = 0; i < facets; ++i) {
    if (pace.stopped(i, facets)) return cancelled();
    const std::size_t at = kHeaderBytes + kFacetBytes * i + 12;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Eigen::Vector3d p;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t place = at + 12 * corner + 4 * k;
        const float coordinate = std::bit_cast<float>(little_endian(bytes.substr(place)));
        if (!std::isfinite(coordinate)) return fail_at_byte(name, place, "expected a finite coordinate");
        p[static_cast<Eigen::Index>(k)] = coordinate;
      }
      welder.add_corner(p);
    }
  }
  return triangulated(std::move(polygons), name, task);
}

/// Reads facet after facet, word after word, in either case.
class AsciiParser {
 public:
  AsciiParser(std::string_view text, std::string_view name) : scanner_(text, name, {.comments = false}) {}

  Expected<Mesh> parse(const Task& task) {
    ReadingPace pace(task);
    bool open = false;  // within a solid
    while (scanner_.next_line()) {
      if (pace.stopped(scanner_.position(), scanner_.size())) return cancelled();
      const std::string_view word = scanner_.word();
      if (is(word, open ? "endsolid" : "solid")) {
        open = !open;
        (void)scanner_.rest_of_line();  // its name
        continue;
      }
      if (!open) return scanner_.expected("solid", word);
      if (!is(word, "facet")) return scanner_.expected("facet or endsolid", word);
      if (auto read = facet(); !read) return tl::unexpected(read.error());
    }
    if (open) return scanner_.ended("facet or endsolid");
    return triangulated(std::move(polygons_), scanner_.name(), task);
  }

 private:
  Expected<void> facet() {
    Eigen::Vector3d numbers;
    if (auto read = keyword("normal"); !read) return read;
    // Normals follow from the corners, and some programs write them as not a number.
    if (auto read = coordinates(numbers, false); !read) return read;
    if (auto read = keyword("outer"); !read) return read;
    if (auto read = keyword("loop"); !read) return read;
    for (int corner = 0; corner < 3; ++corner) {
      if (auto read = keyword("vertex"); !read) return read;
      if (auto read = coordinates(numbers, true); !read) return read;
      welder_.add_corner(numbers);
    }
    polygons_.counts.push_back(3);
    if (auto read = keyword("endloop"); !read) return read;
    return keyword("endfacet");
  }

  /// The next word, on this line or a later one.
  std::string_view word() {
    if (scanner_.at_line_end() && !scanner_.next_line()) return {};
    return scanner_.word();
  }

  Expected<void> keyword(std::string_view expected) {
    const std::string_view found = word();
    if (!is(found, expected)) return scanner_.expected(expected, found);
    return {};
  }

  Expected<void> coordinates(Eigen::Vector3d& out, bool finite) {
    for (double& coordinate : out) {
      const std::string_view found = word();
      const std::optional<double> number = to_double(found);
      if (!number || (finite && !std::isfinite(*number))) return scanner_.expected("a finite number", found);
      coordinate = *number;
    }
    return {};
  }

  static bool is(std::string_view word, std::string_view keyword) {
    return std::equal(word.begin(), word.end(), keyword.begin(), keyword.end(),
                      [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
  }

  TextScanner scanner_;
  Polygons polygons_;
  Welder welder_{polygons_};
};

}  // namespace

Expected<Mesh> parse_stl(std::string_view bytes, std::string_view name, const Task& task) {
  // A binary file may begin with "solid" too; then its size is what its count announces.
  const bool binary_size =
      bytes.size() >= kHeaderBytes && bytes.size() == kHeaderBytes + kFacetBytes * announced(bytes);
  TextScanner start(bytes, name, {.comments = false});
  (void)start.next_line();
  std::string first(start.word().substr(0, 5));
  for (char& c : first) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (binary_size || first != "solid") return parse_binary(bytes, name, task);
  return AsciiParser(bytes, name).parse(task);
}

}  // namespace armature::sdk
