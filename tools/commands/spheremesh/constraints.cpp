#include "tools/commands/spheremesh/constraints.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>
#include <unordered_set>

#include <fmt/format.h>

namespace armature::tools {
namespace {

/// The lines of a text file that say something, word by word.
class Lines {
 public:
  explicit Lines(const std::string& file) : file_(file), in_(file) { in_.peek(); }

  /// False for a folder, too, which opens but cannot be read.
  [[nodiscard]] bool readable() const { return in_.is_open() && !in_.bad(); }

  /// Goes to the next line with words in it.
  bool next() {
    while (std::getline(in_, line_)) {
      ++number_;
      rest_ = std::string_view(line_).substr(0, line_.find('#'));
      skip_blanks();
      if (!rest_.empty()) return true;
    }
    return false;
  }
  [[nodiscard]] bool ended() const noexcept { return rest_.empty(); }

  /// The next word of the line as a number, whole; nothing if it is none.
  template <class Number>
  std::optional<Number> number() {
    word_ = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(word_.size());
    skip_blanks();
    Number value{};
    const auto [end, error] = std::from_chars(word_.data(), word_.data() + word_.size(), value);
    if (error != std::errc() || end != word_.data() + word_.size()) return std::nullopt;
    return value;
  }

  /// What is wrong with the last word.
  [[nodiscard]] tl::unexpected<Error> expected(const std::string& what) const {
    const std::string found = word_.empty() ? "the line ends here" : fmt::format("found '{}'", word_);
    return wrong(fmt::format("expected {}; {}", what, found));
  }
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const {
    return fail(fmt::format("{}, line {}: {}", file_, number_, what));
  }

 private:
  static constexpr std::string_view kBlanks = " \t\r";

  void skip_blanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size())); }

  const std::string& file_;
  std::ifstream in_;
  std::string line_;
  std::string_view rest_;
  std::string_view word_;
  std::size_t number_ = 0;
};

}  // namespace

Expected<std::vector<sdk::PinnedSphere>> read_pins(const std::string& file, std::size_t vertices) {
  Lines lines(file);
  if (!lines.readable()) return fail(file + ": cannot be read");
  std::vector<sdk::PinnedSphere> pins;
  std::unordered_set<std::size_t> seen;
  while (lines.next()) {
    const auto vertex = lines.number<std::size_t>();
    if (!vertex || *vertex >= vertices) return lines.expected(fmt::format("the number of a vertex below {}", vertices));
    if (!seen.insert(*vertex).second) return lines.wrong(fmt::format("vertex {} is pinned already", *vertex));
    sdk::PinnedSphere& pin = pins.emplace_back(sdk::PinnedSphere{.vertex = sdk::VertexId(*vertex)});
    if (lines.ended()) continue;
    std::array<double, 4> numbers{};
    for (double& number : numbers) {
      const auto read = lines.number<double>();
      if (!read || !std::isfinite(*read)) return lines.expected("VERTEX, or VERTEX X Y Z RADIUS, all finite");
      number = *read;
    }
    if (numbers[3] < 0) return lines.expected("a radius that is not negative");
    if (!lines.ended()) return lines.wrong("expected nothing behind VERTEX X Y Z RADIUS");
    pin.sphere = sdk::Sphere{{numbers[0], numbers[1], numbers[2]}, numbers[3]};
  }
  return pins;
}

Expected<std::vector<std::uint32_t>> read_labels(const std::string& file, std::size_t vertices) {
  Lines lines(file);
  if (!lines.readable()) return fail(file + ": cannot be read");
  std::vector<std::uint32_t> labels;
  while (lines.next()) {
    const auto label = lines.number<std::uint32_t>();
    if (!label) return lines.expected("a label, a whole number from 0 to 2^32 - 1");
    if (!lines.ended()) return lines.wrong("expected one label a line");
    if (labels.size() == vertices)
      return lines.wrong(fmt::format("expected no more than {} labels, one a vertex", vertices));
    labels.push_back(*label);
  }
  if (labels.size() < vertices)
    return fail(fmt::format("{}: expected {} labels, one a vertex, found {}", file, vertices, labels.size()));
  return labels;
}

std::vector<std::uint32_t> labels_of_paint(std::span<const sdk::Colour> colours) {
  std::vector<std::uint32_t> labels;
  labels.reserve(colours.size());
  for (const auto& [red, green, blue] : colours)
    labels.push_back(std::uint32_t{red} << 16U | std::uint32_t{green} << 8U | blue);
  return labels;
}

}  // namespace armature::tools
