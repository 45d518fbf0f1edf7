#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
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

/// Decides which collapses are done together with the cheapest one (thesis, algorithm 4).
class SimilarCollapses {
 public:
  SimilarCollapses() = default;
  virtual ~SimilarCollapses() = default;
  SimilarCollapses(const SimilarCollapses&) = delete;
  SimilarCollapses& operator=(const SimilarCollapses&) = delete;

  /// Starts a step of which the collapse of two slots is the reference. Returns how many others may be looked at.
  virtual std::size_t begin(std::uint32_t a, std::uint32_t b) = 0;
  /// How unlike the reference the collapse of two other slots is; infinite where it is not to be done with it.
  virtual double dissimilarity(std::uint32_t a, std::uint32_t b) = 0;
  /// What the dissimilarity must stay below, given all of a step, which may be put into another order.
  [[nodiscard]] virtual double threshold(std::span<double> dissimilarities) const = 0;
  /// The most that a collapse may cost, as a multiple of the reference.
  [[nodiscard]] virtual double cost_ratio() const noexcept = 0;
  /// The area of the union of two slots.
  [[nodiscard]] virtual double area(std::uint32_t a, std::uint32_t b) const = 0;
  /// Two slots became one.
  virtual void merged(std::uint32_t kept, std::uint32_t gone) = 0;
};

/// Collapses edges in the order of what they cost by a metric, which offers
///   fit(a, b)               the best placement of the union of two slots, seen from `a`: `centre()` and `cost`
///   cost(a, b, fit)         what ranks the collapse; infinite where it is forbidden
///   merge(kept, gone, fit)  gives the union, as seen from `kept`, the slot `kept`
///   position(slot)
///
/// Costs hardly ever fall when regions grow, so the cost of an edge whose ends have changed is found only when its old
/// cost, a lower bound, comes to the head of the queue (lazy evaluation: Cohen, Manocha, Olano 1997).
///
/// With `similar`, a step collapses the cheapest edge and those like it, as far as they are independent: no end of one
/// is an end or a neighbour of an end of another. Like regions cost alike, so the queue itself is the structure that
/// finds them: only what stands near its head is looked at.
template <class Metric>
class Decimation {
 public:
  Decimation(Metric& metric, CollapseComplex& complex, const DecimationOptions& options,
             SimilarCollapses* similar = nullptr)
      : metric_(metric), complex_(complex), options_(options), similar_(similar) {}

  /// Offers the edges from number `first` on to the queue.
  void offer(std::uint32_t first) {
    queue_.reserve(complex_.edge_count());
    for (std::uint32_t edge = first; edge < complex_.edge_count(); ++edge) {
      const auto [a, b] = complex_.edge(edge);
      // A region has one label, so this holds for good.
      if (!options_.labels.empty() && options_.labels[a] != options_.labels[b]) continue;
      complex_.key(edge) = key_of(metric_.cost(a, b, metric_.fit(a, b)));
      if (complex_.key(edge) < kForbidden) queue_.append(entry(edge));
    }
    queue_.arrange();
  }

  /// Collapses until `count` more collapses are done or none is left; calls `done(kept, gone)` after each. False if
  /// the task was stopped.
  template <class Done>
  bool run(std::uint32_t count, const Task& task, Done&& done);

  /// With `similar`, the collapses that were done at the end of each step.
  [[nodiscard]] const std::vector<std::uint32_t>& steps() const noexcept { return steps_; }

 private:
  using Fit = decltype(std::declval<const Metric&>().fit(0, 0));
  /// A collapse that may be done now; its edge is not in the queue.
  struct Ready {
    std::uint32_t edge = kNoIndex;
    Fit fit = {};
    double dissimilarity = 0;
    double area = 0;
    enum class State : std::uint8_t { Open, Chosen, Left } state = State::Open;
  };

  // Keys are costs as floats, whose bits are in the order of their values; what would turn triangles over comes after
  // all else, by the highest bit.
  static constexpr std::uint32_t kPenalty = 0x8000'0000U;
  static constexpr std::uint32_t kForbidden = 0x7F80'0000U;  // infinity
  static constexpr std::uint32_t kNever = 0xFFFF'FFFFU;
  static constexpr double kSame = 0.25, kSameArea = 1e-5;  // relative: how unlike copies are turned, and rounding
  static constexpr std::size_t kMostCopies = 32;
  static constexpr double kUnlike = std::numeric_limits<double>::infinity();
  enum Note : std::uint8_t {
    kStale = 1,  // its ends have changed since its cost was found
    kWaits = 2,  // not in the queue until something changes nearby
  };

  [[nodiscard]] static std::uint32_t key_of(double cost) noexcept {
    return std::bit_cast<std::uint32_t>(static_cast<float>(cost));
  }
  [[nodiscard]] std::uint64_t entry(std::uint32_t edge) const noexcept {
    return CollapseQueue::entry(complex_.key(edge), edge);
  }
  /// The cheapest collapse that may be done, unless its key is above `most`; false if there is none.
  bool take(std::uint32_t most, Ready& ready);
  /// Fills `ready_` with the cheapest collapse and those that are done with it, at most so many.
  bool take_similar(std::uint32_t most);
  [[nodiscard]] std::uint32_t dearest(std::uint32_t key) const noexcept;
  [[nodiscard]] bool independent(std::uint32_t edge) const noexcept {
    const auto [a, b] = complex_.edge(edge);
    return reserved_[a] != round_ && reserved_[b] != round_;
  }
  void reserve(std::uint32_t edge);
  [[nodiscard]] bool touch(std::uint32_t edge, std::uint32_t other) const noexcept;
  /// What costs so much more that it cannot be a copy of what has a key.
  [[nodiscard]] std::uint32_t past_copies(std::uint32_t key) const noexcept {
    return key_of(static_cast<double>(std::bit_cast<float>(key & ~kPenalty)) * (1 + kSame)) | (key & kPenalty);
  }
  /// Finds the copies of `ready_[first]` that follow it: what costs and covers the same.
  void find_copies(std::size_t first);
  CollapseComplex::Merged perform(Ready& ready);
  void refresh(const CollapseComplex::Merged& merged);
  void wake(std::uint32_t edge) {
    if ((complex_.note(edge) & kWaits) == 0) return;
    complex_.note(edge) &= static_cast<std::uint8_t>(~kWaits);
    queue_.push(entry(edge));
  }
  [[nodiscard]] bool flips(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& to) const noexcept;

  Metric& metric_;
  CollapseComplex& complex_;
  DecimationOptions options_;
  CollapseQueue queue_;  // what does not match its edge's key is void
  SimilarCollapses* similar_;
  std::vector<Ready> ready_;
  std::vector<double> dissimilarities_;
  std::vector<std::size_t> by_area_, copies_;  // places in ready_
  std::vector<std::uint32_t> reserved_;        // by slot: the last round in which it was near a chosen collapse
  std::uint32_t round_ = 0;
  std::vector<std::uint32_t> steps_;
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
    complex_.note(e) |= kStale;
    if ((complex_.key(e) & kPenalty) != 0) {
      complex_.key(e) &= ~kPenalty;
      queue_.push(entry(e));
    }
    if (!options_.keep_topology) continue;
    const auto [a, b] = complex_.edge(e);
    for (const auto near : complex_.edges_of(a == merged.slot ? b : a)) wake(near);
  }
}

template <class Metric>
bool Decimation<Metric>::take(std::uint32_t most, Ready& ready) {
  while (!queue_.empty()) {
    const std::uint32_t edge = CollapseQueue::edge_of(queue_.top());
    const std::uint32_t key = CollapseQueue::key_of(queue_.top());
    if (!complex_.alive(edge) || key != complex_.key(edge)) {
      queue_.pop();
      continue;
    }
    if (key > most) return false;
    const auto [a, b] = complex_.edge(edge);
    ready.edge = edge;
    ready.fit = metric_.fit(a, b);
    if ((complex_.note(edge) & kStale) != 0) {
      complex_.note(edge) = 0;
      complex_.key(edge) = std::max(key_of(metric_.cost(a, b, ready.fit)), key);
      if (complex_.key(edge) >= kForbidden) {
        queue_.pop();
        continue;
      }
      queue_.replace_top(entry(edge));
      if (queue_.top() != entry(edge)) continue;
    }
    if (options_.keep_topology && !complex_.keeps_topology(edge)) {
      complex_.note(edge) = kWaits;
      queue_.pop();
      continue;
    }
    if (options_.penalise_flips && (complex_.key(edge) & kPenalty) == 0 &&
        flips(a, b, metric_.position(a) + ready.fit.centre())) {
      complex_.key(edge) |= kPenalty;
      queue_.replace_top(entry(edge));
      continue;
    }
    queue_.pop();
    return true;
  }
  return false;
}

template <class Metric>
std::uint32_t Decimation<Metric>::dearest(std::uint32_t key) const noexcept {
  // Of unit area and diagonal: what moves the surface by less than a millionth is nothing.
  constexpr double kNothing = 1e-12;
  const std::uint32_t penalty = key & kPenalty;
  const auto cost = static_cast<double>(std::bit_cast<float>(key & ~kPenalty));
  return key_of(std::max(kNothing, similar_->cost_ratio() * cost)) | penalty;
}

template <class Metric>
void Decimation<Metric>::reserve(std::uint32_t edge) {
  for (const auto end : complex_.edge(edge)) {
    reserved_[end] = round_;
    for (const auto e : complex_.edges_of(end))
      for (const auto near : complex_.edge(e)) reserved_[near] = round_;
  }
}

template <class Metric>
bool Decimation<Metric>::touch(std::uint32_t edge, std::uint32_t other) const noexcept {
  for (const auto a : complex_.edge(edge))
    for (const auto b : complex_.edge(other))
      if (a == b || complex_.joined(a, b)) return true;
  return false;
}

template <class Metric>
void Decimation<Metric>::find_copies(std::size_t first) {
  const std::uint32_t past = past_copies(complex_.key(ready_[first].edge));
  const double area = ready_[first].area;
  copies_.assign(1, first);
  const auto area_of = [&](std::size_t k) { return ready_[k].area; };
  for (auto at = std::ranges::lower_bound(by_area_, (1 - kSameArea) * area, {}, area_of);
       at != by_area_.end() && area_of(*at) <= (1 + kSameArea) * area && copies_.size() < kMostCopies; ++at)
    if (*at > first && ready_[*at].state == Ready::State::Open && complex_.key(ready_[*at].edge) <= past)
      copies_.push_back(*at);
}

template <class Metric>
bool Decimation<Metric>::take_similar(std::uint32_t most) {
  ready_.resize(1);
  ready_[0].state = Ready::State::Open;
  if (!take(kNever, ready_[0])) return false;
  const auto [a, b] = complex_.edge(ready_[0].edge);
  ready_[0].area = similar_->area(a, b);
  reserved_.resize(complex_.slot_count(), 0);
  ++round_;
  reserve(ready_[0].edge);

  // What may come along, by what it costs.
  const std::size_t looks = similar_->begin(a, b);
  const std::uint32_t dear = dearest(complex_.key(ready_[0].edge));
  dissimilarities_.clear();
  const auto look = [&](std::uint32_t at_most) {
    Ready next;
    if (!take(at_most, next)) return false;
    const auto [u, v] = complex_.edge(next.edge);
    next.area = similar_->area(u, v);
    next.dissimilarity = independent(next.edge) ? similar_->dissimilarity(u, v) : kUnlike;
    if (next.dissimilarity < kUnlike) dissimilarities_.push_back(next.dissimilarity);
    ready_.push_back(next);
    return true;
  };
  while (ready_.size() <= looks && look(dear)) {
  }

  by_area_.resize(ready_.size());
  std::iota(by_area_.begin(), by_area_.end(), std::size_t{0});
  std::ranges::sort(by_area_, {}, [&](std::size_t k) { return std::pair(ready_[k].area, k); });

  // Copies come along together or not at all, so that what is alike stays alike.
  const double below = similar_->threshold(dissimilarities_);
  const auto choose = [&](Ready& ready) {
    ready.state = Ready::State::Chosen;
    reserve(ready.edge);
    --most;
  };
  choose(ready_[0]);
  find_copies(0);
  for (const std::size_t k : copies_)
    if (k > 0 && most > 0 && independent(ready_[k].edge)) choose(ready_[k]);
  for (std::size_t first = 1; first < ready_.size(); ++first) {
    if (ready_[first].state != Ready::State::Open) continue;
    find_copies(first);
    bool come = copies_.size() <= most;
    double least = kUnlike;
    for (std::size_t i = 0; i < copies_.size() && come; ++i) {
      const Ready& copy = ready_[copies_[i]];
      least = std::min(least, copy.dissimilarity);
      come = independent(copy.edge);
      for (std::size_t j = 0; j < i && come; ++j) come = !touch(copy.edge, ready_[copies_[j]].edge);
    }
    come = come && least < below;
    for (const std::size_t k : copies_) {
      if (come) {
        choose(ready_[k]);
      } else {
        ready_[k].state = Ready::State::Left;
      }
    }
  }
  const auto left = std::stable_partition(ready_.begin(), ready_.end(),
                                          [](const Ready& ready) { return ready.state == Ready::State::Chosen; });
  for (auto it = left; it != ready_.end(); ++it) queue_.push(entry(it->edge));
  ready_.erase(left, ready_.end());
  return true;
}

template <class Metric>
CollapseComplex::Merged Decimation<Metric>::perform(Ready& ready) {
  const auto [a, b] = complex_.edge(ready.edge);
  const auto merged = complex_.collapse(ready.edge);
  if (merged.slot != a) ready.fit.centre() += metric_.position(a) - metric_.position(b);
  metric_.merge(merged.slot, merged.gone, ready.fit);
  refresh(merged);
  return merged;
}

template <class Metric>
template <class Done>
bool Decimation<Metric>::run(std::uint32_t count, const Task& task, Done&& done) {
  const std::uint32_t first = complex_.steps();
  ready_.resize(1);
  while (complex_.steps() - first < count &&
         (similar_ == nullptr ? take(kNever, ready_[0]) : take_similar(first + count - complex_.steps()))) {
    for (Ready& ready : ready_) {
      const auto merged = perform(ready);
      if (similar_ != nullptr) similar_->merged(merged.slot, merged.gone);
      done(merged.slot, merged.gone);
      if ((complex_.steps() & 1023U) == 0) {
        if (task.stopped()) return false;
        task.report("decimating", static_cast<double>(complex_.steps() - first) / count);
      }
    }
    if (similar_ != nullptr) steps_.push_back(complex_.steps());
  }
  return true;
}

}  // namespace armature::sdk
