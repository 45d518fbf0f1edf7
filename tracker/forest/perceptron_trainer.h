#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <vector>

#include "tracker/forest/perceptron.h"

namespace armature {

/// What a network is to learn: from `inputs` numbers the offsets of `points` points in space.
struct OffsetExamples {
  int inputs = 0;
  int points = 0;
  std::vector<float> known;     ///< [example][inputs]
  std::vector<float> offset_m;  ///< [example][points][3]

  [[nodiscard]] std::size_t count() const noexcept {
    return inputs == 0 ? 0 : known.size() / static_cast<std::size_t>(inputs);
  }
};

struct PerceptronOptions {
  std::vector<int> hidden = {256, 256};
  int epochs = 20;
  int batch = 64;
  float step = 1e-3F;        ///< Adam's; falls linearly to a fiftieth
  float decay = 1e-5F;       ///< of the weights, a step
  float input_noise = 0.2F;  ///< in standard deviations of each input: what is exact in training is not in use
  std::uint64_t seed = 1;
};

/// Learns offsets and their expected errors together: the loss of a point is log s + e / s with s its expected error
/// and e^2 = |error|^2 + (5 cm)^2. It is least where s is the mean of e; an error counts less where it could not be
/// avoided; small ones count by their square, so that what is learned is a mean: a median keeps small motions at rest.
/// Adam (Kingma and Ba 2015) in one thread and a fixed order: the same weights on every machine. An empty or
/// inconsistent set, and a stop, are an error. `progress` gets fractions in [0, 1].
[[nodiscard]] Expected<Perceptron> train_offsets(const OffsetExamples& examples, const PerceptronOptions& options,
                                                 const std::function<void(double)>& progress, std::stop_token stop);

}  // namespace armature
