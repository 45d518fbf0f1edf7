#pragma once

#include <span>
#include <vector>

#include "tracker/forest/training_set.h"

namespace armature {

/// Sums up the samples that ended in each of these nodes, together with the other ranks: how often each part occurs
/// and, for the joints near those parts, where the joint lies from the sample: the mode of the offsets (flat mean
/// shift, 15 cm) with the weight p (s^2 / (variance + s^2))^2, s = 4 cm, p the probability of the parts around the
/// joint. Sums are of integers (tenths of a millimetre), so that their order does not matter.
[[nodiscard]] std::vector<Leaf> make_leaves(std::span<const TrainingPerson> persons, std::span<const GrowingNode> nodes,
                                            std::uint64_t tree_seed, Ranks& ranks);

}  // namespace armature
