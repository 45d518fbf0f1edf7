#pragma once

#include <cstdint>
#include <string>

#include "firmware_host/error.h"
#include "tracker/forest/trainer.h"
#include "tracker/synth/random.h"

namespace armature::tools {

struct EvaluationOptions {
  std::string model;
  int image_count = 500;
  int stride = 0;
  std::string utd_folder;  ///< empty: no real people
  bool all_actions = false;
};

/// The seed of the i-th image of a training run: never one that is held out.
[[nodiscard]] constexpr std::uint64_t training_seed(std::uint64_t run, std::uint64_t i) noexcept {
  return (run << 32U | i) & ~kHeldOut;
}

/// A synthetic person of the domain that forests are trained on.
[[nodiscard]] TrainingImage synthetic_image(std::uint64_t seed);

/// Prints how well a model does: a table for people, or one JSON object for each kind of data.
[[nodiscard]] Expected<void> evaluate_forest(const EvaluationOptions& options, bool json);

}  // namespace armature::tools
