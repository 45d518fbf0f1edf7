#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <armature/navproto/publisher.h>
#include <fmt/format.h>
#include <unistd.h>

#include "tools/commands/bench/bench.h"
#include "tools/commands/bench/tracker_load.h"
#include "tools/interrupt.h"
#include "tools/progress.h"
#include "tools/tracking/frame_json.h"
#include "tools/tracking/tracker_setup.h"
#include "tracker/daemon/wire.h"
#include "tracker/synth/open_source.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

/// The fixed synthetic person that speed is measured on unless told otherwise.
constexpr std::string_view kBenchPerson = "synth:lean_bust?size=320x240&seed=4";

struct BenchOptions {
  std::string source{kBenchPerson};
  TrackerSetup setup;
  int rounds = 3;
  std::string load = "none";
  bool json = false;
};

struct Percentiles {
  double p50 = 0, p90 = 0, p99 = 0;
};

Percentiles percentiles(std::vector<double> values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
  };
  return {at(0.50), at(0.90), at(0.99)};
}

Json percentiles_json(const Percentiles& p) {
  return {{"p50", number(p.p50)}, {"p90", number(p.p90)}, {"p99", number(p.p99)}};
}

/// A socket of the bench's own, gone when it is.
struct PrivateEndpoint {
  std::filesystem::path folder = std::filesystem::temp_directory_path() / fmt::format("armature-bench-{}", getpid());
  PrivateEndpoint() { std::filesystem::create_directories(folder); }
  ~PrivateEndpoint() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  PrivateEndpoint(const PrivateEndpoint&) = delete;
  PrivateEndpoint& operator=(const PrivateEndpoint&) = delete;
  [[nodiscard]] std::string uri() const { return "ipc://" + (folder / "nav").string(); }
};

Expected<std::vector<DepthFrame>> read_all(const std::string& uri, const Interrupt& interrupt) {
  auto source = open_source(uri);
  if (!source) return tl::unexpected(source.error());
  const long total = (*source)->info().frame_count;
  ProgressBar bar({.title = "reading", .total = static_cast<double>(std::max(0L, total)), .unit = "frames"});
  constexpr std::size_t kMostFrames = 1500;
  std::vector<DepthFrame> frames;
  while (!interrupt.requested() && frames.size() < kMostFrames) {
    DepthFrame frame;
    const auto status = (*source)->read(frame, 1000ms);
    if (!status) return tl::unexpected(status.error());
    if (*status == ReadStatus::EndOfStream) break;
    if (*status == ReadStatus::Frame) frames.push_back(std::move(frame));
    if (total > 0) bar.update(static_cast<double>(frames.size()) / static_cast<double>(total));
  }
  if (frames.empty()) return fail(uri + ": not a single frame");
  return frames;
}

struct Times {
  std::vector<double> total_us;
  std::array<std::vector<double>, kStageCount + 1> stage_us;  // the last: making and handing over the message
};

/// Tracks all frames, a round to warm up and `rounds` that count, with `load` beside.
Expected<Times> measure(std::vector<DepthFrame>& frames, const std::shared_ptr<const Forest>& forest,
                        const TrackerOptions& tracker, int rounds, Load load, const Interrupt& interrupt) {
  const PrivateEndpoint endpoint;
  auto publisher = navproto::Publisher::bind(endpoint.uri());
  if (!publisher) return fail(publisher.error().message);
  const auto beside = TrackerLoad::start(load, endpoint.uri(), endpoint.folder);
  if (!beside) return tl::unexpected(beside.error());
  Pipeline pipeline(forest, tracker);
  pipeline.reset(frames.front().intrinsics);
  const SteadyClock clock;
  navproto::NavigationMessage message;
  Times times;
  std::chrono::nanoseconds offset{0};
  const double work = static_cast<double>(frames.size()) * rounds;
  ProgressBar bar({.title = fmt::format("tracking, load {}", kLoadNames[static_cast<std::size_t>(load)]),
                   .total = work,
                   .unit = "frames"});

  // Rounds follow each other in time, so that the tracker sees one long recording; the first warms up, and others until
  // the load is under way.
  constexpr int kMostWarmingUp = 40;
  for (int round = -1, warming_up = 0; round < rounds && !interrupt.requested(); ++round) {
    for (DepthFrame& frame : frames) {
      const auto recorded = frame.sensor.time;
      frame.sensor.time += offset;
      const auto received = clock.now();
      frame.host = {received, ClockId::HostMonotonic};
      const TrackerOutput& output = pipeline.process(frame.view());
      const auto processed = clock.now();
      fill_message(message, output, pipeline.navigation_options().pair);
      publisher->publish_navigation(message);
      const auto published = clock.now();
      (*beside)->offer(frame.view(), output.user_of_pixel);
      frame.sensor.time = recorded;
      if (round < 0) continue;
      const auto us = [](std::chrono::nanoseconds t) { return std::chrono::duration<double, std::micro>(t).count(); };
      times.total_us.push_back(us(published - received));
      for (std::size_t s = 0; s < kStageCount; ++s) times.stage_us[s].push_back(us(output.stage_time[s]));
      times.stage_us[kStageCount].push_back(us(published - processed));
      if (times.total_us.size() % 64 == 0) bar.update(static_cast<double>(times.total_us.size()) / work);
    }
    offset += frames.back().sensor.time - frames.front().sensor.time + 33ms;
    const auto under_way = (*beside)->under_way();
    if (!under_way) return tl::unexpected(under_way.error());
    if (round < 0 && !*under_way) {
      if (++warming_up > kMostWarmingUp) return fail("bench tracker: the recording beside does not begin");
      --round;
    }
  }
  bar.finish();
  return times;
}

Expected<void> report(const BenchOptions& options, Load load, const Intrinsics& size, const Times& times) {
  const Percentiles total = percentiles(times.total_us);
  const auto stage_name = [](std::size_t s) { return s < kStageCount ? kStageNames[s] : std::string_view("publish"); };
  if (options.json) {
    Json stages = Json::object();
    for (std::size_t s = 0; s <= kStageCount; ++s) {
      stages[std::string(stage_name(s))] = percentiles_json(percentiles(times.stage_us[s]));
    }
    return write_json_line(stdout, {{"source", options.source},
                                    {"load", std::string(kLoadNames[static_cast<std::size_t>(load)])},
                                    {"frames", times.total_us.size()},
                                    {"total_us", percentiles_json(total)},
                                    {"stages_us", stages}});
  }
  const auto row = [](std::string_view name, const Percentiles& p) {
    std::printf("%s\n", fmt::format("{:<14}{:>10.1f}{:>10.1f}{:>10.1f}", name, p.p50, p.p90, p.p99).c_str());
  };
  std::printf("%s\n",
              fmt::format("{}, {} frames of {}x{}, load {}, microseconds", options.source, times.total_us.size(),
                          size.width, size.height, kLoadNames[static_cast<std::size_t>(load)])
                  .c_str());
  std::printf("%-14s%10s%10s%10s\n", "", "p50", "p90", "p99");
  for (std::size_t s = 0; s <= kStageCount; ++s) row(stage_name(s), percentiles(times.stage_us[s]));
  row("total", total);
  return {};
}

Expected<void> bench_tracker(const BenchOptions& options) {
  auto config = read_setup(options.setup);
  if (!config) return tl::unexpected(config.error());
  auto forest = load_forest(*config);
  if (!forest) return tl::unexpected(forest.error());
  const Interrupt interrupt;
  auto frames = read_all(options.source, interrupt);
  if (!frames) return tl::unexpected(frames.error());
  for (std::size_t load = 0; load < kLoadNames.size() && !interrupt.requested(); ++load) {
    if (options.load != "all" && options.load != kLoadNames[load]) continue;
    const auto which = static_cast<Load>(load);
    const auto times = measure(*frames, *forest, config->tracker, options.rounds, which, interrupt);
    if (!times) return tl::unexpected(times.error());
    if (auto reported = report(options, which, frames->front().intrinsics, *times); !reported) return reported;
  }
  return {};
}

}  // namespace

void add_bench_tracker(CLI::App& bench, Run& run) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* tracker = bench.add_subcommand(
      "tracker", "From a frame received to its message handed to the socket, on one core, and each stage of it.");
  tracker->add_option("--source", options->source, "oni:FILE, fakenect:DIR or synth:NAME; read into memory first")
      ->type_name("URI")
      ->capture_default_str();
  add_tracker_setup(*tracker, options->setup);
  tracker->add_option("--rounds", options->rounds, "times the recording is measured, after one round of warming up")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  tracker
      ->add_option("--load", options->load,
                   "what goes on beside: a recording of the feed, a flood of subscribers, both; or all in turn")
      ->check(CLI::IsMember({"none", "recording", "flood", "both", "all"}))
      ->capture_default_str();
  tracker->add_flag("--json", options->json, "one JSON object a load");
  tracker->footer(
      "Machines are noisy: compare percentiles of one run, or run both sides in turns.\n\n"
      "Example:\n  armature bench tracker --source 'synth:demo?size=640x480' --load all");
  tracker->callback([options, &run] { run = [options] { return bench_tracker(*options); }; });
}

}  // namespace armature::tools
