#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include <armature/sdk/expansion/expansion.h>

namespace armature::sdk {

Expansion::Expansion(std::vector<FaceId> reference, std::vector<Candidate> candidates, std::vector<Rejected> rejected)
    : reference_(std::move(reference)), rejected_(std::move(rejected)), rejected_by_tool_(rejected_.size()) {
  matches_.reserve(candidates.size());
  judged_.reserve(candidates.size());
  for (Candidate& candidate : candidates) {
    judged_.push_back({std::move(candidate.histogram), candidate.match.score});
    matches_.push_back(std::move(candidate.match));
  }
  rank();
}

std::span<const Match> Expansion::first(std::size_t k) const noexcept {
  return std::span(matches_).first(std::min(k, live_));
}

void Expansion::accept(std::size_t place) {
  judge(place, Verdict::Accepted);
}

void Expansion::reject(std::size_t place) {
  judge(place, Verdict::Rejected);
}

bool Expansion::undo() {
  if (verdicts_ == 0) return false;
  const auto last = std::ranges::find(judged_, verdicts_, &Judged::turn);
  --verdicts_;
  last->verdict = Verdict::Open;
  last->turn = 0;
  rank();
  return true;
}

void Expansion::judge(std::size_t place, Verdict verdict) {
  if (judged_[place].verdict == verdict) return;
  // A second thought about an accepted match replaces the first: later verdicts close the gap.
  if (const std::size_t before = std::exchange(judged_[place].turn, 0); before > 0) {
    for (Judged& other : judged_) other.turn -= other.turn > before ? 1 : 0;
    --verdicts_;
  }
  judged_[place].verdict = verdict;
  judged_[place].turn = ++verdicts_;
  rank();
}

double Expansion::relevance(const Judged& judged) const {
  if (verdicts_ == 0) return judged.likeness;
  double s = judged.likeness;
  double n = 0;
  for (const Judged& other : judged_) {
    if (other.verdict == Verdict::Open) continue;
    const double likeness = 1 - chi_square(judged.histogram, other.histogram);
    double& best = other.verdict == Verdict::Accepted ? s : n;
    best = std::max(best, likeness);
  }
  const bool any_rejected = live_ < judged_.size();
  if (!any_rejected) return s;
  return s + n < 2 ? s * (1 - n) / (2 - s - n) : s / 2;
}

void Expansion::rank() {
  live_ = static_cast<std::size_t>(
      std::ranges::count_if(judged_, [](const Judged& j) { return j.verdict != Verdict::Rejected; }));
  for (std::size_t i = 0; i < judged_.size(); ++i)
    matches_[i].score = judged_[i].verdict == Verdict::Open ? relevance(judged_[i]) : judged_[i].likeness;

  // Accepted ones by turn, then open ones by score, then rejected ones by turn; equal scores by place on the mesh.
  const auto key = [&](std::size_t i) {
    const Judged& j = judged_[i];
    const int group = j.verdict == Verdict::Accepted ? 0 : j.verdict == Verdict::Open ? 1 : 2;
    const double score = j.verdict == Verdict::Open ? -matches_[i].score : 0;
    const FaceId face = matches_[i].faces.empty() ? FaceId() : matches_[i].faces.front();
    return std::tuple(group, j.turn, score, face, i);
  };
  std::vector<std::size_t> order(judged_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, key);
  std::vector<Match> matches(matches_.size());
  std::vector<Judged> judged(judged_.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    matches[i] = std::move(matches_[order[i]]);
    judged[i] = std::move(judged_[order[i]]);
  }
  matches_ = std::move(matches);
  judged_ = std::move(judged);

  rejected_.resize(rejected_by_tool_);
  for (std::size_t i = live_; i < matches_.size(); ++i) {
    const FaceId middle = matches_[i].faces.empty() ? FaceId() : matches_[i].faces[matches_[i].faces.size() / 2];
    rejected_.push_back({middle, "rejected by hand"});
  }
}

}  // namespace armature::sdk
