#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <armature/sdk/spheremesh/make_sphere_mesh.h>

#include "sdk/io/polygons.h"
#include "sdk/io/sphere_mesh_parsers.h"
#include "sdk/io/text_scanner.h"

namespace armature::sdk {
namespace {

/// Reads Q-MAT's medial meshes.
class MaParser {
 public:
  MaParser(std::string_view text, std::string_view name) : scanner_(text, name) {}

  Expected<SphereMesh> parse(const Task& task) {
    if (auto read = header(); !read) return tl::unexpected(read.error());
    ReadingPace pace(task);
    while (scanner_.next_line()) {
      if (pace.stopped(scanner_.position(), scanner_.size())) return cancelled();
      if (auto read = statement(); !read) return tl::unexpected(read.error());
    }
    if (spheres_.size() < vertices_) return scanner_.ended(missing("v", spheres_.size(), vertices_));
    if (pairs_.size() < edges_) return scanner_.ended(missing("e", pairs_.size(), edges_));
    if (triples_.size() < faces_) return scanner_.ended(missing("f", triples_.size(), faces_));
    return make_sphere_mesh(std::move(spheres_), pairs_, triples_);
  }

 private:
  Expected<void> header() {
    constexpr std::string_view kCounts = "the numbers of spheres, edges and triangles";
    if (!scanner_.next_line()) return scanner_.ended(kCounts);
    for (std::size_t* count : {&vertices_, &edges_, &faces_}) {
      const std::string_view word = scanner_.word();
      const std::optional<std::int64_t> number = to_integer(word);
      if (!number || *number < 0 || *number > static_cast<std::int64_t>(kMostElements))
        return scanner_.expected(kCounts, word);
      *count = static_cast<std::size_t>(*number);
    }
    if (vertices_ == 0) return scanner_.expected("at least one sphere", "0");
    return line_end();
  }

  Expected<void> statement() {
    const std::string_view keyword = scanner_.word();
    if (keyword == "v" && spheres_.size() < vertices_) return sphere();
    if (keyword == "e" && pairs_.size() < edges_) return indices(pairs_);
    if (keyword == "f" && triples_.size() < faces_) return indices(triples_);
    if (keyword == "v") return scanner_.expected(no_more("v", vertices_), keyword);
    if (keyword == "e") return scanner_.expected(no_more("e", edges_), keyword);
    if (keyword == "f") return scanner_.expected(no_more("f", faces_), keyword);
    return scanner_.expected("v, e or f", keyword);
  }

  Expected<void> sphere() {
    std::array<double, 4> numbers{};
    for (double& number : numbers) {
      const std::string_view word = scanner_.word();
      const std::optional<double> read = to_double(word);
      if (!read || !std::isfinite(*read)) return scanner_.expected("a finite number", word);
      number = *read;
      if (&number == &numbers.back() && number < 0) return scanner_.expected("a radius that is not negative", word);
    }
    spheres_.push_back({{numbers[0], numbers[1], numbers[2]}, numbers[3]});
    return line_end();
  }

  template <std::size_t N>
  Expected<void> indices(std::vector<std::array<SphereId, N>>& out) {
    std::array<SphereId, N> ids;
    for (SphereId& id : ids) {
      const std::string_view word = scanner_.word();
      const std::optional<std::int64_t> index = to_integer(word);
      if (!index || *index < 0 || *index >= static_cast<std::int64_t>(vertices_))
        return scanner_.expected("the number of a sphere below " + std::to_string(vertices_), word);
      id = SphereId(*index);
    }
    out.push_back(ids);
    return line_end();
  }

  Expected<void> line_end() {
    if (!scanner_.at_line_end()) return scanner_.expected("the end of the line", scanner_.word());
    return {};
  }

  static std::string missing(std::string_view keyword, std::size_t found, std::size_t count) {
    return std::to_string(count) + " lines " + std::string(keyword) + ", found " + std::to_string(found);
  }

  static std::string no_more(std::string_view keyword, std::size_t count) {
    return "no more than " + std::to_string(count) + " lines " + std::string(keyword);
  }

  TextScanner scanner_;
  std::size_t vertices_ = 0;
  std::size_t edges_ = 0;
  std::size_t faces_ = 0;
  std::vector<Sphere> spheres_;
  std::vector<SpherePair> pairs_;
  std::vector<SphereTriple> triples_;
};

}  // namespace

Expected<SphereMesh> parse_ma(std::string_view text, std::string_view name, const Task& task) {
  return MaParser(text, name).parse(task);
}

}  // namespace armature::sdk
