#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <armature/sdk/error.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// The double nearest to a decimal number that makes up the whole of `text`; nothing for anything else. May be infinite
/// or NaN if the text says so.
[[nodiscard]] std::optional<double> to_double(std::string_view text);
/// The decimal integer that makes up the whole of `text`; nothing for anything else.
[[nodiscard]] std::optional<std::int64_t> to_integer(std::string_view text);

/// What of a text is no content.
struct TextRules {
  bool comments = true;        ///< '#' and what follows on its line
  bool continuations = false;  ///< a backslash at the end of a line joins the next one to it
};

/// Walks a text line by line and word by word. Lines may end with LF, CR LF or CR.
class TextScanner {
 public:
  /// `first_line` is the number of the first line of `text` in its file.
  TextScanner(std::string_view text, std::string_view name, const TextRules& rules = {},
              std::size_t first_line = 1) noexcept
      : text_(text), name_(name), rules_(rules), line_(first_line) {}

  /// Goes to the next line that holds a word, past what is left of this one. False at the end of the text.
  bool next_line() noexcept;
  /// The next word of this line; empty at its end.
  [[nodiscard]] std::string_view word() noexcept;
  /// What is left of this line, comments included.
  [[nodiscard]] std::string_view rest_of_line() noexcept;
  /// Whether this line has no further word.
  [[nodiscard]] bool at_line_end() noexcept;

  /// The number of this line, from 1.
  [[nodiscard]] std::size_t line() const noexcept { return line_; }
  /// How many bytes have been walked past.
  [[nodiscard]] std::size_t position() const noexcept { return at_; }
  /// How many bytes there are.
  [[nodiscard]] std::size_t size() const noexcept { return text_.size(); }
  /// What stands for the file in messages.
  [[nodiscard]] std::string_view name() const noexcept { return name_; }

  /// The failure "NAME, line N: expected WHAT; found ..." with the word that was found, empty for the end of the line.
  [[nodiscard]] tl::unexpected<Error> expected(std::string_view what, std::string_view found) const;
  /// The failure "NAME, line N: expected WHAT; the file ends here".
  [[nodiscard]] tl::unexpected<Error> ended(std::string_view what) const;

 private:
  /// How many bytes the joint of two lines takes here; 0 where there is none.
  [[nodiscard]] std::size_t continuation() const noexcept;
  void skip_blanks() noexcept;

  std::string_view text_;
  std::string_view name_;
  TextRules rules_;
  std::size_t at_ = 0;
  std::size_t line_;
  bool on_line_ = false;  // next_line() has been called
};

/// Tells a task of a long reading once in a while.
class ReadingPace {
 public:
  explicit ReadingPace(const Task& task) noexcept : task_(task) {}

  /// To be called for every element. True when the caller asked to stop.
  [[nodiscard]] bool stopped(std::size_t done, std::size_t all) {
    if (++count_ % kEvery != 0) return false;
    task_.report("reading", all == 0 ? 1.0 : static_cast<double>(done) / static_cast<double>(all));
    return task_.stopped();
  }

 private:
  static constexpr std::size_t kEvery = 4096;
  const Task& task_;
  std::size_t count_ = 0;
};

}  // namespace armature::sdk
