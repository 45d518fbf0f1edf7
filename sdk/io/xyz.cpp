#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "sdk/io/mesh_parsers.h"
#include "sdk/io/polygons.h"
#include "sdk/io/text_scanner.h"

namespace armature::sdk {
namespace {

/// Reads lines X Y Z NX NY NZ. A number alone on the first line is how many there are.
class XyzParser {
 public:
  XyzParser(std::string_view text, std::string_view name) : scanner_(text, name) {}

  Expected<PointSet> parse(const Task& task) {
    ReadingPace pace(task);
    std::optional<std::int64_t> announced;
    for (bool first = true; scanner_.next_line(); first = false) {
      if (pace.stopped(scanner_.position(), scanner_.size())) return cancelled();
      const std::string_view word = scanner_.word();
      if (first && scanner_.at_line_end()) {
        announced = to_integer(word);
        if (!announced || *announced < 0)
          return scanner_.expected("six numbers X Y Z NX NY NZ, or how many points follow", word);
        continue;
      }
      if (auto read = point(word); !read) return tl::unexpected(read.error());
    }
    const std::size_t found = points_.positions.size();
    if (announced && *announced != static_cast<std::int64_t>(found))
      return scanner_.ended(std::to_string(*announced) + " points, as the first line says, but " +
                            std::to_string(found) + " are there");
    if (found == 0) return fail(std::string(scanner_.name()) + ": expected at least one point; it has none");
    return std::move(points_);
  }

 private:
  Expected<void> point(std::string_view word) {
    if (points_.positions.size() == kMostElements) return scanner_.expected("fewer than 2^32 - 1 points", word);
    Eigen::Vector3d position;
    Eigen::Vector3d normal;
    for (Eigen::Vector3d* three : {&position, &normal})
      for (double& number : *three) {
        if (word.empty() && three == &normal)
          return scanner_.expected("six numbers X Y Z NX NY NZ; estimate normals first where there are none", {});
        const std::optional<double> value = to_double(word);
        if (!value || !std::isfinite(*value)) return scanner_.expected("six finite numbers X Y Z NX NY NZ", word);
        number = *value;
        word = scanner_.word();
      }
    if (!word.empty()) return scanner_.expected("six numbers X Y Z NX NY NZ and no more", word);
    if (const auto wrong = made_unit(normal); !wrong.empty()) return scanner_.expected(wrong, "0 0 0");
    points_.positions.push_back(position);
    points_.normals.push_back(normal);
    return {};
  }

  TextScanner scanner_;
  PointSet points_;
};

}  // namespace

Expected<PointSet> parse_xyz(std::string_view text, std::string_view name, const Task& task) {
  return XyzParser(text, name).parse(task);
}

}  // namespace armature::sdk
