#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <armature/sdk/error.h>

#include "viewer/session/session.h"

namespace armature::viewer {

/// Lines that are carried out one after another, each when the work of those before it is done. A line that begins with
/// `try` may fail.
class Script {
 public:
  Script() = default;
  explicit Script(std::vector<std::string> lines) : lines_(std::move(lines)) {}
  /// Fails where the file cannot be read.
  [[nodiscard]] static sdk::Expected<Script> read(const std::filesystem::path& path);

  /// Another script's lines after these; what fails is named as that one is.
  void append(Script other);

  /// Carries out what can be now; fails, with the file and the line, where a line or its work failed. Call it once a
  /// frame, after `session.update()`.
  [[nodiscard]] sdk::Expected<void> step(Session& session);
  [[nodiscard]] bool done(const Session& session) const noexcept {
    return next_ == lines_.size() && !session.busy() && !session.picture;
  }

 private:
  std::string name_ = "the script";
  std::vector<std::string> lines_;
  std::size_t next_ = 0;
  std::size_t before_ = 0;  // lines of others
};

}  // namespace armature::viewer
