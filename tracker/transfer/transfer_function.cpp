#include "tracker/transfer/transfer_function.h"

#include <algorithm>
#include <cmath>

namespace armature {

float transfer(float x, float alpha, float beta) noexcept {
  if (x < alpha) return 0;
  return std::pow((std::min(x, 1.0F) - alpha) / (1 - alpha), beta);
}

float dead_zone(float alpha, float sigma_normalized) noexcept {
  return std::max(alpha, 4 * sigma_normalized);
}

float ShapedMotion::shape(float value, float zone, float beta) noexcept {
  constexpr float kHysteresis = 0.7F;
  const float size = std::abs(value);
  const int side = value < 0 ? -1 : 1;
  if (zone > kMaxDeadZone || side != active_) active_ = 0;
  if (active_ == 0 && size >= zone && zone <= kMaxDeadZone) active_ = side;
  if (active_ == 0) return 0;
  const float shaped = transfer(size, kHysteresis * zone, beta);
  if (shaped == 0) active_ = 0;
  return static_cast<float>(side) * shaped;
}

}  // namespace armature
