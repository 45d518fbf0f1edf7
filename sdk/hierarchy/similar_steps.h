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
    complex_.note(edge) &= static_cast<std::uint8_t>(~Pairs);
    if (may_be && (complex_.note(edge) & Waits) == 0) queue_.push(entry(edge));
  }
  return may_be && (!options_.keep_topology || complex_.keeps_topology(edge));
}

template <class Metric>
bool Decimation<Metric>::gather(std::uint32_t edge) {
  const auto [from, to] = complex_.edge(edge);
  const std::uint64_t a = kind(from);
  const std::uint64_t b = kind(to);
  if (a == 0 || b == 0) return true;
  const auto like = similar_->slots_like(from);
  if (like.size() > walks_) return false;
  walks_ -= like.size();
  ends_.clear();
  for (const auto slot : like) {
    const std::size_t before = ends_.size();
    for (const auto e : complex_.edges_of(slot)) {
      const auto [u, v] = complex_.edge(e);
      const std::uint32_t other = u == slot ? v : u;
      if (kinds_[other] != b) continue;
      ends_.push_back(other);
      if (e != edge && (a != b || slot < other)) ready_.push_back({.edge = e});
    }
    if (ends_.size() == before) return false;
  }
  std::ranges::sort(ends_);
  ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());
  return ends_.size() == similar_->slots_like(to).size();
}

template <class Metric>
void Decimation<Metric>::open_group(const Ready& ready) {
  groups_.push_back({.first = ready_.size()});
  ready_.push_back(ready);
  if (independent(ready.edge)) groups_.back().whole = gather(ready.edge);
}

template <class Metric>
void Decimation<Metric>::close_group() {
  Group& group = groups_.back();
  group.count = ready_.size() - group.first;
  for (Ready& member : std::span(ready_).subspan(group.first)) {
    complex_.note(member.edge) |= Taken;
    member.touches = group.touches;
    if (group.touches) member.slots = complex_.edge(member.edge);
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
bool Decimation<Metric>::due() {
  Group& group = groups_.back();
  const std::uint32_t edge = ready_[group.first].edge;
  std::size_t kept = group.first + 1;
  for (std::size_t k = kept; k < ready_.size(); ++k)
    if (evaluate(ready_[k].edge, ready_[kept]))
      ++kept;
    else
      group.whole = false;
  ready_.resize(kept);
  const auto members = std::span(ready_).subspan(group.first);
  group.touches = group.whole && members.size() > 1 && !apart(members);
  const std::uint32_t joint = group.touches ? joint_key(members) : 0;
  if (joint >= kForbidden) group.touches = group.whole = false;
  std::uint32_t key = complex_.key(edge);
  const bool alike = group.whole && members.size() > 1;
  if (alike)
    key = std::max({key, fit_alike(members), group.touches ? joint : 0});
  else
    // What turns triangles over comes last by itself.
    for (const Ready& member : members) key = std::max(key, complex_.key(member.edge) & ~kPenalty);
  if (!group.whole && (complex_.note(edge) & Alone) == 0) {
    key = patient(key);
    for (const Ready& member : members) complex_.note(member.edge) |= Alone;
  }
  if (key == complex_.key(edge)) {
    const std::uint32_t copy = alike ? kNoIndex : copy_of(edge);
    if (copy == kNoIndex) return true;
    ready_.resize(group.first + 1);
    if (similar_->surplus(copy) > 0) {
      group.copy = copy;
      return true;
    }
    if (pair_up(copy)) return true;
  } else {
    for (const Ready& member : members) {
      if (member.edge != edge && complex_.key(member.edge) == key) continue;
      complex_.key(member.edge) = key;
      complex_.note(member.edge) &= static_cast<std::uint8_t>(~Pairs);
      queue_.push(entry(member.edge));
    }
    ready_.resize(group.first);
  }
  groups_.pop_back();
  return false;
}

template <class Metric>
bool Decimation<Metric>::pair_up(std::uint32_t copy) {
  const std::uint32_t edge = ready_.back().edge;
  ready_.pop_back();
  const auto copies = similar_->copies_like(copy);
  if (waiting_of_.size() <= copies.back()) waiting_of_.resize(copies.back() + 1);
  complex_.note(edge) |= Pairs;
  waiting_of_[copy].add(entry(edge));
  waiting_.add(entry(edge));
  if (!similar_->even(copy)) return false;
  // From the copy on that had none when last it was asked.
  std::uint32_t& lacks = lacks_.try_emplace(copies.front(), 0U).first->second;
  for (std::size_t asked = 0; asked < copies.size(); ++asked) {
    if (!cheapest(waiting_of_[copies[lacks]])) return false;
    lacks = static_cast<std::uint32_t>((lacks + 1) % copies.size());
  }
  for (const auto like : copies) stop_waiting(*cheapest(waiting_of_[like]));
  return true;
}

template <class Metric>
auto Decimation<Metric>::cheapest(WaitingList& list) -> std::optional<Ready> {
  while (const auto e = list.cheapest([this](std::uint64_t entry) { return waits(entry); })) {
    // What is near has changed since it began to wait.
    Ready ready;
    const bool may_be = evaluate(CollapseQueue::edge_of(*e), ready);
    if (may_be && waits(*e)) return ready;
    complex_.note(ready.edge) &= static_cast<std::uint8_t>(~Pairs);
    if (!may_be && (complex_.key(ready.edge) & ~kPenalty) < kForbidden) complex_.note(ready.edge) |= Waits;
  }
  return {};
}

template <class Metric>
void Decimation<Metric>::stop_waiting(const Ready& ready) {
  complex_.note(ready.edge) = static_cast<std::uint8_t>((complex_.note(ready.edge) | Out) & ~Pairs);
  ready_.push_back(ready);
}

template <class Metric>
bool Decimation<Metric>::take_waiting(std::uint32_t key) {
  // Of unit area and diagonal: what moves the surface by less than a hundred-thousandth may wait.
  const std::uint32_t little = key_of(1e-10);
  const auto first = cheapest(waiting_);
  if (!first || std::max(patient(complex_.key(first->edge)), little) > key) return false;
  groups_.push_back({.first = ready_.size()});
  stop_waiting(*first);
  return true;
}

template <class Metric>
void Decimation<Metric>::wake_copies(std::uint32_t copy) {
  for (const auto like : similar_->copies_like(copy)) {
    if (like >= waiting_of_.size()) continue;
    for (const auto e : waiting_of_[like].release()) {
      if (!waits(e)) continue;
      complex_.note(CollapseQueue::edge_of(e)) &= static_cast<std::uint8_t>(~Pairs);
      queue_.push(e);
    }
  }
}

template <class Metric>
void Decimation<Metric>::thin(std::uint32_t edge) {
  const auto [a, b] = complex_.edge(edge);
  for (const auto slot : {a, b})
    if (similar_->copy(slot) != kNoIndex) thinned_.push_back(similar_->copy(slot));
}

template <class Metric>
void Decimation<Metric>::settle() {
  for (const auto copy : thinned_) {
    const std::uint32_t first = similar_->copies_like(copy).front();
    if (least_.size() <= first) least_.resize(first + 1, kEven);
    const std::uint32_t least = similar_->joined(copy) ? kNoIndex
                                : similar_->even(copy) ? kEven
                                                       : similar_->least(copy);
    if (std::exchange(least_[first], least) != least) wake_copies(copy);
  }
  thinned_.clear();
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
  if (ready_.empty()) return false;
  groups_.push_back({});
  close_group();
  return true;
}

template <class Metric>
bool Decimation<Metric>::take_first(std::uint32_t most) {
  for (Ready ready; groups_.empty();) {
    if (to_stop()) return false;
    if (!take(kNever, ready)) {
      if (!take_waiting(kNever)) return false;
    } else if (take_waiting(complex_.key(ready.edge))) {
      queue_.push(entry(ready.edge));
    } else {
      open_group(ready);
      if (due()) complex_.note(ready.edge) |= Out;
    }
  }
  close_group();
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
  for (const auto& [made, slot] : made_) {
    if (made == std::exchange(done, made)) continue;
    for (const auto late : similar_->behind(slot, walks_))
      for (const auto edge : complex_.edges_of(late)) {
        const auto [u, v] = complex_.edge(edge);
        const std::uint64_t other = kind(u == late ? v : u);
        if (other == 0 || kind(late) + other != made) continue;
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
  similar_->begin(a, b);
  const std::size_t looks = similar_->looks();
  const auto dissimilarity = [&](std::uint32_t edge) {
    const auto [u, v] = complex_.edge(edge);
    return complex_.key(edge) <= dear ? similar_->dissimilarity(u, v) : kUnlike;
  };
  dissimilarities_.clear();
  // What one copy has more than others goes at once, whatever it is like.
  Ready ready;
  while (ready_.size() <= looks && take(copy == kNoIndex ? dear : kForbidden - 1, ready)) {
    if (to_stop()) return false;
    open_group(ready);
    const bool free = independent(ready.edge);
    if (free || !reserved_.early(complex_.edge(ready.edge))) similar_->look(ready_.size() - groups_.back().first);
    // Most of what comes is near something chosen, or unlike: found out before what it costs with its counterparts.
    const bool may_be_more = copy != kNoIndex && copy_of(ready.edge) == copy;
    const double unlike = !free ? kUnlike : may_be_more ? 0 : dissimilarity(ready.edge);
    if (unlike < kUnlike && !due()) continue;
    Group& group = groups_.back();
    complex_.note(ready.edge) |= Out;
    close_group();
    if (unlike == kUnlike) continue;
    if (copy != kNoIndex && group.copy == copy) {
      choose_whole(group, most);
      continue;
    }
    const std::uint32_t first = ready_[group.first].edge;  // of a pair another
    group.dissimilarity = may_be_more || first != ready.edge ? dissimilarity(first) : unlike;
    if (group.dissimilarity == kUnlike) continue;
    if (similar_->ranks())
      dissimilarities_.push_back(group.dissimilarity);
    else
      choose_whole(group, most);
  }
  if (similar_->ranks()) {
    const double below = similar_->threshold(dissimilarities_);
    for (Group& group : std::span(groups_).subspan(1))
      if (!group.chosen && group.dissimilarity < below) choose_whole(group, most);
  }

  for (std::size_t k = groups_.size(); k-- > 0;)  // the dearest first, as the queue asks for
    if (!groups_[k].chosen)
      for (std::size_t i = groups_[k].count; i-- > 0;) give_back(ready_[groups_[k].first + i].edge);
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
