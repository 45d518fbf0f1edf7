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
void Decimation<Metric>::Marks::around(const CollapseComplex& complex, std::uint32_t edge) {
  for (const auto end : complex.edge(edge)) {
    rounds[end] = round;
    for (const auto e : complex.edges_of(end))
      for (const auto near : complex.edge(e)) rounds[near] = round;
  }
}

template <class Metric>
bool Decimation<Metric>::evaluate(std::uint32_t edge, Ready& ready) {
  const auto [a, b] = complex_.edge(edge);
  if (!options_.labels.empty() && options_.labels[a] != options_.labels[b]) return false;
  ready = {.edge = edge, .fit = metric_.fit(a, b)};
  std::uint32_t key = complex_.key(edge) & ~kPenalty;
  if ((complex_.note(edge) & kStale) != 0) {
    complex_.note(edge) &= static_cast<std::uint8_t>(~kStale);
    key = std::max(key, key_of(metric_.cost(a, b, ready.fit)));
  }
  const bool may_be = key < kForbidden;
  if (may_be && options_.penalise_flips && flips(a, b, metric_.position(a) + ready.fit.centre())) key |= kPenalty;
  if (key != complex_.key(edge)) {
    complex_.key(edge) = key;
    if (may_be && (complex_.note(edge) & kWaits) == 0) queue_.push(entry(edge));
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
void Decimation<Metric>::close_group(std::size_t first) {
  groups_.push_back({.first = first, .count = ready_.size() - first});
  for (std::size_t k = first; k < ready_.size(); ++k) complex_.note(ready_[k].edge) |= kTaken;
}

template <class Metric>
bool Decimation<Metric>::take_group(std::uint32_t most) {
  const std::size_t first = ready_.size();
  Ready ready;
  while (take(most, ready)) {
    ready_.push_back(ready);
    const auto [a, b] = complex_.edge(ready.edge);
    const auto kind_a = similar_->kind(a);
    const auto kind_b = similar_->kind(b);
    const bool whole =
        kind_a == 0 || kind_b == 0 || (gather(kind_a, kind_b, ready.edge) && apart(std::span(ready_).subspan(first)));
    std::uint32_t due = complex_.key(ready.edge);
    for (std::size_t k = first; k < ready_.size(); ++k) due = std::max(due, complex_.key(ready_[k].edge));
    if (!whole && (complex_.note(ready.edge) & kAlone) == 0) {
      const auto cost = static_cast<double>(std::bit_cast<float>(due & ~kPenalty));
      due = key_of(kPatience * cost) | (due & kPenalty);
      for (std::size_t k = first; k < ready_.size(); ++k) complex_.note(ready_[k].edge) |= kAlone;
    }
    if (due == complex_.key(ready.edge)) {
      complex_.note(ready.edge) |= kOut;
      close_group(first);
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
  return false;
}

template <class Metric>
bool Decimation<Metric>::take_rest() {
  for (const auto& [a, b] : rest_) {
    if (a == b) continue;
    const auto edges = complex_.edges_of(a);
    const auto found = std::ranges::find_if(edges, [&](std::uint32_t edge) {
      const auto [u, v] = complex_.edge(edge);
      return u == b || v == b;
    });
    Ready ready;
    if (found != edges.end() && evaluate(*found, ready)) ready_.push_back(ready);
  }
  rest_.clear();
  if (!ready_.empty()) close_group(0);
  return !ready_.empty();
}

template <class Metric>
void Decimation<Metric>::catch_up(std::uint32_t slot, std::span<const std::uint32_t> behind) {
  const std::uint64_t kind = similar_->kind(slot);
  for (const auto late : behind)
    for (const auto edge : complex_.edges_of(late)) {
      const auto [u, v] = complex_.edge(edge);
      const std::uint64_t other = similar_->kind(u == late ? v : u);
      if (other != 0 && similar_->kind(late) + other == kind) rest_.push_back({u, v});
    }
}

template <class Metric>
bool Decimation<Metric>::apart(std::span<const Ready> members) {
  near_.next(complex_.slot_count());
  for (const Ready& member : members) {
    if (near_.either(complex_.edge(member.edge))) return false;
    near_.around(complex_, member.edge);
  }
  return true;
}

template <class Metric>
void Decimation<Metric>::choose_whole(Group& group, std::uint32_t& most) {
  const auto members = std::span(ready_).subspan(group.first, group.count);
  if (members.size() > most || !apart(members)) return;
  for (const Ready& member : members)
    if (!independent(member.edge)) return;
  for (const Ready& member : members) reserved_.around(complex_, member.edge);
  most -= static_cast<std::uint32_t>(group.count);
  group.chosen = true;
}

template <class Metric>
void Decimation<Metric>::give_back(const Group& group) {
  for (const Ready& left : std::span(ready_).subspan(group.first, group.count)) {
    if ((complex_.note(left.edge) & kOut) != 0) queue_.push(entry(left.edge));
    complex_.note(left.edge) &= static_cast<std::uint8_t>(~(kTaken | kOut));
  }
}

template <class Metric>
bool Decimation<Metric>::take_similar(std::uint32_t most) {
  ready_.clear();
  groups_.clear();
  reserved_.next(complex_.slot_count());
  if (!take_rest() && !take_group(kNever)) return false;

  // The first group goes as far as it is independent; what is left of it is the next step's.
  std::vector<Ready> chosen;
  const auto [a, b] = complex_.edge(ready_[0].edge);
  const std::uint32_t dear = dearest(complex_.key(ready_[0].edge));
  for (const Ready& member : ready_) {
    if (chosen.size() < most && independent(member.edge)) {
      reserved_.around(complex_, member.edge);
      chosen.push_back(member);
    } else {
      rest_.push_back(complex_.edge(member.edge));
    }
  }
  most -= static_cast<std::uint32_t>(chosen.size());

  // What may come along, by what it costs.
  const std::size_t looks = similar_->begin(a, b);
  dissimilarities_.clear();
  while (groups_.size() <= looks && take_group(dear)) {
    Group& group = groups_.back();
    const auto [u, v] = complex_.edge(ready_[group.first].edge);
    group.dissimilarity = independent(ready_[group.first].edge) ? similar_->dissimilarity(u, v) : kUnlike;
    if (group.dissimilarity < kUnlike) dissimilarities_.push_back(group.dissimilarity);
  }
  const double below = similar_->threshold(dissimilarities_);
  for (Group& group : std::span(groups_).subspan(1))
    if (group.dissimilarity < below) choose_whole(group, most);

  for (const Group& group : groups_) {
    if (group.chosen)
      chosen.insert(chosen.end(), ready_.begin() + static_cast<std::ptrdiff_t>(group.first),
                    ready_.begin() + static_cast<std::ptrdiff_t>(group.first + group.count));
    else
      give_back(group);
  }
  ready_.swap(chosen);
  return true;
}

}  // namespace armature::sdk
