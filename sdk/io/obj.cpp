#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "sdk/io/mesh_parsers.h"
#include "sdk/io/place.h"
#include "sdk/io/polygons.h"
#include "sdk/io/text_scanner.h"

namespace armature::sdk {
namespace {

/// Reads OBJ statements into polygons. Not through tinyobjloader, which rounds more than half of all coordinates to a
/// neighbour of the nearest double; the tests hold this against it.
class ObjParser {
 public:
  ObjParser(std::string_view text, std::string_view name) : text_(text), scanner_(text, name, kRules) {}

  Expected<MeshOrPoints> parse(const Task& task) {
    ReadingPace pace(task);
    while (scanner_.next_line()) {
      if (pace.stopped(scanner_.position(), scanner_.size())) return cancelled();
      if (auto read = statement(); !read) return tl::unexpected(read.error());
    }
    if (highest_ > polygons_.positions.size()) return out_of_range(highest_line_, static_cast<std::int64_t>(highest_));
    if (polygons_.counts.empty())
      if (auto read = normals(); !read) return tl::unexpected(read.error());
    return mesh_or_points(std::move(polygons_), scanner_.name(), task);
  }

 private:
  static constexpr TextRules kRules = {.comments = true, .continuations = true};

  /// Reads the normals of points, which nobody asks for where there are faces.
  Expected<void> normals() {
    scanner_ = TextScanner(text_, scanner_.name(), kRules);
    while (scanner_.next_line()) {
      if (scanner_.word() != "vn") continue;
      if (polygons_.normals.size() == polygons_.positions.size())
        return scanner_.expected(std::to_string(polygons_.positions.size()) + " normals vn, one a vertex v", "vn");
      Eigen::Vector3d normal;
      for (double& coordinate : normal) {
        const std::string_view word = scanner_.word();
        const std::optional<double> number = to_double(word);
        if (!number) return scanner_.expected("three numbers of a normal", word);
        coordinate = *number;
      }
      if (const auto wrong = made_unit(normal); !wrong.empty()) return scanner_.expected(wrong, "vn");
      polygons_.normals.push_back(normal);
    }
    if (const std::size_t found = polygons_.normals.size(); found != 0 && found != polygons_.positions.size())
      return fail(std::string(scanner_.name()) + ": expected as many normals vn as vertices v, " +
                  std::to_string(polygons_.positions.size()) + ", for points without faces; found " +
                  std::to_string(found));
    return {};
  }

  Expected<void> statement() {
    const std::string_view keyword = scanner_.word();
    if (keyword == "v") return vertex();
    // "fo" is what old versions of the format call a face.
    if (keyword == "f" || keyword == "fo") return face();
    const char first = keyword[0];
    if ((first >= 'a' && first <= 'z') || (first >= 'A' && first <= 'Z')) return {};
    return scanner_.expected("an OBJ statement such as v or f", keyword);
  }

  /// v X Y Z [W], or with a colour in [0, 1] behind: v X Y Z R G B.
  Expected<void> vertex() {
    std::array<double, 7> numbers{};
    std::size_t count = 0;
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
      const std::optional<double> number = to_double(word);
      if (!number || !std::isfinite(*number)) return scanner_.expected("a finite number", word);
      if (count == numbers.size()) return scanner_.expected("at most 7 numbers for a vertex", word);
      numbers[count++] = *number;
    }
    if (count < 3) return scanner_.expected("three coordinates", {});
    if (polygons_.positions.size() == kMostElements) return scanner_.expected("fewer than 2^32 - 1 vertices", "v");
    polygons_.positions.emplace_back(numbers[0], numbers[1], numbers[2]);
    if (count >= 6 && polygons_.vertex_colours.size() + 1 == polygons_.positions.size())
      polygons_.vertex_colours.push_back(colour_of_fractions(numbers[3], numbers[4], numbers[5]));
    return {};
  }

  Expected<void> face() {
    std::uint32_t count = 0;
    for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
      const auto corner = parse_corner(word);
      if (!corner) return tl::unexpected(corner.error());
      if (++count > kMostCorners) return scanner_.expected("a polygon of at most 10000 corners", word);
      polygons_.corners.push_back(*corner);
    }
    if (count < 3) return scanner_.expected("at least three corners of a face", {});
    polygons_.counts.push_back(count);
    return {};
  }

  /// V, V/T, V//N or V/T/N. Each counts from 1, or backwards from -1, the newest.
  Expected<VertexId> parse_corner(std::string_view word) {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const std::optional<std::int64_t> vertex = to_integer(word.substr(0, slash));
    if (!vertex || !is_texture_and_normal(word.substr(slash)))
      return scanner_.expected("a corner such as 7, 7/1, 7//2 or 7/1/2", word);
    const auto known = static_cast<std::int64_t>(polygons_.positions.size());
    const std::int64_t index = *vertex < 0 ? known + *vertex + 1 : *vertex;
    if (index < 1 || index > static_cast<std::int64_t>(kMostElements)) return out_of_range(scanner_.line(), *vertex);
    // A face may stand before its vertices: the end of the file shows whether they come.
    if (const auto place = static_cast<std::size_t>(index); place > highest_) {
      highest_ = place;
      highest_line_ = scanner_.line();
    }
    return VertexId(index - 1);
  }

  /// What follows the vertex of a corner: nothing, /T, //N or /T/N.
  static bool is_texture_and_normal(std::string_view text) {
    if (text.empty()) return true;
    text.remove_prefix(1);
    const std::size_t slash = text.find('/');
    const std::string_view texture = text.substr(0, slash);
    const bool has_normal = slash != std::string_view::npos;
    if (!texture.empty() && !to_integer(texture)) return false;
    // Some programs write 7/ and 7// for a corner that has neither.
    return !has_normal || slash + 1 == text.size() || to_integer(text.substr(slash + 1)).has_value();
  }

  [[nodiscard]] tl::unexpected<Error> out_of_range(std::size_t line, std::int64_t index) const {
    return fail_at_line(scanner_.name(), line,
                        "expected the number of one of " + std::to_string(polygons_.positions.size()) +
                            " vertices, from 1; found " + std::to_string(index));
  }

  std::string_view text_;
  TextScanner scanner_;
  Polygons polygons_;
  std::size_t highest_ = 0;       // vertex that a face named
  std::size_t highest_line_ = 0;  // where
};

}  // namespace

Expected<MeshOrPoints> parse_obj(std::string_view text, std::string_view name, const Task& task) {
  return ObjParser(text, name).parse(task);
}

}  // namespace armature::sdk
