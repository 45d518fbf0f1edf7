#include "tracker/forest/perceptron_trainer.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <Eigen/Core>

#include "tracker/forest/random.h"

namespace armature {
namespace {

using Matrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Row = Eigen::RowVectorXf;

constexpr float kSmooth_m =
    0.05F;  // below this, an error counts by its square: a mean, where a median would have a dead zone

/// Eigen blocks its products by the size of the machine's caches, which decides the order of sums.
void fix_order_of_sums() {
  Eigen::setCpuCacheSizes(32 << 10, 512 << 10, 4 << 20);
}

/// In [-1, 1].
float symmetric_unit(TrainingRandom& random) {
  return static_cast<float>(random.between(-(1 << 20), 1 << 20)) / static_cast<float>(1 << 20);
}

/// A parameter of the network with its Adam moments.
struct Parameter {
  Matrix value, gradient, first, second;

  explicit Parameter(Eigen::Index rows, Eigen::Index columns)
      : value(Matrix::Zero(rows, columns)), gradient(value), first(value), second(value) {}

  /// `first_left`, `second_left`: 1 - beta^t, what is missing of the running means.
  void step(float size, float decay, float first_left, float second_left) {
    constexpr float kBeta1 = 0.9F, kBeta2 = 0.999F, kEpsilon = 1e-8F;
    first = kBeta1 * first + (1 - kBeta1) * gradient;
    second = kBeta2 * second + (1 - kBeta2) * gradient.cwiseProduct(gradient);
    value.array() -= size * ((first.array() / first_left) / ((second.array() / second_left).sqrt() + kEpsilon) +
                             decay * value.array());
  }
};

struct Layer {
  Parameter weights, bias;
  Matrix input;  // of the last forward pass
  Layer(Eigen::Index inputs, Eigen::Index outputs) : weights(inputs, outputs), bias(1, outputs) {}
};

class Network {
 public:
  Network(const std::vector<int>& widths, std::uint64_t seed) {
    TrainingRandom random(seed);
    for (std::size_t i = 0; i + 1 < widths.size(); ++i) {
      Layer& layer = layers_.emplace_back(widths[i], widths[i + 1]);
      // Small weights to begin with: a network that starts out rough stays rough, and moves joints by their noise.
      const float range = (i + 2 == widths.size() ? 0.1F : 1.0F) / std::sqrt(static_cast<float>(widths[i]));
      for (float& w : layer.weights.value.reshaped<Eigen::RowMajor>()) w = range * symmetric_unit(random);
      for (float& b : layer.bias.value.reshaped<Eigen::RowMajor>()) b = range * symmetric_unit(random);
    }
  }

  const Matrix& forward(const Matrix& in) {
    for (std::size_t i = 0; i < layers_.size(); ++i) {
      Layer& layer = layers_[i];
      layer.input = i == 0 ? in : Matrix(out_.cwiseMax(0.0F));
      out_.noalias() = layer.input * layer.weights.value;
      out_.rowwise() += Row(layer.bias.value.row(0));
    }
    return out_;
  }

  /// `gradient`: of the loss by the outputs of the last forward pass.
  void backward(Matrix gradient) {
    for (std::size_t i = layers_.size(); i-- > 0;) {
      Layer& layer = layers_[i];
      layer.weights.gradient.noalias() = layer.input.transpose() * gradient;
      layer.bias.gradient = gradient.colwise().sum();
      if (i == 0) break;
      Matrix below = gradient * layer.weights.value.transpose();
      gradient = (layer.input.array() > 0).select(below, 0.0F);
    }
  }

  void step(float size, float decay) {
    beta1_ *= 0.9F;
    beta2_ *= 0.999F;
    for (Layer& layer : layers_) {
      layer.weights.step(size, decay, 1 - beta1_, 1 - beta2_);
      layer.bias.step(size, 0, 1 - beta1_, 1 - beta2_);
    }
  }

  /// The layers for inputs that were not normalised by `mean` and `deviation` before.
  [[nodiscard]] std::vector<PerceptronLayer> layers(const Row& mean, const Row& deviation) const {
    std::vector<PerceptronLayer> out;
    for (const Layer& layer : layers_) {
      Matrix weights = layer.weights.value;
      Row bias = layer.bias.value.row(0);
      if (out.empty()) {
        weights = deviation.cwiseInverse().transpose().asDiagonal() * weights;
        bias -= mean * weights;
      }
      out.push_back({.inputs = static_cast<int>(weights.rows()),
                     .outputs = static_cast<int>(weights.cols()),
                     .weights = {weights.data(), weights.data() + weights.size()},
                     .bias = {bias.data(), bias.data() + bias.size()}});
    }
    return out;
  }

 private:
  std::vector<Layer> layers_;
  Matrix out_;
  float beta1_ = 1, beta2_ = 1;
};

/// The gradient of the mean loss of a batch by the network's outputs.
Matrix loss_gradient(const Matrix& out, const Matrix& wanted_m) {
  Matrix gradient(out.rows(), out.cols());
  const Eigen::Index points = wanted_m.cols() / 3;
  const float share = 1 / static_cast<float>(out.rows() * points);
  for (Eigen::Index row = 0; row < out.rows(); ++row) {
    for (Eigen::Index p = 0; p < points; ++p) {
      const Eigen::Vector3f miss = (out.row(row).segment<3>(3 * p) - wanted_m.row(row).segment<3>(3 * p)).transpose();
      const float error = std::sqrt(miss.squaredNorm() + kSmooth_m * kSmooth_m);
      const float raw = out(row, 3 * points + p);
      const float s = expected_error_m(raw);
      gradient.row(row).segment<3>(3 * p) = (share / (error * s)) * miss.transpose();
      const float slope = s / (2 * s - raw);  // of s by raw
      gradient(row, 3 * points + p) = share * (1 / s - error / (s * s)) * slope;
    }
  }
  return gradient;
}

}  // namespace

Expected<Perceptron> train_offsets(const OffsetExamples& examples, const PerceptronOptions& options,
                                   const std::function<void(double)>& progress, std::stop_token stop) {
  const auto count = static_cast<Eigen::Index>(examples.count());
  if (count == 0) return fail("training: no example to learn offsets from");
  if (examples.known.size() != static_cast<std::size_t>(count * examples.inputs) ||
      examples.offset_m.size() != static_cast<std::size_t>(count * examples.points * 3)) {
    return fail("training: the examples' inputs and offsets do not match");
  }
  if (options.batch < 1 || options.epochs < 1) return fail("training: expected at least one epoch and a batch of one");
  if (!std::ranges::all_of(options.hidden, [](int width) { return width >= 1 && width <= Perceptron::kMaxWidth; })) {
    return fail("training: hidden layers are 1 to " + std::to_string(Perceptron::kMaxWidth) + " wide");
  }
  fix_order_of_sums();
  const Eigen::Map<const Matrix> known(examples.known.data(), count, examples.inputs);
  const Eigen::Map<const Matrix> wanted_m(examples.offset_m.data(), count, 3 * examples.points);
  const Row mean = (known.cast<double>().colwise().mean()).cast<float>();
  constexpr float kLeastDeviation = 1e-3F;
  const Row deviation = ((known.rowwise() - mean).cast<double>().colwise().squaredNorm() / static_cast<double>(count))
                            .cwiseSqrt()
                            .cast<float>()
                            .cwiseMax(kLeastDeviation);

  std::vector<int> widths = {examples.inputs};
  widths.insert(widths.end(), options.hidden.begin(), options.hidden.end());
  widths.push_back(4 * examples.points);
  Network network(widths, derive_seed(options.seed, 0));

  TrainingRandom random(derive_seed(options.seed, 1));
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  for (int epoch = 0; epoch < options.epochs; ++epoch) {
    const float step =
        options.step * std::max(0.02F, 1 - static_cast<float>(epoch) / static_cast<float>(options.epochs));
    for (std::size_t i = order.size(); i-- > 1;) {
      std::swap(order[i], order[random.below(static_cast<std::uint32_t>(i + 1))]);
    }
    for (Eigen::Index begin = 0; begin < count; begin += options.batch) {
      if (stop.stop_requested()) return fail("training: stopped while learning offsets");
      const Eigen::Index size = std::min<Eigen::Index>(options.batch, count - begin);
      Matrix in(size, examples.inputs), out_m(size, 3 * examples.points);
      for (Eigen::Index i = 0; i < size; ++i) {
        const Eigen::Index example = order[static_cast<std::size_t>(begin + i)];
        in.row(i) = (known.row(example) - mean).cwiseQuotient(deviation);
        out_m.row(i) = wanted_m.row(example);
      }
      // A uniform number in [-1, 1] has a deviation of 1 / sqrt 3.
      for (float& x : in.reshaped<Eigen::RowMajor>())
        x += std::sqrt(3.0F) * options.input_noise * symmetric_unit(random);
      network.backward(loss_gradient(network.forward(in), out_m));
      network.step(step, options.decay);
    }
    progress((epoch + 1.0) / options.epochs);
  }
  return Perceptron::create(network.layers(mean, deviation));
}

}  // namespace armature
