#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/expansion/histogram.h>
#include <armature/sdk/mesh/ids.h>

namespace armature::sdk {

/// A region like the reference.
struct Match {
  std::vector<FaceId> faces = {};  ///< ascending, none twice
  double score = 0;                ///< how much it is like the reference, in [0, 1]; 1 is the same
  /// Maps its points onto the reference: a similarity, of negative determinant where `mirrored`.
  Eigen::Matrix4d reference_from_match = Eigen::Matrix4d::Identity();
  bool mirrored = false;    ///< it is the reference's mirror image
  std::string reason = {};  ///< why it is thought alike; one line, for people
};

/// What might have been a match and is none.
struct Rejected {
  FaceId face = {};         ///< in its middle
  std::string reason = {};  ///< why not; one line, for people
};

/// A match, with what it is compared by.
struct Candidate {
  Match match = {};          ///< how it compares with the reference
  Histogram histogram = {};  ///< with the bins of all others in its pool
};

/// Regions like a reference, best first: found once, after which the first k of them cost nothing. Regions accepted or
/// rejected by hand re-rank the others: with s the likeness to the reference or, if more, to an accepted region, and n
/// that to the closest rejected one (likeness being 1 - chi-square of histograms), the score is s (1 - n) / (2 - s -
/// n), and s while none is rejected (after Giacinto 2007, a nearest neighbour's relevance). Thread-safe: no.
class Expansion {
 public:
  /// No reference, no matches.
  Expansion() = default;
  /// The candidates come in any order; the reference is none of them.
  Expansion(std::vector<FaceId> reference, std::vector<Candidate> candidates, std::vector<Rejected> rejected);

  /// The faces that all is compared with, ascending.
  [[nodiscard]] const std::vector<FaceId>& reference() const noexcept { return reference_; }
  /// How many matches there are.
  [[nodiscard]] std::size_t size() const noexcept { return live_; }
  /// The best k matches, or all if there are fewer: accepted ones, as they were accepted, then by falling score. Valid
  /// until the next change.
  [[nodiscard]] std::span<const Match> first(std::size_t k) const noexcept;
  /// What is no match, by the tool's judgement and then by hand.
  [[nodiscard]] const std::vector<Rejected>& rejected() const noexcept { return rejected_; }

  /// The match in that place is right. `place` is below `size()`.
  void accept(std::size_t place);
  /// The match in that place is wrong: it goes, and what is like it falls. `place` is below `size()`.
  void reject(std::size_t place);
  /// Takes back the last of these; false where there is none.
  bool undo();

 private:
  enum class Verdict : std::uint8_t { Open, Accepted, Rejected };
  struct Judged {
    Histogram histogram;
    double likeness;  // to the reference, as the tool says
    Verdict verdict = Verdict::Open;
    std::size_t turn = 0;  // of the verdict
  };
  void judge(std::size_t place, Verdict verdict);
  void rank();
  [[nodiscard]] double relevance(const Judged& judged) const;

  std::vector<FaceId> reference_;
  std::vector<Match> matches_;  // ranked; rejected ones last
  std::vector<Judged> judged_;  // in the same order
  std::size_t live_ = 0;
  std::vector<Rejected> rejected_;
  std::size_t rejected_by_tool_ = 0;
  std::size_t verdicts_ = 0;
};

}  // namespace armature::sdk
