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

/// What a person has to be like.
struct PersonWish {
  enum class Body : std::uint8_t { Any, Adult, Child } body = Body::Any;  ///< a child is shorter than 1.5 m
  enum class Clothes : std::uint8_t { Any, Plain, Coat, Skirt } clothes = Clothes::Any;
  double girth = 0;  ///< within 5 % of it, 1 being slim; 0.8 to 1.4, or 0: any

  [[nodiscard]] bool fulfilled_by(const Person& person) const noexcept;
};

/// A person drawn from the population that carried over to real people: stature 1.2 to 2.0 m (one in six a child),
/// lognormal girth (0.04, 0.14), cloth of 0 to 28 mm, skirts and coats in 16 %, hair, and with `carries` a bag, a
/// backpack, a mug or a phone in one of three.
[[nodiscard]] Person random_person(Random& random, bool carries = true);

/// The first of them who is as wished, carrying nothing.
[[nodiscard]] Person random_person(Random& random, const PersonWish& wish);

}  // namespace armature
