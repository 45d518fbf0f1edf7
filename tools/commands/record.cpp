#include <memory>

#include "tools/commands/commands.h"
#include "tools/commands/recording_result.h"
#include "tools/tracking/feed_source.h"
#include "tracker/synth/open_source.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string source;
  std::string out;
  std::optional<std::uint64_t> frames;
  std::optional<double> seconds;
  bool json = false;
};

Expected<void> record(const Arguments& arguments) {
  const bool feed = arguments.source.starts_with(kFeedScheme);
  auto source = feed ? open_feed(arguments.source.substr(kFeedScheme.size())) : open_source(arguments.source);
  if (!source) return tl::unexpected(source.error());
  WriteRecordingOptions options;
  options.in_place = (*source)->info().live;
  options.max_frames = arguments.frames;
  if (arguments.seconds)
    options.max_duration =
        std::chrono::round<std::chrono::nanoseconds>(std::chrono::duration<double>(*arguments.seconds));
  return record_with_progress(**source, arguments.out, std::move(options), {"recording", arguments.json});
}

}  // namespace

void add_record(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("record", "Record a depth source to a file that every OpenNI2 program opens");
  command
      ->add_option("SOURCE", arguments->source,
                   "feed:ENDPOINT (what a running daemon sees), openni2:, freenect:N, v4l2:/dev/videoN, oni:FILE, "
                   "fakenect:DIR or synth:NAME")
      ->required();
  command->add_option("OUT", arguments->out, "The recording, OUT.oni; OUT.oni.toml beside it holds the intrinsics")
      ->required()
      ->check(check_recording_name);
  command->add_option("--frames", arguments->frames, "Stop after this many frames")->check(CLI::Range(1U, 287'000U));
  command->add_option("--seconds", arguments->seconds, "Stop after this much of the source's own time")
      ->check(CLI::Range(0.001, 86400.0));
  command->add_flag("--json", arguments->json, "Print the result as one line of JSON");
  command->footer(
      "Ctrl-C ends the recording and keeps what is there; of a live source, killing it leaves a file that replays, "
      "too. "
      "Beside a\nrunning daemon record its feed: it has the sensor. Depth is stored without loss, time stamps from "
      "zero on.\n\n"
      "Example:\n"
      "  armature record fakenect:dump visitor.oni --seconds 20\n"
      "  armature record feed:ipc:///run/armature/nav visitor.oni");
  command->callback([arguments, &run] { run = [arguments] { return record(*arguments); }; });
}

}  // namespace armature::tools
