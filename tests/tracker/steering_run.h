#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tracker/installation.h"
#include "tracker/pipeline.h"
#include "tracker/synth/synth_source.h"

namespace armature::test {

/// What a script's true joints say and what the tracker makes of its depth, frame by frame.
struct SteeringFrame {
  bool present = false;
  bool engaged = false;
  PerMotion<float> true_normalized{};
  Navigation truth;    ///< of the true joints, through the same navigator
  Navigation tracked;  ///< of the depth
  std::chrono::nanoseconds dt{0};
};

inline std::shared_ptr<const Forest> shipped_forest() {
  static const auto forest = [] {
    auto loaded = Forest::load(installed_model());
    if (!loaded) throw std::runtime_error(loaded.error().message);
    return std::make_shared<const Forest>(std::move(*loaded));
  }();
  return forest;
}

/// Plays `uri` (without `synth:`) to a pipeline with the given pair.
inline std::vector<SteeringFrame> steer(const std::string& uri, const SteeringPair& pair) {
  using namespace std::chrono_literals;
  auto source = SynthSource::open(uri);
  if (!source) throw std::runtime_error(source.error().message);
  TrackerOptions options;
  options.rest.mode = RestMode::Auto;
  options.navigation.pair = pair;
  options.navigation.allow_correlated = true;
  Pipeline pipeline(shipped_forest(), options);
  Navigator truth(options.navigation, {.mode = RestMode::Fixed, .fixed = (*source)->rest()});

  std::vector<SteeringFrame> frames;
  DepthFrame frame;
  std::chrono::nanoseconds last{0};
  while (true) {
    const auto status = (*source)->read(frame, 1s);
    if (!status) throw std::runtime_error(status.error().message);
    if (*status != ReadStatus::Frame) return frames;
    const TrackerOutput& output = pipeline.process(frame.view());
    const FrameTruth& known = (*source)->truth();
    SteeringFrame now;
    now.present = known.present;
    now.engaged = output.state == EngagementState::Engaged;
    now.true_normalized = known.normalized;
    now.truth = known.present ? truth.process(known.skeleton, (*source)->rest().frame.up, frame.sensor.time)
                              : truth.stop();
    now.tracked = output.navigation;
    now.dt = frame.sensor.time - last;
    last = frame.sensor.time;
    frames.push_back(now);
  }
}

}  // namespace armature::test
