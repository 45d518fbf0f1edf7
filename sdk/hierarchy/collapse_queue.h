#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace armature::sdk {

/// Edges in the order of their keys, of equal ones in the order of their numbers. A heap of four children a node: half
/// as deep as one of two, and siblings share a cache line.
class CollapseQueue {
 public:
  [[nodiscard]] static std::uint64_t entry(std::uint32_t key, std::uint32_t edge) noexcept {
    return (std::uint64_t{key} << 32) | edge;
  }
  [[nodiscard]] static std::uint32_t key_of(std::uint64_t entry) noexcept {
    return static_cast<std::uint32_t>(entry >> 32);
  }
  [[nodiscard]] static std::uint32_t edge_of(std::uint64_t entry) noexcept { return static_cast<std::uint32_t>(entry); }

  [[nodiscard]] bool empty() const noexcept { return heap_.empty(); }
  [[nodiscard]] std::uint64_t top() const noexcept { return heap_.front(); }

  void reserve(std::size_t size) { heap_.reserve(size); }
  /// Adds without order; `arrange` must follow.
  void append(std::uint64_t entry) { heap_.push_back(entry); }
  void arrange() noexcept {
    if (heap_.size() < 2) return;
    for (std::size_t at = (heap_.size() - 2) / kChildren + 1; at-- > 0;) sink(at, heap_[at]);
  }
  void push(std::uint64_t entry) {
    heap_.push_back(entry);
    std::size_t at = heap_.size() - 1;
    for (; at > 0 && entry < heap_[(at - 1) / kChildren]; at = (at - 1) / kChildren)
      heap_[at] = heap_[(at - 1) / kChildren];
    heap_[at] = entry;
  }
  void pop() noexcept {
    const std::uint64_t last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty()) sink(0, last);
  }
  /// Puts another entry in the place of the first.
  void replace_top(std::uint64_t entry) noexcept { sink(0, entry); }

 private:
  static constexpr std::size_t kChildren = 4;

  void sink(std::size_t at, std::uint64_t entry) noexcept {
    const std::size_t size = heap_.size();
    for (std::size_t child = kChildren * at + 1; child < size; child = kChildren * at + 1) {
      const auto first = heap_.begin() + static_cast<std::ptrdiff_t>(child);
      const auto least =
          std::min_element(first, first + static_cast<std::ptrdiff_t>(std::min(kChildren, size - child)));
      if (entry <= *least) break;
      heap_[at] = *least;
      at = static_cast<std::size_t>(least - heap_.begin());
    }
    heap_[at] = entry;
  }

  std::vector<std::uint64_t> heap_;
};

}  // namespace armature::sdk
