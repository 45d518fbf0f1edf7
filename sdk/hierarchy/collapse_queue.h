#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace armature::sdk {

/// Edges in the order of their keys, of equal ones in the order of their numbers. Only about the least eighth stands in
/// a heap, which so stays in the fast memory; the others wait in no order until it is empty. The heap has four children
/// a node: half as deep as one of two, and siblings share a cache line. What was taken out in order and is put back
/// stands on a stack beside it.
class CollapseQueue {
 public:
  [[nodiscard]] static std::uint64_t entry(std::uint32_t key, std::uint32_t edge) noexcept {
    return (std::uint64_t{key} << 32) | edge;
  }
  [[nodiscard]] static std::uint32_t key_of(std::uint64_t entry) noexcept {
    return static_cast<std::uint32_t>(entry >> 32);
  }
  [[nodiscard]] static std::uint32_t edge_of(std::uint64_t entry) noexcept { return static_cast<std::uint32_t>(entry); }

  [[nodiscard]] bool empty() const noexcept { return heap_.empty() && back_.empty(); }
  [[nodiscard]] std::uint64_t top() const noexcept { return from_back() ? back_.back() : heap_.front(); }

  void reserve(std::size_t size) { far_.reserve(size); }
  /// Adds without order; `arrange` must follow.
  void append(std::uint64_t entry) { far_.push_back(entry); }
  void arrange() {
    far_.insert(far_.end(), heap_.begin(), heap_.end());
    heap_.clear();
    refill();
  }
  void push(std::uint64_t entry) {
    if (entry >= end_) {
      far_.push_back(entry);
      if (heap_.empty()) refill();
      return;
    }
    heap_.push_back(entry);
    std::size_t at = heap_.size() - 1;
    for (; at > 0 && entry < heap_[(at - 1) / kChildren]; at = (at - 1) / kChildren)
      heap_[at] = heap_[(at - 1) / kChildren];
    heap_[at] = entry;
  }
  /// Adds what was taken out before: at little cost if the greatest comes first.
  void put_back(std::uint64_t entry) {
    if (back_.empty() || entry <= back_.back())
      back_.push_back(entry);
    else
      push(entry);
  }
  void pop() {
    if (from_back()) {
      back_.pop_back();
      return;
    }
    const std::uint64_t last = heap_.back();
    heap_.pop_back();
    if (!heap_.empty())
      sink(0, last);
    else
      refill();
  }
  /// Puts another entry in the place of the first.
  void replace_top(std::uint64_t entry) {
    if (from_back()) {
      back_.pop_back();
      push(entry);
    } else if (entry < end_) {
      sink(0, entry);
    } else {
      far_.push_back(entry);
      pop();
    }
  }

 private:
  static constexpr std::size_t kChildren = 4, kSample = 64, kLeast = 1024;

  /// Whether the first is the one that was put back last.
  [[nodiscard]] bool from_back() const noexcept {
    return !back_.empty() && (heap_.empty() || back_.back() < heap_.front());
  }
  /// Takes about the least eighth of the far into the empty heap, by a sample of them.
  void refill() {
    end_ = std::numeric_limits<std::uint64_t>::max();
    if (far_.size() >= kLeast) {
      std::array<std::uint64_t, kSample> sample;
      for (std::size_t k = 0; k < kSample; ++k) sample[k] = far_[k * (far_.size() / kSample)];
      std::nth_element(sample.begin(), sample.begin() + kSample / 8, sample.end());
      end_ = sample[kSample / 8] + 1;  // at least that one goes
    }
    const auto first = std::partition(far_.begin(), far_.end(), [&](std::uint64_t entry) { return entry >= end_; });
    heap_.assign(first, far_.end());
    far_.erase(first, far_.end());
    heapify();
  }
  void heapify() noexcept {
    if (heap_.size() < 2) return;
    for (std::size_t at = (heap_.size() - 2) / kChildren + 1; at-- > 0;) sink(at, heap_[at]);
  }

  void sink(std::size_t at, std::uint64_t entry) noexcept {
    const std::size_t size = heap_.size();
    std::uint64_t* const heap = heap_.data();
    std::size_t child = kChildren * at + 1;
    for (; child + kChildren <= size; child = kChildren * at + 1) {
      // Which of four is least is chance: selected without a branch.
      const std::size_t low = child + (heap[child + 1] < heap[child] ? 1 : 0);
      const std::size_t high = child + 2 + (heap[child + 3] < heap[child + 2] ? 1 : 0);
      const std::size_t least = heap[high] < heap[low] ? high : low;
      if (entry <= heap[least]) {
        heap[at] = entry;
        return;
      }
      heap[at] = heap[least];
      at = least;
    }
    if (child < size) {
      const std::size_t least = static_cast<std::size_t>(std::min_element(heap + child, heap + size) - heap);
      if (heap[least] < entry) {
        heap[at] = heap[least];
        at = least;
      }
    }
    heap[at] = entry;
  }

  std::vector<std::uint64_t> heap_;  // what is less than end_
  std::vector<std::uint64_t> far_;   // the others, in no order
  std::vector<std::uint64_t> back_;  // what was put back, the least last
  std::uint64_t end_ = 0;
};

}  // namespace armature::sdk
