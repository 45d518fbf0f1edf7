#include "tracker/transfer/steering_pair.h"

#include <array>

namespace armature {

bool correlated(const SteeringPair& pair) noexcept {
  using enum MotionId;
  constexpr std::array<SteeringPair, 6> kCorrelated = {{
      {RotateHips, TranslateHips},
      {LeanBust, BendBust},
      {BendKnees, Step},
      {RotateBust, RotateShoulders},
      {RotateBust, RotateHips},
      {RotateBust, TranslateHips},
  }};
  for (const auto& [a, b] : kCorrelated) {
    if ((pair.turn == a && pair.walk == b) || (pair.turn == b && pair.walk == a)) return true;
  }
  return false;
}

std::optional<std::string> refused(const SteeringPair& pair, bool allow_correlated) {
  const std::string turn(kMotionNames[index(pair.turn)]), walk(kMotionNames[index(pair.walk)]);
  if (pair.turn == pair.walk) return "turn and walk are both " + turn + ": one motion cannot steer two things";
  if (correlated(pair) && !allow_correlated) {
    return "turn = " + turn + " and walk = " + walk +
           " move together on most bodies; set allow_correlated = true to steer with them all the same";
  }
  return std::nullopt;
}

}  // namespace armature
