#include "tracker/forest/perceptron.h"

#include <array>
#include <limits>

#include <gtest/gtest.h>

#include "tracker/forest/perceptron_trainer.h"
#include "tracker/forest/random.h"

namespace armature {
namespace {

std::vector<PerceptronLayer> two_layers() {
  return {{.inputs = 2, .outputs = 3, .weights = {1, -1, 2, 3, 0.5F, -2}, .bias = {0, 1, -1}},
          {.inputs = 3, .outputs = 1, .weights = {10, 100, 1000}, .bias = {0.25F}}};
}

std::string error_of(std::vector<PerceptronLayer> layers) {
  const auto made = Perceptron::create(std::move(layers));
  return made ? "no error" : made.error().message;
}

TEST(Perceptron, EvaluatesLayersWithNothingNegativeBetweenThem) {
  const auto network = Perceptron::create(two_layers());
  ASSERT_TRUE(network.has_value());
  EXPECT_EQ(network->inputs(), 2);
  EXPECT_EQ(network->outputs(), 1);
  std::array<float, 1> out{};
  // The first layer gives 1 x + 3 y, 1 - x + 0.5 y, -1 + 2 x - 2 y.
  network->evaluate(std::array{2.0F, 1.0F}, out);  // 5, -0.5, 1
  EXPECT_EQ(out[0], 1050.25F);
  network->evaluate(std::array{-1.0F, 0.0F}, out);  // -1, 2, -3
  EXPECT_EQ(out[0], 200.25F);
}

TEST(Perceptron, LayersThatDoNotFitAreRefused) {
  EXPECT_EQ(error_of({}), "0 layers, expected 1 to 8");
  auto layers = two_layers();
  layers[1].inputs = 2;
  layers[1].weights.resize(2);
  EXPECT_EQ(error_of(layers), "layer 1: 2 inputs after 3 outputs");
  layers = two_layers();
  layers[0].weights.pop_back();
  EXPECT_EQ(error_of(layers), "layer 0: the numbers of weights do not match its size");
  layers = two_layers();
  layers[1].bias[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of(layers), "layer 1: a weight is not finite");
  layers = two_layers();
  layers[0].outputs = 0;
  EXPECT_EQ(error_of(layers), "layer 0: 2 inputs and 0 outputs, expected 1 to 512");
}

/// A point that moves with the first input, and one whose place nobody can know: left or right by a coin.
OffsetExamples examples() {
  OffsetExamples out{.inputs = 3, .points = 2, .known = {}, .offset_m = {}};
  TrainingRandom random(7);
  const auto unit = [&] { return static_cast<float>(random.between(-1000, 1000)) / 1000; };
  for (int i = 0; i < 2000; ++i) {
    const std::array known = {unit(), 50 + unit(), 0.001F * unit()};
    const float coin = random.below(2) == 0 ? 0.2F : -0.2F;
    out.known.insert(out.known.end(), known.begin(), known.end());
    out.offset_m.insert(out.offset_m.end(),
                        {0.3F * std::max(0.0F, known[0]), 0.1F * (known[1] - 50), 0.05F, coin, 0, 0});
  }
  return out;
}
const PerceptronOptions kQuick{.hidden = {16}, .epochs = 60, .batch = 32, .step = 5e-3F, .input_noise = 0};

TEST(PerceptronTrainer, LearnsWhatCanBeKnownAndHowLargeTheRestIs) {
  const OffsetExamples set = examples();
  double last = 0;
  const auto network = train_offsets(set, kQuick, [&](double share) { last = share; }, {});
  ASSERT_TRUE(network.has_value()) << network.error().message;
  EXPECT_EQ(last, 1);
  ASSERT_EQ(network->outputs(), 8);
  std::array<float, 8> out{};
  network->evaluate(std::array{0.5F, 50.5F, 0.0F}, out);
  EXPECT_NEAR(out[0], 0.15, 0.015);
  EXPECT_NEAR(out[1], 0.05, 0.015);
  EXPECT_NEAR(out[2], 0.05, 0.015);
  EXPECT_NEAR(expected_error_m(out[6]), 0.05, 0.01);  // as little as counts
  EXPECT_NEAR(expected_error_m(out[7]), 0.2, 0.03);
}

TEST(PerceptronTrainer, TheSameExamplesGiveTheSameBits) {
  const OffsetExamples set = examples();
  const auto weights = [&] {
    const auto network = train_offsets(set, kQuick, [](double) {}, {});
    return std::vector<float>(network->layers()[0].weights);
  };
  EXPECT_EQ(weights(), weights());
}

TEST(PerceptronTrainer, NothingToLearnFromAndAStopAreErrors) {
  EXPECT_EQ(train_offsets({}, kQuick, [](double) {}, {}).error().message, "training: no example to learn offsets from");
  OffsetExamples wrong = examples();
  wrong.offset_m.pop_back();
  EXPECT_FALSE(train_offsets(wrong, kQuick, [](double) {}, {}).has_value());
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(train_offsets(
                   examples(), kQuick, [](double) {}, stop.get_token())
                   .has_value());
}

TEST(PerceptronTrainer, OptionsThatCannotBeAreRefused) {
  const auto refusal = [](PerceptronOptions options) {
    const auto network = train_offsets(examples(), options, [](double) {}, {});
    return network ? "accepted" : network.error().message;
  };
  EXPECT_EQ(refusal({.hidden = {16}, .batch = 0}), "training: expected at least one epoch and a batch of one");
  EXPECT_EQ(refusal({.hidden = {16}, .epochs = 0}), "training: expected at least one epoch and a batch of one");
  EXPECT_EQ(refusal({.hidden = {513}}), "training: hidden layers are 1 to 512 wide");
  EXPECT_EQ(refusal({.hidden = {16, 0}}), "training: hidden layers are 1 to 512 wide");
}

TEST(ExpectedError, IsPositiveAndSmooth) {
  EXPECT_FLOAT_EQ(expected_error_m(0), 0.01F);
  EXPECT_GT(expected_error_m(-1), 0);
  EXPECT_GT(expected_error_m(-1000), 0);
  EXPECT_NEAR(expected_error_m(0.3F), 0.3, 0.001);
}

}  // namespace
}  // namespace armature
