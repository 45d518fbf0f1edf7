#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tools/commands/bench/bench.h"
#include "tools/interrupt.h"
#include "tools/json_lines.h"
#include "tools/progress.h"
#include "tools/tracking/steering_run.h"
#include "tools/tracking/tracker_setup.h"

namespace armature::tools {
namespace {

struct SteeringOptions {
  std::string config_file, model, size = "320x240";
  std::vector<int> seeds = {101, 102, 103};
  bool json = false;
};

/// Accuracy on synthetic people: each of the seven scripts that perform one motion alone.
Expected<void> bench_steering(const SteeringOptions& options) {
  auto config = read_setup({.config_file = options.config_file, .model = options.model});
  if (!config) return tl::unexpected(config.error());
  auto forest = load_forest(*config);
  if (!forest) return tl::unexpected(forest.error());
  Interrupt interrupt;
  ProgressBar bar(
      {.title = "steering", .total = static_cast<double>(kMotionCount * options.seeds.size()), .unit = "runs"});
  if (!options.json) {
    std::printf("%s\n", fmt::format("{:<18}{:>8}{:>9}{:>9}{:>8}{:>8}{:>10}{}", "motion", "median", "p95", "slope",
                                    "delay", "gain", "far gain", "  read with it")
                            .c_str());
  }
  for (std::size_t m = 0; m < kMotionCount && !interrupt.requested(); ++m) {
    const MotionId motion = static_cast<MotionId>(m);
    if (motion == MotionId::RotateBust) continue;
    std::vector<std::vector<SteeringFrame>> runs;
    for (const int seed : options.seeds) {
      auto run = run_steering(fmt::format("{}?size={}&seed={}", kMotionNames[m], options.size, seed), *forest,
                              config->tracker);
      if (!run) return tl::unexpected(run.error());
      runs.push_back(std::move(*run));
      bar.update(static_cast<double>(m * options.seeds.size() + runs.size()) /
                 static_cast<double>(kMotionCount * options.seeds.size()));
    }
    const MotionAccuracy accuracy = motion_accuracy(runs, motion, config->tracker.navigation.motions);
    Json crosstalk = Json::object();
    std::string also;
    for (std::size_t other = 0; other < kMotionCount; ++other) {
      if (other == m || static_cast<MotionId>(other) == MotionId::RotateBust) continue;
      crosstalk[std::string(kMotionNames[other])] = number(accuracy.crosstalk[other]);
      if (std::abs(accuracy.crosstalk[other]) >= 0.1)
        also += fmt::format("  {} {:.2f}", kMotionNames[other], accuracy.crosstalk[other]);
    }
    if (options.json) {
      auto written = write_json_line(stdout, {{"motion", kMotionNames[m]},
                                              {"frames", accuracy.frames},
                                              {"error_median", number(accuracy.median)},
                                              {"error_p95", number(accuracy.p95)},
                                              {"slope", number(accuracy.slope)},
                                              {"delay_frames", accuracy.delay_frames},
                                              {"gain", number(accuracy.gain)},
                                              {"far_gain", number(accuracy.far_gain)},
                                              {"crosstalk", crosstalk}});
      if (!written) return written;
    } else {
      std::printf("%s\n", fmt::format("{:<18}{:>8.3f}{:>9.3f}{:>9.2f}{:>8}{:>8.2f}{:>10.2f}{}", kMotionNames[m],
                                      accuracy.median, accuracy.p95, accuracy.slope, accuracy.delay_frames,
                                      accuracy.gain, accuracy.far_gain, also)
                              .c_str());
    }
  }
  return {};
}

}  // namespace

void add_bench_steering(CLI::App& bench, Run& run) {
  auto options = std::make_shared<SteeringOptions>();
  CLI::App* steering = bench.add_subcommand(
      "steering",
      "How right each motion comes out, on synthetic people: error of the normalised value, slope of the "
      "measured angle over the true one, and the gains with which half of the range and all of it would come out "
      "right.");
  steering->add_option("--config", options->config_file, "the daemon's TOML file")->type_name("FILE");
  steering->add_option("--model", options->model, "a forest other than the installed one")->type_name("FILE");
  steering->add_option("--size", options->size, "of the images")->type_name("WxH")->capture_default_str();
  steering->add_option("--seeds", options->seeds, "people")->delimiter(',')->capture_default_str();
  steering->add_flag("--json", options->json, "one JSON object a motion");
  steering->footer("Example:\n  armature bench steering --seeds 101,102,103");
  steering->callback([options, &run] { run = [options] { return bench_steering(*options); }; });
}

}  // namespace armature::tools
