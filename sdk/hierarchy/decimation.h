#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>
#include <numeric>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/task.h>

#include "sdk/hierarchy/collapse_complex.h"
#include "sdk/hierarchy/collapse_queue.h"
#include "sdk/hierarchy/waiting_list.h"

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

  /// Starts a step of which the collapse of two slots is the reference.
  virtual void begin(std::uint32_t a, std::uint32_t b) = 0;
  /// How unlike the reference the collapse of two other slots is; infinite where it is not to be done with it.
  virtual double dissimilarity(std::uint32_t a, std::uint32_t b) = 0;
  /// How many others may be looked at.
  [[nodiscard]] virtual std::size_t looks() const noexcept = 0;
  /// So many of them were looked at.
  virtual void look(std::size_t count) = 0;
  /// Whether what dissimilarities must stay below depends on all of a step; else all finite ones are below it.
  [[nodiscard]] virtual bool ranks() const noexcept = 0;
  /// If so, that, given all of a step, which may be put into another order.
  [[nodiscard]] virtual double threshold(std::span<double> dissimilarities) const = 0;
  /// The most that a collapse may cost, as a multiple of the reference.
  [[nodiscard]] virtual double cost_ratio() const noexcept = 0;
  /// By slot what it corresponds to: slots of the same kind do. 0 for what has no counterpart; empty if nothing has.
  /// Valid for good.
  [[nodiscard]] virtual std::span<const std::uint64_t> kinds() const noexcept = 0;
  /// The slots of the kind of one whose kind is not 0.
  [[nodiscard]] virtual std::span<const std::uint32_t> slots_like(std::uint32_t slot) const = 0;
  /// Two slots became one.
  virtual void merged(std::uint32_t kept, std::uint32_t gone) = 0;
  /// Slots of another kind that hold what corresponds to something in a slot, as far as walking past that, one by one,
  /// uses up `walks`; valid until the next call.
  virtual std::span<const std::uint32_t> behind(std::uint32_t slot, std::size_t& walks) = 0;
  /// What a slot that was merged, or what it was merged into, is part of now.
  virtual std::uint32_t holder(std::uint32_t slot) = 0;
  /// The copy of a component that a slot is of, if its copies are to have equally many slots; kNoIndex for none.
  [[nodiscard]] virtual std::uint32_t copy(std::uint32_t slot) const noexcept = 0;
  /// All copies of what a copy is one of, ascending.
  [[nodiscard]] virtual std::span<const std::uint32_t> copies_like(std::uint32_t copy) const = 0;
  /// Whether one of them was joined to something else.
  [[nodiscard]] virtual bool joined(std::uint32_t copy) const = 0;
  /// Whether all of them have equally many slots.
  [[nodiscard]] virtual bool even(std::uint32_t copy) const = 0;
  /// The fewest slots that one of them has.
  [[nodiscard]] virtual std::uint32_t least(std::uint32_t copy) const = 0;
  /// How many slots a copy has more than the least of those like it.
  [[nodiscard]] virtual std::uint32_t surplus(std::uint32_t copy) const = 0;
};

/// Collapses edges in the order of what they cost by a metric, which offers
///   fit(a, b)               the best placement of the union of two slots, seen from `a`: `centre()` and `cost`
///   width(a, b)             what bounds it; with `similar` alone
///   fit(a, b, width)        the same for another bound; as well
///   cost(a, b, fit)         what ranks the collapse; infinite where it is forbidden
///   cost(slots)             the same of several slots that become one; as well
///   merge(kept, gone, fit)  gives the union, as seen from `kept`, the slot `kept`
///   position(slot)
///
/// Costs hardly ever fall when regions grow, so the cost of an edge whose ends have changed is found only when its old
/// cost, a lower bound, comes to the head of the queue (lazy evaluation: Cohen, Manocha, Olano 1997).
///
/// With `similar`, a step collapses the cheapest edge and those like it, as far as they are independent: no end of one
/// is an end or a neighbour of an end of another. Like regions cost alike, so the queue itself is the structure that
/// finds them: only what stands near its head is looked at, and next to everything of it many times, so that fits and
/// what turned no triangle over are remembered. Edges whose ends correspond go together or not at all, when the dearest
/// of them is due, or the union of what those join that share ends; these alone need not be independent, and go one
/// after another. `similar_steps.h` holds how.
template <class Metric>
class Decimation {
 public:
  Decimation(Metric& metric, CollapseComplex& complex, const DecimationOptions& options,
             SimilarCollapses* similar = nullptr)
      : metric_(metric), complex_(complex), options_(options), similar_(similar) {
    if (similar_ != nullptr) kinds_ = similar_->kinds();
  }

  /// Offers the edges from number `first` on to the queue.
  void offer(std::uint32_t first) {
    queue_.reserve(complex_.edge_count());
    if (similar_ != nullptr) {
      memos_.resize(complex_.edge_count());
      changes_.resize(complex_.slot_count());
    }
    for (std::uint32_t edge = first; edge < complex_.edge_count(); ++edge) {
      const auto [a, b] = complex_.edge(edge);
      // A region has one label, so this holds for good.
      if (!options_.labels.empty() && options_.labels[a] != options_.labels[b]) continue;
      Fit fit = metric_.fit(a, b);
      complex_.key(edge) = key_of(metric_.cost(a, b, fit));
      if (!memos_.empty()) memos_[edge].centre = fit.centre();
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
  /// A collapse that may be done now.
  struct Ready {
    std::uint32_t edge = kNoIndex;
    Fit fit = {};
    bool fitted = false;               // else the fit is found when it is needed
    CollapseComplex::Pair slots = {};  // where one before it in the step may change it: its ends
    bool touches = false;              // so
  };
  /// What a step leaves to the next.
  struct Left {
    std::uint32_t edge;           // which may become one with another
    CollapseComplex::Pair slots;  // its ends, which may be merged
  };
  /// Collapses of edges whose ends correspond, in `ready_`.
  struct Group {
    std::size_t first = 0, count = 0;
    double dissimilarity = kUnlike;
    bool chosen = false;
    bool whole = false;             // every slot of either kind has a member
    bool touches = false;           // members are near one another
    std::uint32_t copy = kNoIndex;  // that loses a slot by it which others like it keep
  };

  /// What is remembered of an edge, as steps look again at what others have left.
  struct alignas(32) Memo {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of its fit when its cost was found
    std::uint32_t upright = 0;                         // the first collapse that may have it turn a triangle over
  };
  /// The last collapses that changed a slot, and one that it is joined to.
  struct Change {
    std::uint32_t self = 0, near = 0;
  };

  /// Slots that are marked until the next round, early in it or late.
  struct Marks {
    enum When : std::uint32_t { Early, Late };
    std::vector<std::uint32_t> rounds;  // by slot: the last round in which it was marked, and when
    std::uint32_t round = 0;            // even

    void next(std::size_t slots) {
      rounds.resize(slots, 0);
      round += 2;
    }
    [[nodiscard]] bool either(const CollapseComplex::Pair& slots) const noexcept {
      return rounds[slots[0]] >= round || rounds[slots[1]] >= round;
    }
    [[nodiscard]] bool early(const CollapseComplex::Pair& slots) const noexcept {
      return rounds[slots[0]] == round || rounds[slots[1]] == round;
    }
    /// Marks the ends of an edge and all that they are joined to.
    void around(const CollapseComplex& complex, std::uint32_t edge, When when);
  };

  // Keys are costs as floats, whose bits are in the order of their values; what would turn triangles over comes after
  // all else, by the highest bit.
  static constexpr std::uint32_t kPenalty = 0x8000'0000U;
  static constexpr std::uint32_t kForbidden = 0x7F80'0000U;  // infinity
  static constexpr std::uint32_t kNever = 0xFFFF'FFFFU;
  // What has not all of its counterparts, or may not be done with them, waits until it has cost so many times; and
  // again, from there on, whenever an end has grown.
  static constexpr double kPatience = 4;
  // Every collapse earns so many walks past a slot that is like another: with few copies as many as are asked for, with
  // thousands of them so many that the time grows with the number of collapses alone.
  static constexpr std::size_t kFirstWalks = 1024, kWalksEarned = 16;
  static constexpr std::uint32_t kEven = kNoIndex - 1;  // of least_
  static constexpr double kUnlike = std::numeric_limits<double>::infinity();
  enum Note : std::uint8_t {
    Stale = 1,   // its ends have changed since its cost was found
    Waits = 2,   // not in the queue until something changes nearby
    Taken = 4,   // in a group of this step
    Out = 8,     // so, and no longer in the queue
    Alone = 16,  // has waited for counterparts in vain
    Rest = 32,   // in rest_
    Pairs = 64   // in waiting_, not in the queue
  };

  [[nodiscard]] static std::uint32_t key_of(double cost) noexcept {
    return std::bit_cast<std::uint32_t>(static_cast<float>(cost));
  }
  [[nodiscard]] std::uint64_t entry(std::uint32_t edge) const noexcept {
    return CollapseQueue::entry(complex_.key(edge), edge);
  }
  /// Whether the task was stopped, now and then asked in the midst of a step.
  [[nodiscard]] bool to_stop() {
    stopped_ = stopped_ || ((++tried_ & 1023U) == 0 && task_->stopped());
    return stopped_;
  }
  /// The cheapest collapse that may be done, unless its key is above `most`; false if there is none.
  bool take(std::uint32_t most, Ready& ready);
  /// Fills `ready_` with the cheapest collapse and those that are done with it, at most so many.
  bool take_similar(std::uint32_t most);
  /// Appends the group of a collapse that was taken from the queue: those of all edges whose ends correspond to its, if
  /// it is independent.
  void open_group(const Ready& ready);
  /// Whether the last group is due. If so, it holds what may be done; else it is put back into the queue, or waits.
  bool due();
  /// Keeps the members of the last group from being taken again in this step.
  void close_group();
  /// The edge that something left is now; kNoIndex if its ends are one.
  [[nodiscard]] std::uint32_t edge_of(const Left& left);
  /// Appends what the last step left to do, as far as it is independent; false if there is none.
  bool take_rest(std::uint32_t most);
  /// Appends the group of the cheapest collapse as far as it is independent, and leaves the rest of it to the next
  /// step; false if there is none.
  bool take_first(std::uint32_t most);
  /// Takes note of the copies that an edge's collapse takes a slot from.
  void thin(std::uint32_t edge);
  /// Has slots joined next that together become what corresponds to one that the step made.
  void catch_up();
  /// Has an edge collapsed in the next step.
  void postpone(std::uint32_t edge) {
    if ((complex_.note(edge) & Rest) != 0) return;
    complex_.note(edge) |= Rest;
    rest_.push_back({edge, complex_.edge(edge)});
  }
  /// Appends to `ready_` all edges between slots of the kinds of an edge's ends, but itself; whether each of those
  /// slots has one; false as well where there are no walks left to tell.
  bool gather(std::uint32_t edge);
  /// Finds what a collapse costs that is not at the head of the queue; false if it may not be done.
  bool evaluate(std::uint32_t edge, Ready& ready);
  /// The key of what members cost that share ends: of making one of all that they join.
  [[nodiscard]] std::uint32_t joint_key(std::span<const Ready> members) const;
  /// Finds fits of what corresponds, as if all were as wide as they are on average; the key of the dearest.
  std::uint32_t fit_alike(std::span<Ready> members);
  /// Has the collapse that is last in `ready_`, of one copy alone, wait for one of each other. Whether they are there:
  /// then they are in `ready_`, from where it was on.
  bool pair_up(std::uint32_t copy);
  /// The cheapest that waits, as it may be done now; nothing if none does.
  [[nodiscard]] std::optional<Ready> cheapest(WaitingList& list);
  [[nodiscard]] bool waits(std::uint64_t e) const noexcept {
    const std::uint32_t edge = CollapseQueue::edge_of(e);
    return complex_.alive(edge) && (complex_.note(edge) & Pairs) != 0 && entry(edge) == e;
  }
  /// Appends to `ready_` what has waited.
  void stop_waiting(const Ready& ready);
  /// Puts back into the queue what waits of a copy and those like it.
  void wake_copies(std::uint32_t copy);
  /// Puts back into the queue what waits where slots of copies were joined so that it no longer should.
  void settle();
  /// Appends the group of the cheapest that waits for one of each other copy, if it has waited long enough or nothing
  /// else is left to do.
  bool take_waiting(std::uint32_t key);
  /// How many slots the step takes from a copy that has more than others.
  std::uint32_t& gives(std::uint32_t copy) {
    gives_.resize(std::max<std::size_t>(gives_.size(), copy + 1), 0);
    return gives_[copy];
  }
  /// What a slot is of; 0 for what has no counterpart.
  [[nodiscard]] std::uint64_t kind(std::uint32_t slot) const noexcept { return kinds_.empty() ? 0 : kinds_[slot]; }
  /// The copy that an edge alone would take a slot from; kNoIndex for none.
  [[nodiscard]] std::uint32_t copy_of(std::uint32_t edge) const {
    const auto [a, b] = complex_.edge(edge);
    const std::uint32_t copy = similar_->copy(a);
    return copy == similar_->copy(b) ? copy : kNoIndex;
  }
  /// Chooses a group if all of it is independent, and of one another.
  void choose_whole(Group& group, std::uint32_t& most);
  void give_back(std::uint32_t edge);
  [[nodiscard]] std::uint32_t dearest(std::uint32_t key) const noexcept;
  /// The key that a collapse waits for in vain.
  [[nodiscard]] static std::uint32_t patient(std::uint32_t key) noexcept;
  [[nodiscard]] bool independent(std::uint32_t edge) const noexcept { return !reserved_.either(complex_.edge(edge)); }
  /// Finds the fit of a collapse.
  void fit(Ready& ready) const;
  /// Finds the cost of a collapse whose ends have changed; its key.
  std::uint32_t renew_cost(Ready& ready);
  /// Whether a collapse turns a triangle over.
  [[nodiscard]] bool turns(Ready& ready);
  /// Whether none of them is near another.
  [[nodiscard]] bool apart(std::span<const Ready> members);
  /// Makes a collapse fit what those before it in the step have changed nearby; false if it may not be done any more.
  [[nodiscard]] bool renew(Ready& ready);
  CollapseComplex::Merged perform(Ready& ready);
  void refresh(const CollapseComplex::Merged& merged);
  void wake(std::uint32_t edge) {
    if ((complex_.note(edge) & Waits) == 0) return;
    complex_.note(edge) &= static_cast<std::uint8_t>(~Waits);
    queue_.push(entry(edge));
  }
  /// Whether a triangle of either slot is turned over if they come to lie at `to`: of those alone that a collapse from
  /// number `since` on has changed; 0 for all.
  [[nodiscard]] bool flips(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& to,
                           std::uint32_t since) const noexcept;

  Metric& metric_;
  CollapseComplex& complex_;
  DecimationOptions options_;
  CollapseQueue queue_;  // what does not match its edge's key is void
  SimilarCollapses* similar_;
  std::span<const std::uint64_t> kinds_;  // of `similar`
  std::vector<Ready> ready_;
  std::vector<Group> groups_;
  std::vector<double> dissimilarities_;
  std::size_t walks_ = kFirstWalks;  // that may still be done
  std::vector<Left> rest_;
  std::vector<WaitingList> waiting_of_;  // by copy: for one of each other
  std::unordered_map<std::uint32_t, std::uint32_t>
      lacks_;                           // by the first of copies alike: which of them pair_up() asks first
  WaitingList waiting_;                 // the same
  std::vector<std::uint32_t> ends_;     // of gather()
  std::vector<std::uint32_t> least_;    // by the first of copies alike: how settle() left them
  std::vector<std::uint32_t> thinned_;  // copies that lost a slot in this step
  std::vector<std::uint32_t> gives_;    // by copy: slots that a step takes from it alone
  std::vector<std::pair<std::uint64_t, std::uint32_t>> made_;  // in this step: kinds and slots
  Marks reserved_;                                             // near a chosen collapse
  Marks near_;                                                 // of apart()
  std::vector<Memo> memos_;                                    // by edge; empty without `similar`
  std::vector<Change> changes_;                                // by slot; as well
  std::vector<std::uint32_t> steps_;
  const Task* task_ = nullptr;  // of run()
  std::uint32_t tried_ = 0;     // collapses, in all steps
  bool stopped_ = false;
};

template <class Metric>
bool Decimation<Metric>::flips(std::uint32_t a, std::uint32_t b, const Eigen::Vector3d& to,
                               std::uint32_t since) const noexcept {
  const bool all = since == 0 || std::max(changes_[a].self, changes_[b].self) >= since;
  const auto turns = [&](std::uint32_t moved, std::uint32_t other) {
    if (!all && changes_[moved].near < since) return false;
    const Eigen::Vector3d& from = metric_.position(moved);
    for (const auto t : complex_.triangles_of(moved)) {
      const auto& c = complex_.triangle(t);
      const std::size_t at = c[0] == moved ? 0 : c[1] == moved ? 1 : 2;
      const std::uint32_t y = c[(at + 1) % 3];
      const std::uint32_t z = c[(at + 2) % 3];
      if (y == other || z == other) continue;
      if (!all && std::max(changes_[y].self, changes_[z].self) < since) continue;
      const Eigen::Vector3d& p = metric_.position(y);
      const Eigen::Vector3d side = metric_.position(z) - p;
      if (side.cross(from - p).dot(side.cross(to - p)) < 0) return true;
    }
    return false;
  };
  return turns(a, b) || turns(b, a);
}

template <class Metric>
void Decimation<Metric>::fit(Ready& ready) const {
  const auto [a, b] = complex_.edge(ready.edge);
  ready.fit = metric_.fit(a, b);
  ready.fitted = true;
}

template <class Metric>
std::uint32_t Decimation<Metric>::renew_cost(Ready& ready) {
  const auto [a, b] = complex_.edge(ready.edge);
  complex_.note(ready.edge) &= static_cast<std::uint8_t>(~Stale);
  fit(ready);
  if (!memos_.empty()) memos_[ready.edge].centre = ready.fit.centre();
  return key_of(metric_.cost(a, b, ready.fit));
}

template <class Metric>
bool Decimation<Metric>::turns(Ready& ready) {
  const auto [a, b] = complex_.edge(ready.edge);
  if (memos_.empty()) {
    if (!ready.fitted) fit(ready);
    return flips(a, b, metric_.position(a) + ready.fit.centre(), 0);
  }
  Memo& memo = memos_[ready.edge];
  if (memo.upright > std::max(changes_[a].near, changes_[b].near)) return false;
  const bool found = flips(a, b, metric_.position(a) + memo.centre, memo.upright);
  memo.upright = found ? 0 : complex_.steps() + 1;
  return found;
}

template <class Metric>
void Decimation<Metric>::refresh(const CollapseComplex::Merged& merged) {
  if (!changes_.empty()) {
    changes_[merged.slot] = {complex_.steps(), complex_.steps()};
    for (const auto e : merged.edges) {
      const auto [a, b] = complex_.edge(e);
      changes_[a == merged.slot ? b : a].near = complex_.steps();
    }
  }
  for (const auto e : merged.edges) {
    if ((complex_.note(e) & Pairs) != 0) queue_.push(entry(e));
    complex_.note(e) = static_cast<std::uint8_t>((complex_.note(e) | Stale) & ~(Alone | Pairs));
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
    if ((complex_.note(edge) & Taken) != 0) {
      complex_.note(edge) |= Out;
      queue_.pop();
      continue;
    }
    if (key > most) return false;
    ready = {.edge = edge};
    if ((complex_.note(edge) & Stale) != 0) {
      complex_.key(edge) = std::max(renew_cost(ready), key);
      if (complex_.key(edge) >= kForbidden) {
        queue_.pop();
        continue;
      }
      queue_.replace_top(entry(edge));
      if (queue_.top() != entry(edge)) continue;
    }
    if (options_.keep_topology && !complex_.keeps_topology(edge)) {
      complex_.note(edge) |= Waits;
      queue_.pop();
      continue;
    }
    if (options_.penalise_flips && (complex_.key(edge) & kPenalty) == 0 && turns(ready)) {
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
CollapseComplex::Merged Decimation<Metric>::perform(Ready& ready) {
  const auto [a, b] = complex_.edge(ready.edge);
  if (!ready.fitted) fit(ready);
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
  task_ = &task;
  ready_.resize(1);
  while (complex_.steps() - first < count &&
         (similar_ == nullptr ? take(kNever, ready_[0]) : take_similar(first + count - complex_.steps()))) {
    for (Ready& ready : ready_) {
      if (ready.touches && !renew(ready)) continue;
      if (similar_ != nullptr) thin(ready.edge);
      const auto merged = perform(ready);
      if (similar_ != nullptr) {
        similar_->merged(merged.slot, merged.gone);
        made_.emplace_back(kind(merged.slot), merged.slot);
        walks_ += kWalksEarned;
      }
      done(merged.slot, merged.gone);
      if ((complex_.steps() & 1023U) == 0) {
        if (task.stopped()) return false;
        task.report("decimating", static_cast<double>(complex_.steps() - first) / count);
      }
    }
    if (similar_ == nullptr) continue;
    catch_up();
    settle();
    steps_.push_back(complex_.steps());
  }
  return !stopped_;
}

}  // namespace armature::sdk

#include "sdk/hierarchy/similar_steps.h"
