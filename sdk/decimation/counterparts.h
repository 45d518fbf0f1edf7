#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

#include "sdk/hierarchy/collapse_complex.h"

namespace armature::sdk {

/// What corresponds before anything is joined.
struct Correspondence {
  std::vector<std::uint32_t>
      classes;  ///< by vertex: vertices of a class correspond; kNoIndex for what has no counterpart
  std::vector<std::uint32_t> copies;  ///< by vertex: which copy of a component it is of; kNoIndex for none
  std::vector<std::uint32_t> models;  ///< by copy: what it is a copy of
};

/// Which vertices correspond: those of components that lie on one another once they are moved, turned or mirrored, and
/// those of a component that does so with itself. Vertices correspond where each is the closest to where the other
/// comes to lie; what a mirror leaves where it is has itself. By vertex a class of its own kind; kNoIndex for what has
/// no counterpart. Turns are those that lay principal axes onto one another, and none; so shapes that have no principal
/// axes, as a ball, are found only shifted.
[[nodiscard]] Expected<Correspondence> find_correspondence(const Mesh& mesh, const Task& task);

/// Keeps track of which regions correspond while they are joined. A region's kind is the sum of numbers drawn for the
/// classes of its vertices (Zobrist 1970), so that regions correspond if they hold the same classes, however they came
/// about.
class Counterparts {
 public:
  explicit Counterparts(const Correspondence& correspondence);

  /// Whether there is anything to keep track of.
  [[nodiscard]] bool empty() const noexcept { return kinds_.empty(); }
  /// What slots are of, 0 if they hold nothing that has a counterpart: by slot, valid as long as this is; empty if
  /// nothing corresponds to anything.
  [[nodiscard]] std::span<const std::uint64_t> kinds() const noexcept { return kinds_; }
  /// The slots of the kind of one whose kind is not 0, in no order that matters.
  [[nodiscard]] std::span<const std::uint32_t> like(std::uint32_t slot) const { return lists_[list_[slot]]; }
  /// Two slots became one.
  void merge(std::uint32_t kept, std::uint32_t gone);
  /// Slots of another kind that hold what corresponds to something in a slot: all that together could become its like.
  /// Valid until the next call. Every walk past what corresponds is taken from `walks`; without any left it ends.
  std::span<const std::uint32_t> behind(std::uint32_t slot, std::size_t& walks);
  /// The slot that what was in a slot at first is in now.
  [[nodiscard]] std::uint32_t holder(std::uint32_t slot) noexcept;

  /// The copy of a component that a slot is of; kNoIndex for none, or once one of its copies was joined to something
  /// else.
  [[nodiscard]] std::uint32_t copy(std::uint32_t slot) const noexcept {
    if (kinds_.empty() || copy_[slot] == kNoIndex || joined_[model_[copy_[slot]]]) return kNoIndex;
    return copy_[slot];
  }
  /// All copies of what a copy is one of.
  [[nodiscard]] std::span<const std::uint32_t> copies_like(std::uint32_t copy) const { return copies_[model_[copy]]; }
  /// Whether one of them was joined to something else.
  [[nodiscard]] bool joined(std::uint32_t copy) const { return joined_[model_[copy]]; }
  /// Whether all of them have equally many slots.
  [[nodiscard]] bool even(std::uint32_t copy) const {
    const Left& left = least_[model_[copy]];
    return left.copies == copies_[model_[copy]].size();
  }
  /// The fewest slots that one of them has.
  [[nodiscard]] std::uint32_t least(std::uint32_t copy) const { return least_[model_[copy]].slots; }
  /// How many slots a copy has more than the least of those like it.
  [[nodiscard]] std::uint32_t surplus(std::uint32_t copy) const { return left_[copy] - least_[model_[copy]].slots; }

 private:
  /// The fewest slots that a copy of a model has, and how many copies have so few.
  struct Left {
    std::uint32_t slots = kNoIndex;
    std::size_t copies = 0;
  };

  void add(std::uint32_t slot);
  void remove(std::uint32_t slot);
  /// A copy has so many slots, fewer than before.
  void count(std::uint32_t copy);

  std::vector<std::uint64_t> kinds_;                           // by slot; empty if no vertices correspond
  std::vector<std::vector<std::uint32_t>> lists_;              // of slots of one kind
  std::unordered_map<std::uint64_t, std::uint32_t> lists_of_;  // by kind
  std::vector<std::uint32_t> free_lists_;
  std::vector<std::uint32_t> list_;   // by slot: that of its kind
  std::vector<std::uint32_t> place_;  // by slot: where it stands in it
  std::vector<std::uint32_t> into_;   // by slot: chains that end at one in use
  std::vector<std::uint32_t> holds_;  // by slot: a vertex in it that has counterparts; kNoIndex for none
  std::vector<std::uint32_t> next_;   // by vertex: the next of its class, in a ring
  std::vector<std::uint32_t> behind_;
  std::vector<std::uint32_t> copy_;                 // by slot
  std::vector<std::uint32_t> model_;                // by copy
  std::vector<std::vector<std::uint32_t>> copies_;  // by model
  std::vector<std::uint32_t> left_;                 // slots, by copy
  std::vector<Left> least_;                         // by model
  std::vector<bool> joined_;                        // to something else, by model
};

}  // namespace armature::sdk
