#include "viewer/session/script.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include <fmt/format.h>

namespace armature::viewer {

Script::Script(const std::vector<std::string>& lines) {
  for (const std::string& line : lines) add(line, "");
}

sdk::Expected<Script> Script::read(const std::filesystem::path& path) {
  constexpr const char* kExpected = "expected a file of commands, one a line";
  std::error_code none;
  if (std::filesystem::is_directory(path, none)) return sdk::fail(path.string() + ": is a folder; " + kExpected);
  std::ifstream file(path);
  if (!file) return sdk::fail(path.string() + ": cannot be read; " + kExpected);
  Script script;
  std::size_t number = 0;
  for (std::string line; std::getline(file, line);) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (number == 0 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    script.add(line, path.string() + ", line " + std::to_string(++number) + ": ");
  }
  return script;
}

void Script::add(std::string_view text, std::string place) {
  constexpr std::string_view kBlanks = " \t\r";
  Line line{.text = {}, .place = std::move(place)};
  for (;;) {
    text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
    const std::string_view word = text.substr(0, text.find_first_of(kBlanks));
    if (word == "meanwhile") {
      line.waits = false;
    } else if (word == "try") {
      line.may_fail = true;
    } else {
      break;
    }
    text.remove_prefix(word.size());
  }
  if (text.empty() || text.front() == '#') return;
  line.text = text;
  lines_.push_back(std::move(line));
}

void Script::append(Script other) {
  lines_.insert(lines_.end(), std::make_move_iterator(other.lines_.begin()),
                std::make_move_iterator(other.lines_.end()));
}

sdk::Expected<void> Script::step(Session& session) {
  while (!session.picture && !session.quit) {
    if (session.failure) return sdk::fail(*session.failure);
    if (begun()) return {};
    const Line& line = lines_[next_];
    if (line.waits ? session.busy() : session.waits()) return {};
    ++next_;
    session.origin = {.place = line.place, .may_fail = line.may_fail};
    static_cast<void>(session.execute(line.text));
    session.origin = {};
  }
  return {};
}

void FileList::add(const std::string& file) {
  script_.append(Script({"try open " + as_word(file)}));
}

void FileList::step(Session& session) {
  if (!opening_) {
    if (script_.begun()) return;
    opening_ = true;
    failures_ = session.failures;
  }
  if (session.failures != failures_) {
    failures_ = session.failures;
    constexpr std::size_t kMostTold = 3;
    if (told_ < kMostTold) {
      failed_ += (told_++ == 0 ? "" : "; ") + session.notice;
    } else {
      ++untold_;
    }
  }
  static_cast<void>(script_.step(session));
  if (!script_.done(session)) return;
  opening_ = false;
  // The next one that could be opened has taken away what was told.
  if (untold_ > 0) failed_ += fmt::format("; and {} more", untold_);
  if (!failed_.empty()) session.tell(std::exchange(failed_, {}), true);
  told_ = untold_ = 0;
}

Playlist::Playlist(const std::vector<std::string>& files, Script script) : script_(std::move(script)) {
  for (const std::string& file : files) files_.add(file);
}

void Playlist::step(Session& session) {
  files_.step(session);
  if (!files_.done(session)) return;
  if (const auto stepped = script_.step(session); !stepped) {
    session.tell(stepped.error().message, true);
    script_ = Script();
  }
  if (!script_.done(session)) return;
  session.failure.reset();  // it has been told
  dropped_.step(session);
}

}  // namespace armature::viewer
