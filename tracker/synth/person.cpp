#include "tracker/synth/person.h"

#include <algorithm>
#include <cmath>

namespace armature {
namespace {

constexpr double kAdultStature_m = 1.5;
/// Trousers under a skirt are tight, those under a coat may be anything: what is wider than this is under a coat.
constexpr double kTightTrousers_m = 0.008;

}  // namespace

bool PersonWish::fulfilled_by(const Person& person) const noexcept {
  const BodyShape& shape = person.shape;
  const Outfit& outfit = person.outfit;
  if (body != Body::Any && (body == Body::Child) != (shape.stature < kAdultStature_m)) return false;
  if (girth > 0 && std::abs(shape.bulk * 1.75 / shape.stature / girth - 1) > 0.05) return false;
  switch (clothes) {
    case Clothes::Any: return true;
    case Clothes::Plain: return outfit.skirt == 0;
    case Clothes::Coat: return outfit.skirt > 0 && outfit.trousers > kTightTrousers_m;
    case Clothes::Skirt: return outfit.skirt > 0 && outfit.trousers <= kTightTrousers_m;
  }
  return false;
}

Person random_person(Random& random, const PersonWish& wish) {
  while (true) {
    const Person person = random_person(random, false);
    if (wish.fulfilled_by(person)) return person;
  }
}

Person random_person(Random& random, bool carries) {
  Person person;
  const bool child = random.chance(1.0 / 6);
  const double stature = child ? random.uniform(1.2, 1.55) : std::clamp(1.72 + 0.10 * random.normal(), 1.45, 2.0);
  BodyShape& shape = person.shape;
  shape = average_shape(stature, std::clamp(random.lognormal(0.04, 0.14), 0.75, 1.5));
  const auto vary = [&](double& length, double sigma) {
    length *= 1 + std::clamp(sigma * random.normal(), -3 * sigma, 3 * sigma);
  };
  vary(shape.thigh, 0.03);
  vary(shape.shin, 0.03);
  vary(shape.torso, 0.03);
  vary(shape.neck, 0.04);
  vary(shape.upper_arm, 0.04);
  vary(shape.forearm, 0.04);
  vary(shape.hand, 0.06);
  vary(shape.hip_half_width, 0.06);
  vary(shape.shoulder_half_width, 0.06);
  vary(shape.head_scale, 0.05);
  // Wide bodies have somewhat wider frames.
  const double girth = shape.bulk / (stature / 1.75);
  shape.shoulder_half_width *= 1 + 0.35 * (girth - 1);
  shape.hip_half_width *= 1 + 0.25 * (girth - 1);
  shape.stature = standing_hip_height(shape) + shape.torso + shape.neck + 0.079 * shape.head_scale;

  Outfit& outfit = person.outfit;
  outfit.cloth = random.uniform(0.002, 0.034);
  outfit.trousers = random.uniform(0, 0.03);
  outfit.sleeves = random.chance(0.3) ? 0.0 : random.uniform(0, 0.8) * outfit.cloth;
  outfit.shoe = random.uniform(0, 0.014);
  if (random.chance(0.16)) {
    const bool coat = random.chance(0.4);
    outfit.skirt = coat ? random.uniform(0.35, 0.95) : random.uniform(0.45, 1.6);
    outfit.skirt_flare = coat ? random.uniform(0, 0.04) : random.uniform(0.01, 0.12);
    if (coat) outfit.cloth = random.uniform(0.012, 0.032);
    if (!coat) outfit.trousers = random.uniform(0, 0.008);
  }
  outfit.hair = random.chance(0.08) ? 0.0 : random.uniform(0.004, 0.03);
  outfit.hair_length = outfit.hair > 0 && random.chance(0.3) ? random.uniform(0.05, 0.24) : 0.0;
  if (carries && random.chance(1.0 / 3)) {
    using Bag = Outfit::Bag;
    constexpr std::array<Bag, 5> kBags = {Bag::Hand, Bag::Shoulder, Bag::Backpack, Bag::Mug, Bag::Phone};
    outfit.bag = kBags[static_cast<std::size_t>(random.below(5))];
    outfit.bag_side = random.chance(0.5) ? Side::Left : Side::Right;
    outfit.bag_size = random.uniform(0.7, 1.2) * std::min(1.0, stature / 1.6);
  }
  return person;
}

}  // namespace armature
