#include "viewer/session/script.h"

#include <fstream>
#include <iterator>

namespace armature::viewer {

Script::Script(std::vector<std::string> lines) {
  for (std::string& line : lines) lines_.push_back({std::move(line), ""});
}

sdk::Expected<Script> Script::read(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return sdk::fail(path.string() + ": cannot be read; expected a file of commands, one a line");
  Script script;
  for (std::string line; std::getline(file, line);)
    script.lines_.push_back({line, path.string() + ", line " + std::to_string(script.lines_.size() + 1) + ": "});
  return script;
}

void Script::append(Script other) {
  lines_.insert(lines_.end(), std::make_move_iterator(other.lines_.begin()),
                std::make_move_iterator(other.lines_.end()));
}

sdk::Expected<void> Script::step(Session& session) {
  while (!session.picture && !session.quit) {
    if (session.failure) return sdk::fail(*session.failure);
    std::string_view text = next_ < lines_.size() ? lines_[next_].text : std::string_view();
    const auto begins_with = [&text](std::string_view word) {
      if (!text.starts_with(word)) return false;
      text.remove_prefix(word.size());
      return true;
    };
    if (begins_with("meanwhile ") ? session.waits() : session.busy()) return {};
    session.waiting = nullptr;  // what was waited for has come
    if (next_ == lines_.size()) return {};
    session.origin = {.place = lines_[next_++].place, .may_fail = begins_with("try ")};
    static_cast<void>(session.execute(text));
    session.origin = {};
  }
  return {};
}

void Playlist::drop(const std::string& file) {
  dropped_.append(Script({"try open " + as_word(file)}));
}

void Playlist::step(Session& session) {
  if (!script_.done(session)) {
    const auto stepped = script_.step(session);
    if (stepped) return;
    session.tell(stepped.error().message, true);
    script_ = Script();
  }
  // What somebody does by hand has been told where it failed.
  session.failure.reset();
  if (!dropped_.done(session)) static_cast<void>(dropped_.step(session));
}

}  // namespace armature::viewer
