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
  while (!session.busy() && !session.picture && !session.quit) {
    if (session.failed) return sdk::fail((next_ > 0 ? lines_[next_ - 1].place : "") + session.notice);
    session.waiting = nullptr;  // what was waited for has come
    if (next_ == lines_.size()) return {};
    const auto& [text, place] = lines_[next_++];
    constexpr std::string_view kTry = "try ";
    const bool forgiving = text.starts_with(kTry);
    session.forgiving = forgiving;
    const auto done = session.execute(forgiving ? text.substr(kTry.size()) : text);
    if (!done && !forgiving) return sdk::fail(place + done.error().message);
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
  session.failed = session.forgiving = false;
  if (!dropped_.done(session)) static_cast<void>(dropped_.step(session));
}

}  // namespace armature::viewer
