#pragma once

#include <cstdint>
#include <string>

#include "firmware_host/error.h"
#include "tracker/forest/trainer.h"

namespace armature::tools {

struct EvaluationOptions {
  std::string model;
  int image_count = 500;
  int stride = 0;
  std::string utd_folder;  ///< empty: no real people
  bool all_actions = false;
};

/// The seed of the i-th image of a training run. Never one of evaluation_seed().
[[nodiscard]] constexpr std::uint64_t training_seed(std::uint64_t run, std::uint64_t i) noexcept {
  return (run << 32U | i) & ~(std::uint64_t{1} << 63U);
}
/// The seed of the i-th held-out image.
[[nodiscard]] constexpr std::uint64_t evaluation_seed(std::uint64_t i) noexcept {
  return i | std::uint64_t{1} << 63U;
}

/// A synthetic person of the domain that forests are trained on.
[[nodiscard]] TrainingImage synthetic_image(std::uint64_t seed);

/// Prints how well a model does: a table for people, or one JSON object for each kind of data.
[[nodiscard]] Expected<void> evaluate_forest(const EvaluationOptions& options, bool json);

}  // namespace armature::tools
