#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "firmware_host/error.h"
#include "tools/evaluation/scene_evaluation.h"
#include "tracker/forest/trainer.h"
#include "tracker/joints/correction_trainer.h"
#include "tracker/synth/random.h"

namespace armature::tools {

struct EvaluationOptions {
  std::string model;
  SceneOptions scenes;
  bool quick = false;                   ///< the first scene of each category alone
  std::vector<std::string> categories;  ///< empty: all of them
  bool real_only = false;               ///< no scenes
  std::string utd_folder;               ///< empty: no real people
  bool all_actions = false;
  std::string plots;  ///< a folder for pictures; empty: none
};

/// The seed of the i-th image of a training run: never one that is held out.
[[nodiscard]] constexpr std::uint64_t training_seed(std::uint64_t run, std::uint64_t i) noexcept {
  return (run << 32U | i) & ~kHeldOut;
}

/// A synthetic person of the domain that forests are trained on.
[[nodiscard]] TrainingImage synthetic_image(std::uint64_t seed);
/// The same one, and once more at rest.
[[nodiscard]] PersonTwice synthetic_person(std::uint64_t seed);

/// Prints how well a model does on the frozen scenes and on real people, beside just the paper: tables for people, or
/// one JSON object for each kind of data and system.
[[nodiscard]] Expected<void> evaluate_forest(const EvaluationOptions& options, bool json);

}  // namespace armature::tools
