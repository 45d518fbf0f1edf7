#pragma once

#include <cstdint>

#include "tracker/body/skeleton.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

/// Lowers the confidence of joints that something else stands before: a person, a counter, a chair. What the model says
/// of those is a guess, and drifts as what votes for them disappears. The confidence falls to zero, and the state to
/// Inferred, as half of what is seen around a joint comes to lie before it and belong to somebody else.
/// The person's own body, clothes and what she holds hide nothing, nor does the floor.
/// Deterministic. Thread-safe: yes, for skeletons apart. Realtime-safe: yes.
void doubt_hidden_joints(DepthView frame, const Segmentation& segmentation, std::uint8_t user,
                         Skeleton& skeleton) noexcept;

}  // namespace armature
