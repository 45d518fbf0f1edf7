#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tracker/forest/checkpoint.h"
#include "tracker/forest/ranks.h"

namespace armature {

/// The checkpoint of several ranks: its file is with rank 0, what is in it and what went wrong all of them know.
/// Functions that return something are called by all ranks together.
class SharedCheckpoint {
 public:
  /// As Checkpoint::create() and resume(); without a path nothing is kept.
  [[nodiscard]] static Expected<SharedCheckpoint> open(const std::filesystem::path& path, bool resume,
                                                       const std::string& settings, Ranks& ranks);

  [[nodiscard]] std::optional<Tree> finished(SubtreeId id) const;
  /// Keeps a subtree. A failure is remembered for the next status().
  void append(SubtreeId id, const Tree& tree);
  [[nodiscard]] Expected<void> status() const;

 private:
  explicit SharedCheckpoint(Ranks& ranks) : ranks_(&ranks) {}
  Ranks* ranks_;
  std::optional<Checkpoint> file_;
  Expected<void> status_;  // of rank 0
};

}  // namespace armature
