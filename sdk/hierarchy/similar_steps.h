#pragma once

// How Decimation chooses the collapses of a step: the end of decimation.h, which alone includes it.

namespace armature::sdk {

template <class Metric>
std::uint32_t Decimation<Metric>::dearest(std::uint32_t key) const noexcept {
  // Of unit area and diagonal: what moves the surface by less than a millionth is nothing.
  constexpr double kNothing = 1e-12;
  const std::uint32_t penalty = key & kPenalty;
  const auto cost = static_cast<double>(std::bit_cast<float>(key & ~kPenalty));
  return key_of(std::max(kNothing, similar_->cost_ratio() * cost)) | penalty;
}

template <class Metric>
std::uint32_t Decimation<Metric>::patient(std::uint32_t key) noexcept {
  return key_of(kPatience * static_cast<double>(std::bit_cast<float>(key & ~kPenalty))) | (key & kPenalty);
}

template <class Metric>
void Decimation<Metric>::Marks::around(const CollapseComplex& complex, std::uint32_t edge, When when) {
  const auto mark = [&](std::uint32_t slot) {
    if (rounds[slot] != round + Early) rounds[slot] = round + when;
  };
  for (const auto end : complex.edge(edge)) {
    mark(end);
    for (const auto e : complex.edges_of(end))
      for (const auto near : complex.edge(e)) mark(near);
  }
}

template <class Metric>
bool Decimation<Metric>::evaluate(std::uint32_t edge, Ready& ready) {
  const auto [a, b] = complex_.edge(edge);
  if (!options_.labels.empty() && options_.labels[a] != options_.labels[b]) return false;
  ready = {.edge = edge};
  std::uint32_t key = complex_.key(edge) & ~kPenalty;
  if ((complex_.note(edge) & Stale) != 0) key = std::max(key, renew_cost(ready));
  const bool may_be = key < kForbidden;
  if (may_be && options_.penalise_flips && turns(ready)) key |= kPenalty;
  if (key != complex_.key(edge)) {
    complex_.key(edge) = key;
    if (may_be && (complex_.note(edge) & Waits) == 0) queue_.push(entry(edge));
  }
  return may_be && (!options_.keep_topology || complex_.keeps_topology(edge));
}

template <class Metric>
bool Decimation<Metric>::gather(std::uint64_t a, std::uint64_t b, std::uint32_t but) {
  bool whole = true;
  std::size_t ends = 0;  // of kind b
  for (const auto slot : similar_->slots_of(a)) {
    bool joined = false;
    for (const auto edge : complex_.edges_of(slot)) {
      const auto [u, v] = complex_.edge(edge);
      const std::uint32_t other = u == slot ? v : u;
      if (similar_->kind(other) != b || (a == b && other < slot)) continue;
      joined = true;
      Ready& ready = ready_.emplace_back();
      if (edge == but || !evaluate(edge, ready)) {
        whole = whole && edge == but;
        ready_.pop_back();
      }
    }
    whole = whole && (joined || a == b);
  }
  for (const auto slot : similar_->slots_of(b)) {
    const auto edges = complex_.edges_of(slot);
    ends += std::ranges::any_of(edges, [&](std::uint32_t edge) {
      const auto [u, v] = complex_.edge(edge);
      return similar_->kind(u == slot ? v : u) == a;
    });
  }
  return whole && ends == similar_->slots_of(b).size();
}

template <class Metric>
void Decimation<Metric>::close_group(std::size_t first, bool touches) {
  groups_.push_back({.first = first, .count = ready_.size() - first, .touches = touches});
  for (Ready& member : std::span(ready_).subspan(first)) {
    complex_.note(member.edge) |= Taken;
    member.touches = touches;
    if (touches) member.slots = complex_.edge(member.edge);
  }
}

template <class Metric>
std::uint32_t Decimation<Metric>::joint_key(std::span<const Ready> members) const {
  std::vector<std::uint32_t> slots;
  for (const Ready& member : members)
    for (const auto end : complex_.edge(member.edge)) slots.push_back(end);
  std::ranges::sort(slots);
  slots.erase(std::unique(slots.begin(), slots.end()), slots.end());
  // By slot the place of one that it is joined with.
  std::vector<std::size_t> root(slots.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto root_of = [&](std::uint32_t slot) {
    auto k = static_cast<std::size_t>(std::ranges::lower_bound(slots, slot) - slots.begin());
    while (root[k] != k) k = root[k] = root[root[k]];
    return k;
  };
  for (const Ready& member : members) {
    const auto [a, b] = complex_.edge(member.edge);
    root[root_of(a)] = root_of(b);
  }
  std::vector<std::pair<std::size_t, std::uint32_t>> by_root;
  by_root.reserve(slots.size());
  for (const auto slot : slots) by_root.emplace_back(root_of(slot), slot);
  std::ranges::sort(by_root);
  std::uint32_t key = 0;
  std::vector<std::uint32_t> together;
  for (std::size_t k = 0; k < by_root.size();) {
    together.clear();
    const std::size_t here = by_root[k].first;
    for (; k < by_root.size() && by_root[k].first == here; ++k) together.push_back(by_root[k].second);
    if (together.size() > 2) key = std::max(key, key_of(metric_.cost(together)));
  }
  return key;
}

template <class Metric>
std::uint32_t Decimation<Metric>::fit_alike(std::span<Ready> members) {
  float width = 0;
  for (const Ready& member : members) {
    const auto [a, b] = complex_.edge(member.edge);
    width += metric_.width(a, b) / static_cast<float>(members.size());
  }
  std::uint32_t key = 0;
  for (Ready& member : members) {
    const auto [a, b] = complex_.edge(member.edge);
    member.fit = metric_.fit(a, b, width);
    member.fitted = true;
    key = std::max(key, key_of(metric_.cost(a, b, member.fit)) | (complex_.key(member.edge) & kPenalty));
  }
  return key;
}

template <class Metric>
bool Decimation<Metric>::renew(Ready& ready) {
  const std::uint32_t edge = edge_of({ready.edge, ready.slots});
  if (edge == kNoIndex) return false;
  if (evaluate(edge, ready)) return true;
  give_back(edge);
  return false;
}

template <class Metric>
bool Decimation<Metric>::take_group(std::uint32_t most) {
  const std::size_t first = ready_.size();
  Ready ready;
  while (take(most, ready)) {
    if (most == kNever && take_waiting(complex_.key(ready.edge))) {
      queue_.push(entry(ready.edge));
      return true;
    }
    ready_.push_back(ready);
    const auto [a, b] = complex_.edge(ready.edge);
    const auto kind_a = similar_->kind(a);
    const auto kind_b = similar_->kind(b);
    bool whole = kind_a == 0 || kind_b == 0 || gather(kind_a, kind_b, ready.edge);
    const auto members = std::span(ready_).subspan(first);
    bool touches = whole && members.size() > 1 && !apart(members);
    const std::uint32_t joint = touches ? joint_key(members) : 0;
    if (joint >= kForbidden) touches = whole = false;
    std::uint32_t due = complex_.key(ready.edge);
    const bool alike = whole && members.size() > 1;
    if (alike)
      due = std::max(due, fit_alike(members));
    else
      for (const Ready& member : members) due = std::max(due, complex_.key(member.edge));
    if (touches) due = std::max(due, joint);
    if (!whole && (complex_.note(ready.edge) & Alone) == 0) {
      due = patient(due);
      for (std::size_t k = first; k < ready_.size(); ++k) complex_.note(ready_[k].edge) |= Alone;
    }
    if (due == complex_.key(ready.edge)) {
      complex_.note(ready.edge) |= Out;
      const std::uint32_t copy = alike ? kNoIndex : copy_of(ready.edge);
      if (copy != kNoIndex) ready_.resize(first + 1);
      const bool alone = copy == kNoIndex || similar_->surplus(copy) > 0;
      if (!alone && !pair_up(copy)) continue;
      close_group(first, touches);
      if (alone) groups_.back().copy = copy;
      return true;
    }
    for (std::size_t k = first; k < ready_.size(); ++k) {
      const std::uint32_t edge = ready_[k].edge;
      if (k > first && complex_.key(edge) == due) continue;
      complex_.key(edge) = due;
      queue_.push(entry(edge));
    }
    ready_.resize(first);
  }
  return most == kNever && take_waiting(kNever);
}

template <class Metric>
bool Decimation<Metric>::pair_up(std::uint32_t copy) {
  complex_.note(ready_.back().edge) |= Taken;
  waiting_.resize(std::max<std::size_t>(waiting_.size(), copy + 1));
  waiting_[copy].push_back(ready_.back());
  ready_.pop_back();
  const auto copies = similar_->copies_like(copy);
  const auto waits = [&](std::uint32_t like) { return like < waiting_.size() && !waiting_[like].empty(); };
  if (!std::ranges::all_of(copies, waits) || !similar_->even(copy)) return false;
  for (const auto like : copies) {
    ready_.push_back(waiting_[like].front());
    waiting_[like].pop_front();
  }
  return true;
}

template <class Metric>
bool Decimation<Metric>::take_waiting(std::uint32_t key) {
  // Of unit area and diagonal: what moves the surface by less than a hundred-thousandth may wait.
  const std::uint32_t little = key_of(1e-10);
  std::deque<Ready>* cheapest = nullptr;
  for (auto& list : waiting_)
    if (!list.empty() && (cheapest == nullptr || entry(list.front().edge) < entry(cheapest->front().edge)))
      cheapest = &list;
  if (cheapest == nullptr || std::max(patient(complex_.key(cheapest->front().edge)), little) > key) return false;
  ready_.push_back(cheapest->front());
  cheapest->pop_front();
  close_group(ready_.size() - 1, false);
  return true;
}

template <class Metric>
std::uint32_t Decimation<Metric>::edge_of(const Left& left) {
  if (complex_.alive(left.edge)) return left.edge;
  const std::uint32_t a = similar_->holder(left.slots[0]);
  const std::uint32_t b = similar_->holder(left.slots[1]);
  for (const auto edge : complex_.edges_of(a))
    if (a != b && std::ranges::find(complex_.edge(edge), b) != complex_.edge(edge).end()) return edge;
  return kNoIndex;
}

template <class Metric>
bool Decimation<Metric>::take_rest(std::uint32_t most) {
  std::vector<Left> rest;
  rest.swap(rest_);
  for (const Left& left : rest) {
    const std::uint32_t edge = edge_of(left);
    if (edge == kNoIndex) continue;
    complex_.note(edge) &= static_cast<std::uint8_t>(~Rest);
    Ready ready;
    if (ready_.size() == most || !independent(edge)) {
      postpone(edge);
    } else if (evaluate(edge, ready)) {
      reserved_.around(complex_, edge, Marks::Early);
      ready_.push_back(ready);
    }
  }
  if (!ready_.empty()) close_group(0, false);
  return !ready_.empty();
}

template <class Metric>
bool Decimation<Metric>::take_first(std::uint32_t most) {
  if (!take_group(kNever)) return false;
  if (groups_.front().touches && ready_.size() <= most) {
    for (const Ready& member : ready_) reserved_.around(complex_, member.edge, Marks::Early);
    return true;
  }
  std::size_t kept = 0;
  for (const Ready& member : ready_) {
    if (kept < most && independent(member.edge)) {
      reserved_.around(complex_, member.edge, Marks::Early);
      ready_[kept++] = member;
    } else {
      postpone(member.edge);
    }
  }
  ready_.resize(kept);
  groups_.front().count = kept;
  return true;
}

template <class Metric>
void Decimation<Metric>::catch_up() {
  std::ranges::sort(made_);
  std::uint64_t done = 0;
  for (const auto& [kind, slot] : made_) {
    if (kind == std::exchange(done, kind)) continue;
    for (const auto late : similar_->behind(slot))
      for (const auto edge : complex_.edges_of(late)) {
        const auto [u, v] = complex_.edge(edge);
        const std::uint64_t other = similar_->kind(u == late ? v : u);
        if (other == 0 || similar_->kind(late) + other != kind) continue;
        const std::uint32_t copy = copy_of(edge);
        if (copy == kNoIndex || similar_->surplus(copy) > 0) postpone(edge);
      }
  }
  made_.clear();
}

template <class Metric>
bool Decimation<Metric>::apart(std::span<const Ready> members) {
  near_.next(complex_.slot_count());
  for (const Ready& member : members) {
    if (near_.either(complex_.edge(member.edge))) return false;
    near_.around(complex_, member.edge, Marks::Early);
  }
  return true;
}

template <class Metric>
void Decimation<Metric>::choose_whole(Group& group, std::uint32_t& most) {
  const auto members = std::span(ready_).subspan(group.first, group.count);
  if (members.size() > most) return;
  if (group.copy != kNoIndex && gives(group.copy) == similar_->surplus(group.copy)) return;
  for (const Ready& member : members)
    if (!independent(member.edge)) return;
  if (!group.touches && members.size() > 1 && !apart(members)) return;
  for (const Ready& member : members) reserved_.around(complex_, member.edge, Marks::Late);
  most -= static_cast<std::uint32_t>(group.count);
  group.chosen = true;
  if (group.copy != kNoIndex) ++gives(group.copy);
}

template <class Metric>
void Decimation<Metric>::give_back(std::uint32_t edge) {
  if ((complex_.note(edge) & Out) != 0 && (complex_.key(edge) & ~kPenalty) < kForbidden) queue_.put_back(entry(edge));
  complex_.note(edge) &= static_cast<std::uint8_t>(~(Taken | Out));
}

template <class Metric>
bool Decimation<Metric>::take_similar(std::uint32_t most) {
  ready_.clear();
  groups_.clear();
  reserved_.next(complex_.slot_count());
  if (!take_rest(most) && !take_first(most)) return false;
  groups_.front().chosen = true;
  const std::uint32_t copy = groups_.front().copy;
  gives_.clear();
  if (copy != kNoIndex) ++gives(copy);
  most -= static_cast<std::uint32_t>(ready_.size());

  // What may come along, by what it costs.
  const auto [a, b] = complex_.edge(ready_[0].edge);
  const std::uint32_t dear = dearest(complex_.key(ready_[0].edge));
  const std::size_t looks = similar_->begin(a, b);
  dissimilarities_.clear();
  // What one copy has more than others goes at once, whatever it is like.
  while (groups_.size() <= looks && take_group(copy == kNoIndex ? dear : kForbidden - 1)) {
    Group& group = groups_.back();
    const std::uint32_t edge = ready_[group.first].edge;
    const auto [u, v] = complex_.edge(edge);
    const bool free = independent(edge);
    if (free || !reserved_.early({u, v})) similar_->look();
    if (!free) continue;
    if (copy != kNoIndex && group.copy == copy) {
      choose_whole(group, most);
      continue;
    }
    group.dissimilarity = complex_.key(edge) <= dear ? similar_->dissimilarity(u, v) : kUnlike;
    if (group.dissimilarity == kUnlike) continue;
    if (similar_->ranks())
      dissimilarities_.push_back(group.dissimilarity);
    else
      choose_whole(group, most);  // at once: most of what comes is near something chosen
  }
  if (similar_->ranks()) {
    const double below = similar_->threshold(dissimilarities_);
    for (Group& group : std::span(groups_).subspan(1))
      if (!group.chosen && group.dissimilarity < below) choose_whole(group, most);
  }

  for (std::size_t k = groups_.size(); k-- > 0;)  // the dearest first, as the queue asks for
    if (!groups_[k].chosen)
      for (std::size_t i = groups_[k].count; i-- > 0;) give_back(ready_[groups_[k].first + i].edge);
  for (auto& list : waiting_) {
    for (const Ready& ready : list) give_back(ready.edge);
    list.clear();
  }
  std::size_t kept = 0;
  for (const Group& group : groups_)
    if (group.chosen)
      for (const Ready& member : std::span(ready_).subspan(group.first, group.count)) ready_[kept++] = member;
  ready_.resize(kept);
  // Only now, so that no group of this step held it.
  for (const Left& left : rest_) give_back(left.edge);
  return true;
}

}  // namespace armature::sdk
