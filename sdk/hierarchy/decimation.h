#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/task.h>

#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/hierarchy/collapse_queue.h"

namespace armature::sdk {

/// What may be collapsed.
struct DecimationOptions {
  bool keep_topology = false;
  bool penalise_flips = false;                 ///< collapses that turn a triangle over come last
  std::span<const std::uint32_t> labels = {};  ///< by input vertex: edges between different ones are never collapsed
};

/// Collapses edges in the order of what they cost by a metric, which offers
///   fit(a, b)               the best placement of the union of two slots, seen from `a`: `centre()` and `cost`
///   cost(a, b, fit)         what ranks the collapse; infinite where it is forbidden
///   merge(kept, gone, fit)  gives the union, as seen from `kept`, the slot `kept`
///   position(slot)
///
/// Costs hardly ever fall when regions grow, so the cost of an edge whose ends have changed is found only when its old
/// cost, a lower bound, comes to the head of the queue (lazy evaluation: Cohen, Manocha, Olano 1997).
template <class Metric>
class Decimation {
 public:
  Decimation(Metric& metric, CollapseComplex& complex, const DecimationOptions& options)
      : metric_(metric), complex_(complex), options_(options) {}

  /// Offers the edges from number `first` on to the queue.
  void offer(std::uint32_t first) {
    keys_.resize(complex_.edge_count());
    state_.resize(complex_.edge_count(), 0);
    queue_.reserve(complex_.edge_count());
    for (std::uint32_t edge = first; edge < complex_.edge_count(); ++edge) {
      const auto [a, b] = complex_.edge(edge);
      // A region has one label, so this holds for good.
      if (!options_.labels.empty() && options_.labels[a] != options_.labels[b]) continue;
      keys_[edge] = key_of(metric_.cost(a, b, metric_.fit(a, b)));
      if (keys_[edge] < kForbidden) queue_.append(entry(edge));
    }
    queue_.arrange();
  }

  /// Collapses until `count` more collapses are done or none is left; calls `done(kept, gone)` after each. False if
  /// the task was stopped.
  template <class Done>
  bool run(std::uint32_t count, const Task& task, Done&& done);

 private:
  // Keys are costs as floats, whose bits are in the order of their values; what would turn triangles over comes after
  // all else, by the highest bit.
  static constexpr std::uint32_t kPenalty = 0x8000'0000U;
  static constexpr std::uint32_t kForbidden = 0x7F80'0000U;  // infinity
  enum State : std::uint8_t {
    kStale = 1,  // its ends have changed since its cost was found
    kWaits = 2,  // not in the queue until something changes nearby
  };

  [[nodiscard]] static std::uint32_t key_of(double cost) noexcept {
    return std::bit_cast<std::uint32_t>(static_cast<float>(cost));
  }
  [[nodiscard]] std::uint64_t entry(std::uint32_t edge) const noexcept {
    return CollapseQueue::entry(keys_[edge], edge);
  }
  void refresh(const CollapseComplex::Merged& merged);
  void wake(std::uint32_t edge) {
    if ((state_[edge] & kWaits) == 0) return;
    state_[edge] &= static_cast<std::uint8_t>(~kWaits);
    queue_.push(entry(edge));
  }
  [[nodiscard]] bool flips(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& to) const noexcept;

  Metric& metric_;
  CollapseComplex& complex_;
  DecimationOptions options_;
  std::vector<std::uint32_t> keys_;  // by edge
  std::vector<std::uint8_t> state_;  // by edge
  CollapseQueue queue_;              // what does not match keys_ is void
};

template <class Metric>
bool Decimation<Metric>::flips(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& to) const noexcept {
  const auto turns = [&](std::uint32_t moved, std::uint32_t other) {
    const Eigen::Vector3d& from = metric_.position(moved);
    for (const auto t : complex_.triangles_of(moved)) {
      const auto& c = complex_.triangle(t);
      const std::size_t at = c[0] == moved ? 0 : c[1] == moved ? 1 : 2;
      const std::uint32_t y = c[(at + 1) % 3];
      const std::uint32_t z = c[(at + 2) % 3];
      if (y == other || z == other) continue;
      const Eigen::Vector3d& p = metric_.position(y);
      const Eigen::Vector3d side = metric_.position(z) - p;
      if (side.cross(from - p).dot(side.cross(to - p)) < 0) return true;
    }
    return false;
  };
  return turns(a, b) || turns(b, a);
}

template <class Metric>
void Decimation<Metric>::refresh(const CollapseComplex::Merged& merged) {
  for (const auto e : merged.edges) {
    state_[e] |= kStale;
    if ((keys_[e] & kPenalty) != 0) {
      keys_[e] &= ~kPenalty;
      queue_.push(entry(e));
    }
    if (!options_.keep_topology) continue;
    const auto [a, b] = complex_.edge(e);
    for (const auto near : complex_.edges_of(a == merged.slot ? b : a)) wake(near);
  }
}

template <class Metric>
template <class Done>
bool Decimation<Metric>::run(std::uint32_t count, const Task& task, Done&& done) {
  const std::uint32_t first = complex_.steps();
  while (complex_.steps() - first < count && !queue_.empty()) {
    const std::uint32_t edge = CollapseQueue::edge_of(queue_.top());
    const std::uint32_t key = CollapseQueue::key_of(queue_.top());
    if (!complex_.alive(edge) || key != keys_[edge]) {
      queue_.pop();
      continue;
    }
    const auto [a, b] = complex_.edge(edge);
    auto best = metric_.fit(a, b);
    if ((state_[edge] & kStale) != 0) {
      state_[edge] = 0;
      keys_[edge] = std::max(key_of(metric_.cost(a, b, best)), key);
      if (keys_[edge] >= kForbidden) {
        queue_.pop();
        continue;
      }
      queue_.replace_top(entry(edge));
      if (queue_.top() != entry(edge)) continue;
    }
    if (options_.keep_topology && !complex_.keeps_topology(edge)) {
      state_[edge] = kWaits;
      queue_.pop();
      continue;
    }
    if (options_.penalise_flips && (keys_[edge] & kPenalty) == 0 && flips(a, b, metric_.position(a) + best.centre())) {
      keys_[edge] |= kPenalty;
      queue_.replace_top(entry(edge));
      continue;
    }
    queue_.pop();

    const auto merged = complex_.collapse(edge, keys_);
    if (merged.slot != a) best.centre() += metric_.position(a) - metric_.position(b);
    metric_.merge(merged.slot, merged.gone, best);
    refresh(merged);
    done(merged.slot, merged.gone);
    if ((complex_.steps() & 1023U) == 0) {
      if (task.stopped()) return false;
      task.report("decimating", static_cast<double>(complex_.steps() - first) / count);
    }
  }
  return true;
}

}  // namespace armature::sdk
