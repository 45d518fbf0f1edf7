#pragma once

#include <span>

#include "tracker/forest/training_set.h"

namespace armature {

/// Sums up the samples that ended in a leaf: how often each part occurs and, for the joints near those parts, where the
/// joint lies from the sample: the mode of the offsets (flat mean shift, 15 cm) with the weight
/// p (s^2 / (variance + s^2))^2, s = 4 cm, p the probability of the parts around the joint.
[[nodiscard]] Leaf make_leaf(std::span<const TrainingPerson> persons, std::span<const TrainingSample> samples);

}  // namespace armature
