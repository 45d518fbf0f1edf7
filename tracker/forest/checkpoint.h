#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "firmware_host/error.h"
#include "tracker/forest/forest.h"

namespace armature {

/// A finished piece of a training run: the subtree that grows at this place of this tree.
struct SubtreeId {
  std::uint32_t tree = 0;
  std::uint32_t path = 0;
  friend auto operator<=>(const SubtreeId&, const SubtreeId&) = default;
};

/// Finished subtrees in a file that is only ever appended to: whatever interrupts a run costs at most the record that
/// was being written, which is dropped on reading.
///   file: char magic[8]; u32 settings_size; char settings[]; records
///   record: u32 checksum; u32 size; { u32 tree; u32 path; a tree as tree_codec.h has it }
class Checkpoint {
 public:
  /// A new file. `settings` tells runs apart whose subtrees must not be mixed.
  [[nodiscard]] static Expected<Checkpoint> create(const std::filesystem::path& path, const std::string& settings);
  /// The file of an interrupted run; one of other settings is an error.
  [[nodiscard]] static Expected<Checkpoint> resume(const std::filesystem::path& path, const std::string& settings);

  [[nodiscard]] const std::map<SubtreeId, Tree>& finished() const noexcept { return finished_; }
  [[nodiscard]] Expected<void> append(SubtreeId id, const Tree& tree);

 private:
  std::filesystem::path path_;
  std::map<SubtreeId, Tree> finished_;
};

}  // namespace armature
