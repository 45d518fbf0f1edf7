#pragma once

#include <cstdint>

#include "tracker/body/body_shape.h"
#include "tracker/body/body_surface.h"
#include "tracker/synth/random.h"

namespace armature {

/// Somebody: a build and what she wears and carries.
struct Person {
  BodyShape shape;
  Outfit outfit;
};

/// A person drawn from the population that carried over to real people: stature 1.2 to 2.0 m (one in six a child),
/// lognormal girth (0.04, 0.14), cloth of 0 to 28 mm, skirts and coats in 16 %, hair, and with `carries` a bag, a
/// backpack, a mug or a phone in one of three.
[[nodiscard]] Person random_person(Random& random, bool carries = true);

}  // namespace armature
