#include "sdk/io/text_scanner.h"

#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>

#include "sdk/io/place.h"

namespace armature::sdk {
namespace {

bool is_blank(char c) noexcept {
  return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

bool is_line_end(char c) noexcept {
  return c == '\n' || c == '\r';
}

std::string_view without_plus(std::string_view text) noexcept {
  return text.size() > 1 && text[0] == '+' && text[1] != '-' ? text.substr(1) : text;
}

}  // namespace

std::optional<double> to_double(std::string_view text) {
  text = without_plus(text);
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return {};
  // Too large or too small for a double: from_chars does not say which; strtod does.
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);
  return value;
}

std::optional<std::int64_t> to_integer(std::string_view text) {
  text = without_plus(text);
  std::int64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (stop != end || error != std::errc()) return {};
  return value;
}

std::size_t TextScanner::continuation() const noexcept {
  if (!rules_.continuations || text_[at_] != '\\') return 0;
  std::size_t next = at_ + 1;
  if (next < text_.size() && text_[next] == '\r') ++next;
  if (next < text_.size() && text_[next] == '\n') ++next;
  return next == at_ + 1 ? 0 : next - at_;
}

void TextScanner::skip_blanks() noexcept {
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (is_blank(c)) continue;
    if (rules_.comments && c == '#') {
      while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
      return;
    }
    const std::size_t joint = continuation();
    if (joint == 0) return;
    at_ += joint - 1;
    ++line_;
  }
}

bool TextScanner::next_line() noexcept {
  while (on_line_ && !word().empty()) {
  }
  on_line_ = true;
  for (;;) {
    skip_blanks();
    if (at_ == text_.size()) return false;
    if (!is_line_end(text_[at_])) return true;
    if (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ++at_;
    ++at_;
    ++line_;
  }
}

std::string_view TextScanner::word() noexcept {
  skip_blanks();
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_blank(text_[at_]) && !is_line_end(text_[at_]) &&
         !(rules_.comments && text_[at_] == '#') && continuation() == 0)
    ++at_;
  return text_.substr(begin, at_ - begin);
}

std::string_view TextScanner::rest_of_line() noexcept {
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

bool TextScanner::at_line_end() noexcept {
  skip_blanks();
  return at_ == text_.size() || is_line_end(text_[at_]);
}

tl::unexpected<Error> TextScanner::expected(std::string_view what, std::string_view found) const {
  std::string message = "expected " + std::string(what);
  if (!found.empty())
    message += "; found " + quoted(found);
  else
    message += at_ == text_.size() ? "; the file ends here" : "; the line ends here";
  return fail_at_line(name_, line_, message);
}

tl::unexpected<Error> TextScanner::ended(std::string_view what) const {
  return fail_at_line(name_, line_, "expected " + std::string(what) + "; the file ends here");
}

}  // namespace armature::sdk
