#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <armature/sdk/descriptors/descriptor.h>
#include <tbb/parallel_for.h>

namespace armature::sdk {

void Descriptor::aggregate(std::span<float> into, std::span<const float> other) const noexcept {
  for (std::size_t k = 0; k < into.size(); ++k) into[k] += other[k];
}

Expected<std::vector<float>> dissimilarities(const Descriptor& descriptor, std::span<const VertexId> reference,
                                             const Task& task) {
  if (reference.empty()) return fail("expected a vertex to compare with, found none");
  std::vector<float> region(descriptor.width(), 0.0F);
  bool first = true;
  for (const VertexId vertex : reference) {
    if (!vertex.valid() || vertex.index() >= descriptor.size())
      return fail("reference: expected vertices below " + std::to_string(descriptor.size()));
    if (std::exchange(first, false))
      descriptor.describe(vertex, region);
    else
      descriptor.add(region, vertex);
  }
  std::vector<float> result(descriptor.size());
  constexpr std::size_t kBlock = 1024;
  tbb::parallel_for(std::size_t{0}, (result.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    if (task.stopped()) return;
    std::vector<float> mine(descriptor.width());
    for (std::size_t v = block * kBlock; v < std::min(result.size(), (block + 1) * kBlock); ++v) {
      descriptor.describe(VertexId(v), mine);
      result[v] = static_cast<float>(descriptor.dissimilarity(region, mine, std::numeric_limits<double>::infinity()));
    }
  });
  if (task.stopped()) return cancelled();
  return result;
}

std::vector<float> similarity_map(std::span<const float> dissimilarities, double share) {
  assert(share > 0 && share <= 1);
  std::vector<float> sorted;
  for (const float d : dissimilarities)
    if (std::isfinite(d)) sorted.push_back(d);
  std::vector<float> map(dissimilarities.size(), 0.0F);
  if (sorted.empty()) return map;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(sorted.size() - 1));
  std::ranges::nth_element(sorted, at);
  const float sigma = *at > 0 ? *at : std::numeric_limits<float>::min();
  for (std::size_t v = 0; v < map.size(); ++v) {
    const float x = dissimilarities[v] / sigma;
    map[v] = std::isfinite(x) ? std::exp(-0.5F * x * x) : 0.0F;
  }
  return map;
}

}  // namespace armature::sdk
