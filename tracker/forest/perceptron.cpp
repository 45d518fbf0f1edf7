#include "tracker/forest/perceptron.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <string>

namespace armature {
namespace {

Expected<void> check(const PerceptronLayer& layer, std::size_t number) {
  const std::string place = "layer " + std::to_string(number) + ": ";
  const auto width_ok = [](int n) { return n >= 1 && n <= Perceptron::kMaxWidth; };
  if (!width_ok(layer.inputs) || !width_ok(layer.outputs)) {
    return fail(place + std::to_string(layer.inputs) + " inputs and " + std::to_string(layer.outputs) +
                " outputs, expected 1 to " + std::to_string(Perceptron::kMaxWidth));
  }
  const auto inputs = static_cast<std::size_t>(layer.inputs);
  const auto outputs = static_cast<std::size_t>(layer.outputs);
  if (layer.weights.size() != inputs * outputs || layer.bias.size() != outputs) {
    return fail(place + "the numbers of weights do not match its size");
  }
  const auto finite = [](float x) { return std::isfinite(x); };
  if (!std::all_of(layer.weights.begin(), layer.weights.end(), finite) ||
      !std::all_of(layer.bias.begin(), layer.bias.end(), finite)) {
    return fail(place + "a weight is not finite");
  }
  return {};
}

}  // namespace

Expected<Perceptron> Perceptron::create(std::vector<PerceptronLayer> layers) {
  if (layers.empty() || layers.size() > kMaxLayers) {
    return fail(std::to_string(layers.size()) + " layers, expected 1 to " + std::to_string(kMaxLayers));
  }
  for (std::size_t i = 0; i < layers.size(); ++i) {
    if (const auto checked = check(layers[i], i); !checked) return tl::unexpected(checked.error());
    if (i > 0 && layers[i].inputs != layers[i - 1].outputs) {
      return fail("layer " + std::to_string(i) + ": " + std::to_string(layers[i].inputs) + " inputs after " +
                  std::to_string(layers[i - 1].outputs) + " outputs");
    }
  }
  return Perceptron(std::move(layers));
}

void Perceptron::evaluate(std::span<const float> in, std::span<float> out) const noexcept {
  assert(in.size() == static_cast<std::size_t>(inputs()) && out.size() == static_cast<std::size_t>(outputs()));
  std::array<float, kMaxWidth> x{}, y{};
  std::copy(in.begin(), in.end(), x.begin());
  for (const PerceptronLayer& layer : layers_) {
    const auto outputs = static_cast<std::size_t>(layer.outputs);
    std::copy(layer.bias.begin(), layer.bias.end(), y.begin());
    const float* row = layer.weights.data();
    for (std::size_t i = 0; i < static_cast<std::size_t>(layer.inputs); ++i, row += outputs) {
      const float xi = x[i];
      if (xi == 0) continue;  // half of them, behind max(0, y)
      for (std::size_t o = 0; o < outputs; ++o) y[o] += row[o] * xi;
    }
    if (&layer == &layers_.back()) break;
    for (std::size_t o = 0; o < outputs; ++o) x[o] = std::max(0.0F, y[o]);
  }
  std::copy_n(y.begin(), out.size(), out.begin());
}

}  // namespace armature
