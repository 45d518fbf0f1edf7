#include "viewer/session/script.h"

#include <fstream>
#include <iterator>

namespace armature::viewer {

sdk::Expected<Script> Script::read(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return sdk::fail(path.string() + ": cannot be read; expected a file of commands, one a line");
  Script script;
  script.name_ = path.string();
  for (std::string line; std::getline(file, line);) script.lines_.push_back(line);
  return script;
}

void Script::append(Script other) {
  before_ = lines_.size();
  name_ = std::move(other.name_);
  lines_.insert(lines_.end(), std::make_move_iterator(other.lines_.begin()),
                std::make_move_iterator(other.lines_.end()));
}

sdk::Expected<void> Script::step(Session& session) {
  const auto failure = [&](const std::string& why) {
    return sdk::fail(name_ + ", line " + std::to_string(next_ > before_ ? next_ - before_ : next_) + ": " + why);
  };
  while (!session.busy() && !session.picture && !session.quit) {
    if (session.failed) return failure(session.notice);
    session.waiting = nullptr;  // what was waited for has come
    if (next_ == lines_.size()) return {};
    const std::string& line = lines_[next_++];
    constexpr std::string_view kTry = "try ";
    const bool forgiving = line.starts_with(kTry);
    session.forgiving = forgiving;
    const auto done = session.execute(forgiving ? line.substr(kTry.size()) : line);
    if (!done && !forgiving) return failure(done.error().message);
  }
  return {};
}

}  // namespace armature::viewer
