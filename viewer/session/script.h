#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <armature/sdk/error.h>

#include "viewer/session/session.h"

namespace armature::viewer {

/// Lines that are carried out one after another, each when the work of those before it is done. Before its command a
/// line may say `meanwhile`: it does not wait for that work; and `try`: it may fail, which nothing that is done by hand
/// counts as. Lines without words are none.
class Script {
 public:
  Script() = default;
  /// Of no file: what fails says so without a place.
  explicit Script(const std::vector<std::string>& lines);
  /// Fails where the file cannot be read.
  [[nodiscard]] static sdk::Expected<Script> read(const std::filesystem::path& path);

  /// Another script's lines after these.
  void append(Script other);

  /// Carries out what can be now; fails where a line or its work failed, with its place in its file. Call it once a
  /// frame, after `session.update()`.
  [[nodiscard]] sdk::Expected<void> step(Session& session);
  /// Whether all lines have been begun,
  [[nodiscard]] bool begun() const noexcept { return next_ == lines_.size(); }
  /// and nothing goes on any more.
  [[nodiscard]] bool done(const Session& session) const noexcept {
    return begun() && !session.busy() && !session.picture;
  }

 private:
  struct Line {
    std::string text;   // the command
    std::string place;  // in a file, or empty
    bool waits = true, may_fail = false;
  };
  void add(std::string_view text, std::string place);

  std::vector<Line> lines_;
  std::size_t next_ = 0;
};

/// Files that are opened one after another, whatever becomes of the others. Which could not be is told in the end.
class FileList {
 public:
  void add(const std::string& file);
  /// As a script's.
  void step(Session& session);
  [[nodiscard]] bool done(const Session& session) const noexcept { return !opening_ && script_.done(session); }

 private:
  Script script_;
  bool opening_ = false;
  std::size_t failures_ = 0;           // of the session, that have been looked at
  std::string failed_;                 // what is to be told
  std::size_t told_ = 0, untold_ = 0;  // files that it names, and does not
};

/// What a window plays: it opens files, then plays its script, and then opens what is dropped onto it, whatever becomes
/// of other things that are done by hand meanwhile.
class Playlist {
 public:
  Playlist(const std::vector<std::string>& files, Script script);
  /// Opens a file when its turn has come.
  void drop(const std::string& file) { dropped_.add(file); }
  /// Carries out what can be now. Call it once a frame, after `session.update()`. A script that fails ends, and the
  /// session tells why.
  void step(Session& session);
  [[nodiscard]] bool done(const Session& session) const noexcept {
    return files_.done(session) && script_.done(session) && dropped_.done(session);
  }

 private:
  FileList files_, dropped_;
  Script script_;
};

}  // namespace armature::viewer
