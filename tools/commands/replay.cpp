#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "tools/commands/commands.h"
#include "tools/interrupt.h"
#include "tools/progress.h"
#include "tools/tracking/frame_json.h"
#include "tools/tracking/tracker_setup.h"
#include "tracker/synth/open_source.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

struct ReplayOptions {
  std::string source;
  TrackerSetup setup;
  std::string compare, save_rest;
  bool json = false, timings = false;
};

/// An earlier run, line by line.
class EarlierRun {
 public:
  static Expected<EarlierRun> open(const std::string& path) {
    EarlierRun run;
    run.path_ = path;
    run.in_.open(path);
    if (!run.in_) return fail(path + ": cannot be read; --compare takes the output of an earlier `replay --json`");
    return run;
  }

  /// Fails where this run's frame is not the earlier one's.
  Expected<void> expect(const Json& line) {
    std::string text;
    if (!std::getline(in_, text)) {
      return fail(fmt::format("{}: ends after {} frames, this run goes on", path_, lines_));
    }
    ++lines_;
    Json earlier = Json::parse(text, nullptr, false);
    if (earlier.is_discarded()) return fail(fmt::format("{}:{}: not a line of `replay --json`", path_, lines_));
    earlier.erase("stage_us");
    if (auto difference = first_difference(line, earlier)) {
      return fail(fmt::format("{}:{}: frame {} differs: {}", path_, lines_, line["frame"].dump(), *difference));
    }
    return {};
  }
  Expected<void> expect_end() {
    std::string text;
    if (std::getline(in_, text)) return fail(fmt::format("{}:{}: goes on, this run is over", path_, lines_ + 1));
    return {};
  }
  [[nodiscard]] int lines() const { return lines_; }

 private:
  std::string path_;
  std::ifstream in_;
  int lines_ = 0;
};

void print_line(const TrackerOutput& output, std::uint64_t frame, double time_s, const SteeringPair& pair) {
  const auto& motions = output.navigation.motions;
  std::printf("%s\n", fmt::format("{:6} {:8.3f} s  {}  {} {:+.2f}  {} {:+.2f}  {:+.3f} m/s {:+.3f} rad/s", frame,
                                  time_s, output.tracking ? fmt::format("user {}", output.user) : "nobody",
                                  kMotionNames[index(pair.walk)], motions[index(pair.walk)].normalized,
                                  kMotionNames[index(pair.turn)], motions[index(pair.turn)].normalized,
                                  output.navigation.velocity.linear_m_s, output.navigation.velocity.angular_rad_s)
                          .c_str());
}

Expected<void> replay(const ReplayOptions& options) {
  auto config = read_setup(options.setup);
  if (!config) return tl::unexpected(config.error());
  std::unique_ptr<EarlierRun> earlier;
  if (!options.compare.empty()) {
    auto run = EarlierRun::open(options.compare);
    if (!run) return tl::unexpected(run.error());
    earlier = std::make_unique<EarlierRun>(std::move(*run));
  }
  auto forest = load_forest(*config);
  if (!forest) return tl::unexpected(forest.error());
  auto source = open_source(options.source);
  if (!source) return tl::unexpected(source.error());
  const SourceInfo& info = (*source)->info();

  Interrupt interrupt;
  Pipeline pipeline(std::move(*forest), config->tracker);
  pipeline.reset(info.intrinsics);
  ProgressBar bar({.title = "replay",
                   .total = static_cast<double>(std::max(0L, info.frame_count)),
                   .unit = "frames",
                   .silent = !options.json || info.frame_count <= 0});
  DepthFrame frame;
  std::uint64_t count = 0, tracked_frames = 0;
  std::chrono::nanoseconds start{0}, last{0};
  while (!interrupt.requested()) {
    const auto status = (*source)->read(frame, 1000ms);
    if (!status) return tl::unexpected(status.error());
    if (*status == ReadStatus::EndOfStream) break;
    if (*status == ReadStatus::Timeout) continue;
    if (count == 0) start = frame.sensor.time;
    last = frame.sensor.time - start;
    const TrackerOutput& output = pipeline.process(frame.view());
    tracked_frames += output.tracking;
    if (options.json || earlier) {
      const Json line = frame_json(output, count, last, options.timings);
      if (options.json) {
        if (auto written = write_json_line(stdout, line); !written) return written;
      }
      if (earlier) {
        Json comparable = line;
        comparable.erase("stage_us");
        if (auto equal = earlier->expect(comparable); !equal) return equal;
      }
    } else {
      print_line(output, count, std::chrono::duration<double>(last).count(), config->tracker.navigation.pair);
    }
    ++count;
    if (info.frame_count > 0) bar.update(static_cast<double>(count) / static_cast<double>(info.frame_count));
  }
  bar.finish();
  if (earlier) {
    if (auto end = earlier->expect_end(); !end) return end;
    std::fprintf(stderr, "the same in all %d frames as %s\n", earlier->lines(), options.compare.c_str());
  }
  if (!options.save_rest.empty()) {
    if (!pipeline.rest().rest()) return fail(options.source + ": no rest pose was found, so none can be saved");
    if (auto saved = write_rest(options.save_rest, *pipeline.rest().rest()); !saved) return saved;
  }
  if (!options.json) {
    std::fprintf(stderr, "%llu frames, %.1f %% tracked\n", static_cast<unsigned long long>(count),
                 count == 0 ? 0 : 100.0 * static_cast<double>(tracked_frames) / static_cast<double>(count));
  }
  return {};
}

}  // namespace

void add_tracker_setup(CLI::App& command, TrackerSetup& setup) {
  command.add_option("--config", setup.config_file, "the daemon's TOML file: pair, ranges, dead zones, ...")
      ->type_name("FILE");
  command.add_option("--model", setup.model, "a forest other than the installed one")->type_name("FILE");
  command
      .add_option("--rest", setup.rest,
                  "the pose against which motions are measured: auto (the first 10 tracked frames, improved while the "
                  "user stands still), first:N (the mean of the first N), stillness (as the daemon does) or a FILE")
      ->type_name("REST")
      ->capture_default_str();
}

void add_replay(CLI::App& app, Run& run) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand(
      "replay", "Run the whole tracker over a recording, as fast as it can: a line a frame, the same every time.");
  command->add_option("SOURCE", options->source, "oni:FILE, fakenect:DIR or synth:NAME")->required();
  add_tracker_setup(*command, options->setup);
  command->add_flag("--json", options->json, "one JSON object a frame: joints, motions, velocities");
  command->add_flag("--timings", options->timings, "with --json: microseconds a stage (these differ between runs)");
  command
      ->add_option("--compare", options->compare, "hold the run against an earlier one and name the first difference")
      ->type_name("FILE");
  command->add_option("--save-rest", options->save_rest, "write the rest pose, for --rest FILE")->type_name("FILE");
  command->footer(
      "Lengths are metres in the camera's frame (x right, y down, z forward), angles radians.\n\n"
      "Examples:\n"
      "  armature replay oni:visitor.oni\n"
      "  armature replay oni:visitor.oni --json > before.jsonl\n"
      "  armature replay oni:visitor.oni --compare before.jsonl");
  command->callback([options, &run] { run = [options] { return replay(*options); }; });
}

}  // namespace armature::tools
