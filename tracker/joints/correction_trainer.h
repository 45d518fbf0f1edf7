#pragma once

#include <functional>
#include <stop_token>

#include "tracker/forest/perceptron_trainer.h"
#include "tracker/forest/trainer.h"

namespace armature {

/// Somebody in any pose, and before the same camera at rest.
struct PersonTwice {
  TrainingImage image, at_rest;
};
/// The i-th person, always the same for the same i. Called from several threads at once.
using TrainingPersons = std::function<PersonTwice(int i)>;

struct CorrectionOptions {
  int image_count = 20000;
  PerceptronOptions network;
  int threads = 0;  ///< 0: as many as there are cores; changes nothing about the result
};

/// The same forest with a correction (joint_correction.h) that was learned from what its votes say of `persons` and
/// what is true there, and of the same people at rest. Use people that the trees were not trained on: of those they
/// know too much. Pictures in which nobody is found teach nothing and are left out. `progress` gets fractions in [0,
/// 1], from any thread, one at a time.
[[nodiscard]] Expected<Forest> learn_correction(const Forest& forest, const TrainingPersons& persons,
                                                const CorrectionOptions& options,
                                                const std::function<void(double)>& progress, std::stop_token stop);

}  // namespace armature
