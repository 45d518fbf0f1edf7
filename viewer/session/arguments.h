#pragma once

#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>

namespace armature::viewer {

/// The words of a line: separated by blanks, or between double quotes, in which \", \\ and \n stand for ", \ and a
/// new line. What follows a # at the beginning of a word is a comment. Fails where a quote is not closed.
[[nodiscard]] sdk::Expected<std::vector<std::string>> split_words(std::string_view line);

/// A word as it has to stand in a line: in quotes where it is needed.
[[nodiscard]] std::string as_word(std::string_view word);

/// Of a picture or a window, in pixels.
struct PictureSize {
  int width = 0, height = 0;
};
/// What is written WIDTHxHEIGHT, from 16 to 16384 each, and nothing else.
[[nodiscard]] sdk::Expected<PictureSize> parse_size(std::string_view text);

/// The words after a command's name, read one after another. The first one that is not as expected is remembered, all
/// reading after it gives zeros, and `check()` tells.
class Arguments {
 public:
  explicit Arguments(std::vector<std::string> words) : words_(std::move(words)) {}

  [[nodiscard]] std::size_t left() const noexcept { return words_.size() - next_; }

  std::string word(std::string_view what);
  /// A word that can name a file: not an empty one.
  std::string file();
  /// A finite number in [least, most].
  double number(std::string_view what, double least = -1e300, double most = 1e300);
  /// A whole number in [least, most].
  std::size_t count(std::string_view what, std::size_t least, std::size_t most);
  /// The place of the word among `choices`.
  std::size_t choice(std::string_view what, const std::vector<std::string_view>& choices);
  /// on or off.
  bool on_off(std::string_view what) { return choice(what, {"off", "on"}) == 1; }
  /// x y z.
  Eigen::Vector3d vector(std::string_view what);
  /// All that is left, as points of `dimensions` numbers each; at least `least` of them.
  std::vector<Eigen::Vector3d> points(std::string_view what, std::size_t dimensions, std::size_t least);

  /// Fails where a word was not as expected, or one is left that nobody wants.
  [[nodiscard]] sdk::Expected<void> check() const;

 private:
  void complain(std::string_view what, const std::string& expected, const std::string& found);

  std::vector<std::string> words_;
  std::size_t next_ = 0;
  std::optional<std::string> complaint_;
};

}  // namespace armature::viewer
