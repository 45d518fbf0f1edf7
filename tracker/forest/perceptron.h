#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "firmware_host/error.h"

namespace armature {

/// y = W x + b.
struct PerceptronLayer {
  int inputs = 0;
  int outputs = 0;
  std::vector<float> weights;  ///< [inputs][outputs]
  std::vector<float> bias;     ///< [outputs]
};

/// A small feed-forward network: affine layers, and max(0, y) after each but the last. Immutable and checked when it
/// was made. The sums run in a fixed order: the same bits on every machine. Thread-safe: yes. Realtime-safe:
/// evaluate().
class Perceptron {
 public:
  static constexpr int kMaxWidth = 512;
  static constexpr int kMaxLayers = 8;

  /// Layers that do not fit together, are too wide or too many, or hold a number that is not finite are an error.
  [[nodiscard]] static Expected<Perceptron> create(std::vector<PerceptronLayer> layers);

  [[nodiscard]] int inputs() const noexcept { return layers_.front().inputs; }
  [[nodiscard]] int outputs() const noexcept { return layers_.back().outputs; }
  [[nodiscard]] std::span<const PerceptronLayer> layers() const noexcept { return layers_; }

  /// `in` holds inputs() numbers, `out` takes outputs().
  void evaluate(std::span<const float> in, std::span<float> out) const noexcept;

 private:
  explicit Perceptron(std::vector<PerceptronLayer> layers) : layers_(std::move(layers)) {}
  std::vector<PerceptronLayer> layers_;
};

/// A network's outputs are [points][3] offsets in metres, then [points] numbers of which this is the error to expect,
/// metres: positive and smooth, about `raw` where that is large.
[[nodiscard]] inline float expected_error_m(float raw) noexcept {
  constexpr float kLeast_m = 0.01F;
  const float root = std::sqrt(raw * raw + 4 * kLeast_m * kLeast_m);
  return raw > 0 ? 0.5F * (raw + root) : 2 * kLeast_m * kLeast_m / (root - raw);  // the same, and no difference is lost
}

}  // namespace armature
