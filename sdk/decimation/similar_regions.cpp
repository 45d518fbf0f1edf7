#include "sdk/decimation/similar_regions.h"

#include <algorithm>
#include <limits>

namespace armature::sdk {
namespace {

// Every collapse earns so many looks at others, which later steps may spend: fine levels, whose steps are large, pay
// for coarse ones, at which everything can be looked at. So the time grows with the number of collapses alone.
constexpr std::size_t kFirstLooks = 1024;
constexpr std::size_t kLooksEarned = 8;

// A gap in ranked dissimilarities is so many times as wide as they lie apart before it, and so wide at least.
constexpr double kGapRatio = 4, kLeastGap = 0.02;
constexpr double kMostAdaptive = 0.4;

constexpr double kUnlike = std::numeric_limits<double>::infinity();

}  // namespace

SimilarRegions::SimilarRegions(const Descriptor& descriptor, const Correspondence& correspondence,
                               const SimilarityOptions& options)
    : descriptor_(descriptor),
      counterparts_(correspondence),
      options_(options),
      width_(descriptor.width()),
      place_(descriptor.size(), kNoIndex),
      reference_(width_),
      other_(width_),
      looks_(kFirstLooks) {
  rows_.reserve(descriptor.size() / 2 * width_);  // a region that was joined has two vertices or more
  areas_.reserve(descriptor.size());
  for (std::size_t v = 0; v < descriptor.size(); ++v)
    areas_.push_back(static_cast<float>(descriptor.area(VertexId(v))));
}

void SimilarRegions::describe(std::uint32_t slot, std::span<float> out) const {
  if (place_[slot] == kNoIndex) {
    descriptor_.describe(VertexId(slot), out);
  } else {
    std::ranges::copy(std::span(rows_).subspan(place_[slot] * width_, width_), out.begin());
  }
}

void SimilarRegions::describe(std::uint32_t a, std::uint32_t b, std::span<float> out) {
  describe(a, out);
  if (place_[b] == kNoIndex)
    descriptor_.add(out, VertexId(b));
  else
    descriptor_.aggregate(out, row(place_[b]));
}

void SimilarRegions::begin(std::uint32_t a, std::uint32_t b) {
  describe(a, b, reference_);
  area_ = areas_[a] + areas_[b];
}

double SimilarRegions::dissimilarity(std::uint32_t a, std::uint32_t b) {
  const float area = areas_[a] + areas_[b];
  const auto most = static_cast<float>(options_.area_ratio);
  if (!(area <= most * area_ && area_ <= most * area)) return kUnlike;
  describe(a, b, other_);
  const double limit = options_.adaptive ? kMostAdaptive : options_.threshold;
  const double d = descriptor_.dissimilarity(reference_, other_, limit);
  return d < limit ? d : kUnlike;
}

double SimilarRegions::threshold(std::span<double> dissimilarities) const {
  std::ranges::sort(dissimilarities);
  for (std::size_t k = 1; k < dissimilarities.size(); ++k) {
    const double apart =
        (dissimilarities[k - 1] - dissimilarities.front()) / static_cast<double>(std::max<std::size_t>(1, k - 1));
    if (dissimilarities[k] - dissimilarities[k - 1] > std::max(kLeastGap, kGapRatio * apart)) return dissimilarities[k];
  }
  return kMostAdaptive;
}

void SimilarRegions::merged(std::uint32_t kept, std::uint32_t gone) {
  looks_ += kLooksEarned;
  counterparts_.merge(kept, gone);
  areas_[kept] += areas_[gone];
  if (place_[kept] == kNoIndex && place_[gone] != kNoIndex) {
    std::swap(place_[kept], place_[gone]);
    descriptor_.add(row(place_[kept]), VertexId(kept));
    return;
  }
  if (place_[kept] == kNoIndex) {
    if (free_.empty()) {
      free_.push_back(static_cast<std::uint32_t>(rows_.size() / width_));
      rows_.resize(rows_.size() + width_);
    }
    place_[kept] = free_.back();
    free_.pop_back();
    descriptor_.describe(VertexId(kept), row(place_[kept]));
  }
  if (place_[gone] == kNoIndex) {
    descriptor_.add(row(place_[kept]), VertexId(gone));
    return;
  }
  descriptor_.aggregate(row(place_[kept]), row(place_[gone]));
  free_.push_back(place_[gone]);
  place_[gone] = kNoIndex;
}

}  // namespace armature::sdk
