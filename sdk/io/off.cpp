#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "sdk/io/mesh_parsers.h"
#include "sdk/io/polygons.h"
#include "sdk/io/text_scanner.h"

namespace armature::sdk {
namespace {

/// Reads Geomview's OFF: the keyword [ST][C][N]OFF, three counts, a line a vertex, a line a face.
class OffParser {
 public:
  OffParser(std::string_view text, std::string_view name) : scanner_(text, name) {}

  Expected<MeshOrPoints> parse(const Task& task) {
    if (auto read = header(); !read) return tl::unexpected(read.error());
    ReadingPace pace(task);
    for (std::size_t i = 0; i < vertices_; ++i) {
      if (pace.stopped(scanner_.position(), scanner_.size())) return cancelled();
      if (auto read = vertex(i); !read) return tl::unexpected(read.error());
    }
    for (std::size_t i = 0; i < faces_; ++i) {
      if (pace.stopped(scanner_.position(), scanner_.size())) return cancelled();
      if (auto read = face(i); !read) return tl::unexpected(read.error());
    }
    if (scanner_.next_line()) return scanner_.expected("nothing behind the last face", scanner_.word());
    return mesh_or_points(std::move(polygons_), scanner_.name(), task);
  }

 private:
  Expected<void> header() {
    if (!scanner_.next_line()) return scanner_.ended("the keyword OFF");
    const std::string_view keyword = scanner_.word();
    std::string_view prefix = keyword;
    if (!prefix.ends_with("OFF")) return scanner_.expected("the keyword OFF", keyword);
    prefix.remove_suffix(3);
    const auto skip = [&](std::string_view letters) {
      const bool has = prefix.starts_with(letters);
      if (has) prefix.remove_prefix(letters.size());
      return has;
    };
    skip("ST");
    const bool coloured = skip("C");
    const bool normals = skip("N");
    if (!prefix.empty()) return scanner_.expected("OFF in three dimensions (OFF, COFF, NOFF...)", keyword);
    normals_ = normals;
    colour_at_ = coloured ? (normals ? 6 : 3) : (normals ? 0 : 3);
    // The counts stand on a line of their own or behind the keyword.
    if (scanner_.at_line_end() && !scanner_.next_line()) return scanner_.ended("the numbers of vertices and faces");
    for (std::size_t* count : {&vertices_, &faces_}) {
      const std::string_view word = scanner_.word();
      if (word == "BINARY") return scanner_.expected("an ASCII file", word);
      const std::optional<std::int64_t> number = to_integer(word);
      if (!number || *number < 0 || *number > static_cast<std::int64_t>(kMostElements))
        return scanner_.expected("the numbers of vertices, faces and edges", word);
      *count = static_cast<std::size_t>(*number);
    }
    // No line of a vertex or face is shorter than six bytes, so that a false count cannot ask for much memory.
    const std::size_t most = scanner_.size() / 6 + 1;
    polygons_.positions.reserve(std::min(vertices_, most));
    polygons_.counts.reserve(std::min(faces_, most));
    polygons_.corners.reserve(3 * std::min(faces_, most));
    return {};
  }

  Expected<void> vertex(std::size_t index) {
    if (!scanner_.next_line()) return scanner_.ended(what("vertex", index, vertices_));
    std::array<double, 12> numbers{};
    std::size_t count = 0;
    bool whole = true;
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
      const std::optional<double> number = to_double(word);
      if (!number || !std::isfinite(*number)) return scanner_.expected("a finite number", word);
      if (count == numbers.size()) return scanner_.expected("at most 12 numbers for a vertex", word);
      if (count >= colour_at_) whole = whole && to_integer(word).has_value();
      numbers[count++] = *number;
    }
    if (count < 3) return scanner_.expected("three coordinates", {});
    polygons_.positions.emplace_back(numbers[0], numbers[1], numbers[2]);
    if (normals_ && faces_ == 0) {
      if (count < 6) return scanner_.expected("three coordinates and a normal", {});
      Eigen::Vector3d normal(numbers[3], numbers[4], numbers[5]);
      if (const auto wrong = made_unit(normal); !wrong.empty()) return scanner_.expected(wrong, "0 0 0");
      polygons_.normals.push_back(normal);
    }
    if (colour_at_ >= 3 && count >= colour_at_ + 3 && polygons_.vertex_colours.size() == index)
      polygons_.vertex_colours.push_back(colour(std::span(numbers).subspan(colour_at_).first<3>(), whole));
    return {};
  }

  /// COUNT I J K..., then nothing, an index into a palette, or a colour.
  Expected<void> face(std::size_t index) {
    if (!scanner_.next_line()) return scanner_.ended(what("face", index, faces_));
    const std::string_view first = scanner_.word();
    const std::optional<std::int64_t> count = to_integer(first);
    if (!count || *count < 3 || *count > static_cast<std::int64_t>(kMostCorners))
      return scanner_.expected("a number of corners from 3 to 10000", first);
    for (std::int64_t i = 0; i < *count; ++i) {
      const std::string_view word = scanner_.word();
      const std::optional<std::int64_t> corner = to_integer(word);
      if (!corner || *corner < 0 || *corner >= static_cast<std::int64_t>(vertices_))
        return scanner_.expected("the number of a vertex below " + std::to_string(vertices_), word);
      polygons_.corners.emplace_back(*corner);
    }
    polygons_.counts.push_back(static_cast<std::uint32_t>(*count));
    return face_colour(index);
  }

  Expected<void> face_colour(std::size_t index) {
    std::array<double, 4> numbers{};
    std::size_t count = 0;
    bool whole = true;
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
      const std::optional<double> number = to_double(word);
      if (!number || count == numbers.size()) return scanner_.expected("a colour of at most 4 numbers", word);
      whole = whole && to_integer(word).has_value();
      numbers[count++] = *number;
    }
    if (count >= 3 && polygons_.polygon_colours.size() == index)
      polygons_.polygon_colours.push_back(colour(std::span(numbers).first<3>(), whole));
    return {};
  }

  /// Whole numbers are of [0, 255], others of [0, 1].
  static Colour colour(std::span<const double, 3> numbers, bool whole) noexcept {
    const double one = whole ? 255 : 1;
    return colour_of_fractions(numbers[0] / one, numbers[1] / one, numbers[2] / one);
  }

  static std::string what(std::string_view element, std::size_t index, std::size_t count) {
    return std::string(element) + " " + std::to_string(index + 1) + " of " + std::to_string(count);
  }

  TextScanner scanner_;
  Polygons polygons_;
  std::size_t vertices_ = 0;
  std::size_t faces_ = 0;
  bool normals_ = false;       // stand behind a vertex's coordinates
  std::size_t colour_at_ = 3;  // where a vertex's colour begins among its numbers; 0: there is none
};

}  // namespace

Expected<MeshOrPoints> parse_off(std::string_view text, std::string_view name, const Task& task) {
  return OffParser(text, name).parse(task);
}

}  // namespace armature::sdk
