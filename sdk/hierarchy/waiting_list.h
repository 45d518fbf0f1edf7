#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace armature::sdk {

/// Entries of a CollapseQueue that wait outside of it, the cheapest at hand. What no longer waits is left in the list
/// until it comes to the head.
class WaitingList {
 public:
  void add(std::uint64_t entry) {
    heap_.push_back(entry);
    std::ranges::push_heap(heap_, std::greater{});
  }
  /// The cheapest that still waits; nothing if none does.
  template <class Waits>
  std::optional<std::uint64_t> cheapest(const Waits& waits) {
    while (!heap_.empty() && !waits(heap_.front())) {
      std::ranges::pop_heap(heap_, std::greater{});
      heap_.pop_back();
    }
    return heap_.empty() ? std::nullopt : std::optional(heap_.front());
  }
  /// Empties the list: all that was in it, in no order.
  [[nodiscard]] std::vector<std::uint64_t> release() { return std::exchange(heap_, {}); }

 private:
  std::vector<std::uint64_t> heap_;
};

}  // namespace armature::sdk
