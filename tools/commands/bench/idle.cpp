#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tools/commands/bench/bench.h"
#include "tools/interrupt.h"
#include "tools/json_lines.h"
#include "tracker/daemon/daemon.h"
#include "tracker/synth/synth_source.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

constexpr double kMostMemory_mb = 60;
constexpr double kMostCpu = 0.02;

struct IdleOptions {
  double seconds = 20;
  std::string size = "640x480";
  bool json = false;
};

/// An empty room, at the pace of a sensor, at no cost of its own.
class EmptyRoom final : public DepthSource {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<DepthSource>> open(const std::string& size) {
    auto synth = SynthSource::open("walk_in?seed=3&size=" + size);
    if (!synth) return tl::unexpected(synth.error());
    std::unique_ptr<EmptyRoom> room(new EmptyRoom);
    for (int i = 0; i < 4; ++i) {
      DepthFrame frame;
      if (const auto read = (*synth)->read(frame, 1s); !read) return tl::unexpected(read.error());
      room->frames_.push_back(std::move(frame));
    }
    room->info_ = (*synth)->info();
    room->info_.live = true;
    return std::unique_ptr<DepthSource>(std::move(room));
  }
  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds) override {
    if (next_.count() == 0) next_ = clock_.now();
    next_ += 33'333'333ns;
    clock_.sleep_until(next_);
    frame.depth_mm.assign(frames_[count_ % frames_.size()].depth_mm.begin(),
                          frames_[count_ % frames_.size()].depth_mm.end());
    frame.intrinsics = info_.intrinsics;
    frame.sequence = ++count_;
    frame.sensor = {next_, ClockId::Device};
    frame.host = {clock_.now(), ClockId::HostMonotonic};
    return ReadStatus::Frame;
  }

 private:
  EmptyRoom() = default;
  SourceInfo info_;
  std::vector<DepthFrame> frames_;
  SteadyClock clock_;
  std::chrono::nanoseconds next_{0};
  std::uint64_t count_ = 0;
};

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_usec) * 1e-6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Expected<void> bench_idle(const IdleOptions& options) {
  spdlog::set_level(spdlog::level::off);
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("armature-idle-{}", getpid());
  std::filesystem::create_directories(folder);
  DaemonOptions daemon_options;
  daemon_options.config.endpoint = "ipc://" + (folder / "nav").string();
  daemon_options.config.source = "an empty room";
  auto room = EmptyRoom::open(options.size);
  if (!room) return tl::unexpected(room.error());
  daemon_options.source = std::move(*room);
  auto daemon = Daemon::create(std::move(daemon_options));
  if (!daemon) return tl::unexpected(daemon.error());
  std::stop_source stop;
  double cpu = 0, seconds = 0;
  const Interrupt interrupt;
  std::jthread watch([&] {
    const SteadyClock clock;
    std::this_thread::sleep_for(3s);  // the background is learnt
    const auto began = clock.now();
    const double before = cpu_seconds();
    while (!interrupt.requested() && clock.now() - began < std::chrono::duration<double>(options.seconds))
      std::this_thread::sleep_for(50ms);
    cpu = cpu_seconds() - before;
    seconds = std::chrono::duration<double>(clock.now() - began).count();
    stop.request_stop();
  });
  auto ended = (*daemon)->run(stop.get_token());
  watch.join();
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
  if (!ended) return ended;
  long all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  const double memory_mb = static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
  const double share = cpu / seconds;
  if (options.json) {
    auto written = write_json_line(stdout, {{"size", options.size},
                                            {"seconds", number(seconds)},
                                            {"frames", (*daemon)->metrics().frames.load()},
                                            {"cpu_share", number(share)},
                                            {"resident_mb", number(memory_mb)}});
    if (!written) return written;
  } else {
    std::printf("nobody there, %s at 30 Hz: %.2f %% of a core (at most %.0f %%), %.1f MB resident (at most %.0f)\n",
                options.size.c_str(), share * 100, kMostCpu * 100, memory_mb, kMostMemory_mb);
  }
  if (share > kMostCpu || memory_mb > kMostMemory_mb)
    return fail(fmt::format("idle: {:.2f} % of a core and {:.1f} MB: expected at most {:.0f} % and {:.0f} MB",
                            share * 100, memory_mb, kMostCpu * 100, kMostMemory_mb));
  return {};
}

}  // namespace

void add_bench_idle(CLI::App& bench, Run& run) {
  auto options = std::make_shared<IdleOptions>();
  CLI::App* idle =
      bench.add_subcommand("idle", "What the daemon takes while nobody is there: memory and a share of a core");
  idle->add_option("--seconds", options->seconds, "How long to measure, after three seconds of settling")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  idle->add_option("--size", options->size, "Of the images, WIDTHxHEIGHT")->capture_default_str();
  idle->add_flag("--json", options->json, "One JSON object");
  idle->footer("Fails above 2 % of a core or 60 MB.\n\nExample:\n  armature bench idle --json");
  idle->callback([options, &run] { run = [options] { return bench_idle(*options); }; });
}

}  // namespace armature::tools
