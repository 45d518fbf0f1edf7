#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <armature/sdk/error.h>

#include "viewer/session/session.h"

namespace armature::viewer {

/// Lines that are carried out one after another, each when the work of those before it is done. A line that begins with
/// `meanwhile` does not wait for that work; one that begins with `try`, or goes on so, may fail.
class Script {
 public:
  Script() = default;
  /// Of no file: what fails says so without a place.
  explicit Script(std::vector<std::string> lines);
  /// Fails where the file cannot be read.
  [[nodiscard]] static sdk::Expected<Script> read(const std::filesystem::path& path);

  /// Another script's lines after these.
  void append(Script other);

  /// Carries out what can be now; fails where a line or its work failed, with its place in its file. Call it once a
  /// frame, after `session.update()`.
  [[nodiscard]] sdk::Expected<void> step(Session& session);
  [[nodiscard]] bool done(const Session& session) const noexcept {
    return next_ == lines_.size() && !session.busy() && !session.picture;
  }

 private:
  struct Line {
    std::string text, place;  // in a file, or empty
  };
  std::vector<Line> lines_;
  std::size_t next_ = 0;
};

/// What a window plays: its script, and then what is dropped onto it, one after another, whatever becomes of other
/// things that are done meanwhile.
class Playlist {
 public:
  explicit Playlist(Script script) : script_(std::move(script)) {}
  /// Opens a file when its turn has come.
  void drop(const std::string& file);
  /// Carries out what can be now. Call it once a frame, after `session.update()`. A script that fails ends, and the
  /// session tells why.
  void step(Session& session);
  [[nodiscard]] bool done(const Session& session) const noexcept {
    return script_.done(session) && dropped_.done(session);
  }

 private:
  Script script_, dropped_;
};

}  // namespace armature::viewer
