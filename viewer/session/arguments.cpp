#include "viewer/session/arguments.h"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace armature::viewer {

sdk::Expected<std::vector<std::string>> split_words(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < line.size();) {
    if (line[i] == ' ' || line[i] == '\t' || line[i] == '\r') {
      ++i;
    } else if (line[i] == '#') {
      break;
    } else if (line[i] == '"') {
      std::string word;
      for (++i; i < line.size() && line[i] != '"'; ++i) {
        const bool escaped = line[i] == '\\' && i + 1 < line.size();
        if (escaped) ++i;
        word += escaped && line[i] == 'n' ? '\n' : line[i];
      }
      if (i == line.size()) return sdk::fail("a quote is not closed; expected a second \"");
      ++i;
      words.push_back(std::move(word));
    } else {
      const std::size_t end = std::min(line.find_first_of(" \t\r", i), line.size());
      words.emplace_back(line.substr(i, end - i));
      i = end;
    }
  }
  return words;
}

std::string as_word(std::string_view word) {
  if (!word.empty() && word.find_first_of(" \t\r\n\"\\#") == std::string_view::npos) return std::string(word);
  std::string result = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\' || c == '\n') result += '\\';
    result += c == '\n' ? 'n' : c;
  }
  return result + '"';
}

sdk::Expected<PictureSize> parse_size(std::string_view text) {
  PictureSize size;
  const std::size_t cross = text.find('x');
  const auto whole = [](std::string_view digits, int& value) {
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && end == digits.data() + digits.size() && value >= 16 && value <= 16384;
  };
  if (cross == std::string_view::npos || !whole(text.substr(0, cross), size.width) ||
      !whole(text.substr(cross + 1), size.height))
    return sdk::fail("expected WIDTHxHEIGHT of 16 to 16384 pixels, found " + as_word(text));
  return size;
}

void Arguments::complain(std::string_view what, const std::string& expected, const std::string& found) {
  if (!complaint_) complaint_ = fmt::format("{}: expected {}, found {}", what, expected, found);
}

std::string Arguments::word(std::string_view what) {
  if (left() == 0) {
    complain(what, "a word", "nothing");
    return {};
  }
  return words_[next_++];
}

std::string Arguments::file() {
  std::string name = word("file");
  if (name.empty()) complain("file", "a name", as_word(name));
  return name;
}

double Arguments::number(std::string_view what, double least, double most) {
  const std::string expected = most < 1e300 ? fmt::format("a number from {:g} to {:g}", least, most) : "a number";
  if (left() == 0) {
    complain(what, expected, "nothing");
    return 0;
  }
  const std::string& text = words_[next_++];
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value) || value < least ||
      value > most) {
    complain(what, expected, as_word(text));
    return 0;
  }
  return value;
}

std::size_t Arguments::count(std::string_view what, std::size_t least, std::size_t most) {
  const std::string expected = fmt::format("a whole number from {} to {}", least, most);
  if (left() == 0) {
    complain(what, expected, "nothing");
    return least;
  }
  const std::string& text = words_[next_++];
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most) {
    complain(what, expected, as_word(text));
    return least;
  }
  return value;
}

std::size_t Arguments::choice(std::string_view what, const std::vector<std::string_view>& choices) {
  const std::string found = left() == 0 ? "nothing" : words_[next_];
  if (left() > 0) ++next_;
  for (std::size_t i = 0; i < choices.size(); ++i)
    if (choices[i] == found) return i;
  complain(what, fmt::format("one of {}", fmt::join(choices, ", ")), as_word(found));
  return 0;
}

Eigen::Vector3d Arguments::vector(std::string_view what) {
  Eigen::Vector3d result;
  for (double& coordinate : result) coordinate = number(what);
  return result;
}

std::vector<Eigen::Vector3d> Arguments::points(std::string_view what, std::size_t dimensions, std::size_t least) {
  std::vector<Eigen::Vector3d> result;
  while (left() > 0 && !complaint_) {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    for (std::size_t d = 0; d < dimensions; ++d) point[static_cast<Eigen::Index>(d)] = number(what);
    result.push_back(point);
  }
  if (result.size() < least)
    complain(what, fmt::format("at least {} points of {} numbers", least, dimensions), std::to_string(result.size()));
  return result;
}

sdk::Expected<void> Arguments::check() const {
  if (complaint_) return sdk::fail(*complaint_);
  if (left() > 0) return sdk::fail("expected nothing more, found " + as_word(words_[next_]));
  return {};
}

}  // namespace armature::viewer
