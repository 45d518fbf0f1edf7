#pragma once

#include <span>
#include <vector>

#include "tracker/body/skeleton.h"

namespace armature::tools {

/// A recording of a person as two see her, frame by frame: we, and the Kinect SDK (navigation joints only).
struct SeenTwice {
  int person = 0;
  std::vector<Skeleton> ours, sdk;
};

/// Our skeletons with their navigation joints moved to where the SDK would put them, by a linear regression from all
/// of our joints that was learned from what the SDK says of the *other* persons. Nothing may be shipped that was made
/// like this: it says how much of the disagreement is habit of the SDK rather than anybody's error, and what agreement
/// could be had by imitating it. Of fewer than two persons the skeletons come back as they were.
[[nodiscard]] std::vector<std::vector<Skeleton>> imitate_sdk(std::span<const SeenTwice> recordings);

}  // namespace armature::tools
