#include "tools/commands/recording_result.h"

#include <algorithm>
#include <cstdio>

#include "tools/interrupt.h"
#include "tools/json_lines.h"
#include "tools/progress.h"

namespace armature::tools {

std::string check_recording_name(const std::string& name) {
  return std::filesystem::path(name).extension() == ".oni" ? "" : "'" + name + "': expected a name that ends in .oni";
}

Expected<void> record_with_progress(DepthSource& source, const std::filesystem::path& out,
                                    WriteRecordingOptions options, const RecordingReport& report) {
  const SourceInfo& info = source.info();
  // What is known of the length; a live source without a limit has none, and no bar.
  double expected = info.frame_count > 0 ? static_cast<double>(info.frame_count) : 0;
  const auto limit = [&expected](double frames) { expected = expected > 0 ? std::min(expected, frames) : frames; };
  if (options.max_frames) limit(static_cast<double>(*options.max_frames));
  if (options.max_duration)
    limit(std::max(1.0, std::chrono::duration<double>(*options.max_duration).count() * info.frames_per_second));

  const Interrupt interrupt;
  options.stop = interrupt.token();
  ProgressBar bar({.title = report.title, .total = expected, .unit = "frames", .silent = expected == 0});
  if (expected > 0)
    options.progress = [&](std::uint64_t frames) { bar.update(static_cast<double>(frames) / expected); };
  options.remark = [&](std::string_view line) {
    std::fprintf(stderr, "armature: %s: %.*s\n", out.c_str(), static_cast<int>(line.size()), line.data());
  };
  const auto frames = write_recording(out, source, options);
  if (!frames) return tl::unexpected(frames.error());
  bar.finish();

  const Intrinsics& k = info.intrinsics;
  if (report.json)
    return write_json_line(stdout, {{"recording", out.string()},
                                    {"frames", *frames},
                                    {"width", k.width},
                                    {"height", k.height},
                                    {"frames_per_second", number(info.frames_per_second)}});
  std::printf("%s: %llu frames of %d x %d\n", out.c_str(), static_cast<unsigned long long>(*frames), k.width, k.height);
  return {};
}

}  // namespace armature::tools
