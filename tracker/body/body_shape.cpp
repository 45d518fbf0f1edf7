#include "tracker/body/body_shape.h"

#include <cmath>

#include "tracker/body/rotation.h"

namespace armature {
namespace {

constexpr double kReferenceStature = 1.75;
constexpr double kCraniumRadius = 0.079;

}  // namespace

BodyShape average_shape(double stature, double girth) noexcept {
  const double k = stature / kReferenceStature;
  BodyShape shape;
  shape.stature = stature;
  // A child of 1.2 m has a head of 0.88 of an adult's size, not of 0.69.
  shape.head_scale = on_grid(std::pow(k, 0.35));
  shape.neck = 0.5 * (k + shape.head_scale) * 0.222;
  const double below = stature - shape.neck - kCraniumRadius * shape.head_scale;  // floor to shoulder line
  const double s = below / (0.828 * kReferenceStature) * kReferenceStature;       // stature of an adult with that
  shape.ankle_height = 0.051 * s;
  shape.thigh = 0.245 * s;
  shape.shin = 0.235 * s;
  shape.torso = 0.297 * s;
  shape.foot = 0.085 * s;
  shape.upper_arm = 0.168 * s;
  shape.forearm = 0.145 * s;
  shape.hand = 0.050 * s;
  shape.hip_half_width = 0.09 * k;
  shape.shoulder_half_width = 0.17 * k;
  shape.shoulder_drop = 0.058 * k;
  shape.bulk = k * girth;
  return shape;
}

double standing_hip_height(const BodyShape& shape) noexcept {
  return shape.ankle_height + shape.shin + shape.thigh;
}

}  // namespace armature
