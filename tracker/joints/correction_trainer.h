#pragma once

#include <functional>
#include <stop_token>

#include "tracker/forest/perceptron_trainer.h"
#include "tracker/forest/trainer.h"

namespace armature {

struct CorrectionOptions {
  int image_count = 20000;
  PerceptronOptions network;
  int threads = 0;  ///< 0: as many as there are cores; changes nothing about the result
};

/// The same forest with a correction (joint_correction.h) that was learned from what its votes say of `images` and
/// what is true there. Use images that the trees were not trained on: of those they know too much. Pictures in which
/// nobody is found teach nothing and are left out. `progress` gets fractions in [0, 1], from any thread, one at a time.
[[nodiscard]] Expected<Forest> learn_correction(const Forest& forest, const TrainingImages& images,
                                                const CorrectionOptions& options,
                                                const std::function<void(double)>& progress, std::stop_token stop);

}  // namespace armature
