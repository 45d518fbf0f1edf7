#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include <armature/navproto/subscriber.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "tools/commands/bench/bench.h"
#include "tools/commands/bench/mischief.h"
#include "tools/commands/bench/simulated_site.h"
#include "tools/elapsed.h"
#include "tools/interrupt.h"
#include "tools/json_lines.h"
#include "tools/progress.h"
#include "tracker/daemon/daemon.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

constexpr nanoseconds kZeroWithin = 250ms;
constexpr nanoseconds kRecoveredWithin = 5s;
constexpr double kMostGrowth_mb = 8;
/// Under the thread sanitizer memory is mostly its own, of what was ever touched.
#if defined(__SANITIZE_THREAD__)
constexpr bool kShadowed = true;
#else
constexpr bool kShadowed = false;
#endif
constexpr double kLeastFactor = 100;

struct SoakOptions {
  double hours = 72;
  long faults = -1;
  double visits = 0.05;
  unsigned seed = 1;
  bool json = false;
};

double resident_mb() {
  long all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

class Soak {
 public:
  explicit Soak(const SoakOptions& options) : options_(options), random_(options.seed) {
    folder_ = std::filesystem::temp_directory_path() / fmt::format("armature-soak-{}", getpid());
    std::filesystem::create_directories(folder_);
    if (options_.faults < 0) options_.faults = std::max(1L, std::lround(options_.hours * 10'000 / 72));
  }
  ~Soak() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  Soak(const Soak&) = delete;
  Soak& operator=(const Soak&) = delete;

  Expected<void> run() {
    spdlog::set_level(spdlog::level::off);
    auto site = SimulatedSite::build(clock_, 160, 120, options_.visits);
    if (!site) return tl::unexpected(site.error());
    site_ = site->get();
    end_ = std::chrono::round<nanoseconds>(std::chrono::duration<double, std::ratio<3600>>(options_.hours));
    const auto spacing = end_ / (options_.faults + 1);
    next_fault_ = spacing;
    spacing_ = spacing;

    DaemonOptions daemon_options;
    mischiefs_ = std::make_unique<Mischiefs>(folder_, options_.seed);
    const std::string endpoint = mischiefs_->endpoint();
    daemon_options.config.endpoint = endpoint;
    daemon_options.config.lossless = true;  // on the clock's time, not on a thread's
    daemon_options.config.source = "simulated";
    daemon_options.config_file = mischiefs_->config_file();
    daemon_options.override_config = [endpoint](Config& c) {
      c.endpoint = endpoint;
      c.lossless = true;
      c.source = "simulated";
    };
    daemon_options.clock = clock_;
    daemon_options.source = std::move(*site);
    daemon_options.published = [this](const navproto::NavigationMessage& message) { heard(message); };
    auto daemon = Daemon::create(std::move(daemon_options));
    if (!daemon) return tl::unexpected(daemon.error());
    daemon_ = daemon->get();
    site_->before_read = [this] { return live(); };
    subscriber_ = std::make_unique<navproto::NavSubscriber>(endpoint);

    const auto began = SteadyClock().now();
    if (auto ended = (*daemon)->run({}); !ended) return ended;
    seconds_ = std::chrono::duration<double>(SteadyClock().now() - began).count();
    bar_.finish();
    return report();
  }

 private:
  /// On the daemon's thread, before each read.
  bool live() {
    const auto now = clock_->now();
    if (interrupt_.requested() || now >= end_) return false;
    if (++reads_ % 20'000 == 0) bar_.update(static_cast<double>(now.count()) / static_cast<double>(end_.count()));
    if (waiting_zero_ && now - fault_at_ > kZeroWithin) {
      ++late_zeros_;
      waiting_zero_ = false;
    }
    if (waiting_recovery_ && !site_->troubled()) {
      if (recovery_from_.count() < 0) recovery_from_ = now;
      if (now - recovery_from_ > kRecoveredWithin) {
        ++late_recoveries_;
        waiting_recovery_ = false;
      }
    }
    // Whatever befell the daemon from elsewhere: the frame that was read last has been published.
    if (other_pending_ && !site_->troubled()) {
      if (published_ == published_at_other_ && ++quiet_reads_ > 2) {
        ++felt_;
        other_pending_ = false;
      }
      if (published_ > published_at_other_) other_pending_ = false;
    }
    if (now >= next_fault_ && !waiting_zero_ && !waiting_recovery_ && !site_->troubled()) befall(now);
    return true;
  }

  void befall(nanoseconds now) {
    next_fault_ += spacing_;
    ++injected_;
    mischiefs_->over();
    (void)subscriber_->take_events();  // as whoever listens does: a thousand texts would lie all over the heap
    if (first_mb_ == 0 && now > end_ / 10) first_mb_ = resident_mb();
    if (random_() % 4 == 0) return befall_daemon();
    const auto fault = static_cast<SensorFault>(random_() % kSensorFaultNames.size());
    ++sensor_faults_[static_cast<std::size_t>(fault)];
    fault_at_ = now;
    waiting_zero_ = waiting_recovery_ = true;
    recovery_from_ = nanoseconds(-1);
    site_->befall(fault, std::chrono::milliseconds(300 + random_() % 8000));
  }

  void befall_daemon() {
    published_at_other_ = published_;
    quiet_reads_ = 0;
    other_pending_ = true;
    const Mischief which = mischiefs_->commit([this] { daemon_->request_reload(); });
    ++other_faults_[static_cast<std::size_t>(which)];
  }

  /// Every message that was handed to the socket.
  void heard(const navproto::NavigationMessage& message) {
    ++published_;
    const bool zero = message.velocity == navproto::Velocity{};
    moving_ += zero ? 0 : 1;
    engaged_ += message.engagement == navproto::Engagement::Engaged ? 1 : 0;
    const auto now = clock_->now();
    if (waiting_zero_ && zero && message.stop_reason == navproto::StopReason::SourceFailed) {
      waiting_zero_ = false;
      longest_zero_ = std::max(longest_zero_, now - fault_at_);
    } else if (waiting_recovery_ && !waiting_zero_ && message.stop_reason != navproto::StopReason::SourceFailed &&
               !site_->troubled()) {
      waiting_recovery_ = false;
      if (recovery_from_.count() >= 0) longest_recovery_ = std::max(longest_recovery_, now - recovery_from_);
    }
  }

  Expected<void> report() {
    const double factor = std::chrono::duration<double>(clock_->now()).count() / seconds_;
    mischiefs_->over();  // whose memory is this process's too: as little of it as when the first number was taken
    const double last_mb = resident_mb();
    const auto ms = [](nanoseconds t) { return std::chrono::duration<double, std::milli>(t).count(); };
    const std::uint64_t frames = daemon_->metrics().frames.load();
    const double full = frames == 0 ? 0 : static_cast<double>(site_->visit_frames()) / static_cast<double>(frames);
    std::vector<std::string> complaints;
    const auto hold = [&](bool good, const std::string& what) {
      if (!good) complaints.push_back(what);
    };
    hold(late_zeros_ == 0, fmt::format("{} zeros came later than {} ms", late_zeros_, kZeroWithin / 1ms));
    hold(late_recoveries_ == 0,
         fmt::format("{} recoveries took longer than {} s", late_recoveries_, kRecoveredWithin / 1s));
    const std::uint64_t full_disks = other_faults_[static_cast<std::size_t>(Mischief::FullDisk)];
    hold(full_disks < 20 || 2 * mischiefs_->recordings_ended() >= full_disks,
         fmt::format("{} of {} recordings ended by themselves on a full disk, expected at least half",
                     mischiefs_->recordings_ended(), full_disks));
    hold(felt_ == 0, fmt::format("{} faults from elsewhere were felt", felt_));
    hold(kShadowed || last_mb - first_mb_ < kMostGrowth_mb,
         fmt::format("memory grew from {:.1f} to {:.1f} MB", first_mb_, last_mb));
    // In a short run the rendering of frames and other programs count too much.
    hold(options_.hours < 1 || factor >= kLeastFactor,
         fmt::format("{:.0f} times real time, expected at least {:.0f}", factor, kLeastFactor));
    hold(moving_ > 0, "nobody ever steered");

    Json sensor = Json::object(), other = Json::object();
    for (std::size_t i = 0; i < kSensorFaultNames.size(); ++i)
      sensor[std::string(kSensorFaultNames[i])] = sensor_faults_[i];
    for (std::size_t i = 0; i < kMischiefNames.size(); ++i) other[std::string(kMischiefNames[i])] = other_faults_[i];
    const double hours = std::chrono::duration<double>(clock_->now()).count() / 3600;
    if (options_.json) {
      auto written = write_json_line(stdout, {{"hours", number(hours)},
                                              {"seconds", number(seconds_)},
                                              {"times_real_time", number(factor)},
                                              {"frames", frames},
                                              {"share_in_full", number(full)},
                                              {"faults", injected_},
                                              {"sensor_faults", sensor},
                                              {"other_faults", other},
                                              {"longest_zero_ms", number(ms(longest_zero_))},
                                              {"late_zeros", late_zeros_},
                                              {"longest_recovery_ms", number(ms(longest_recovery_))},
                                              {"late_recoveries", late_recoveries_},
                                              {"felt", felt_},
                                              {"control_refused", daemon_->metrics().control_refused.load()},
                                              {"recordings_ended_by_full_disk", mischiefs_->recordings_ended()},
                                              {"moving_messages", moving_},
                                              {"memory_mb", {number(first_mb_), number(last_mb)}},
                                              {"good", complaints.empty()}});
      if (!written) return written;
    } else {
      std::printf("%s\n",
                  fmt::format("{:.2f} simulated hours in {:.1f} s: {:.0f} times real time; {} frames, {:.1f} % with "
                              "somebody there and in full\n"
                              "{} faults: sensor {}, others {}\n"
                              "zero after a sensor fault: at most {:.0f} ms; recovered within {:.0f} ms\n"
                              "memory {:.1f} -> {:.1f} MB",
                              hours, seconds_, factor, frames, full * 100, injected_, sensor.dump(), other.dump(),
                              ms(longest_zero_), ms(longest_recovery_), first_mb_, last_mb)
                      .c_str());
    }
    if (complaints.empty() || interrupt_.requested()) return {};
    std::string all;
    for (const std::string& complaint : complaints) all += (all.empty() ? "" : "; ") + complaint;
    return fail("soak: " + all);
  }

  SoakOptions options_;
  std::mt19937_64 random_;
  std::filesystem::path folder_;
  Interrupt interrupt_;
  ProgressBar bar_{{.title = "soaking", .total = 1, .unit = "share"}};
  std::shared_ptr<ManualClock> clock_ = std::make_shared<ManualClock>();
  SimulatedSite* site_ = nullptr;
  Daemon* daemon_ = nullptr;
  std::unique_ptr<navproto::NavSubscriber> subscriber_;
  std::unique_ptr<Mischiefs> mischiefs_;

  nanoseconds end_{0}, next_fault_{0}, spacing_{0}, fault_at_{0}, recovery_from_{-1};
  nanoseconds longest_zero_{0}, longest_recovery_{0};
  bool waiting_zero_ = false, waiting_recovery_ = false, other_pending_ = false;
  int quiet_reads_ = 0;
  std::uint64_t reads_ = 0, injected_ = 0, published_ = 0, published_at_other_ = 0, moving_ = 0, engaged_ = 0;
  std::uint64_t late_zeros_ = 0, late_recoveries_ = 0, felt_ = 0;
  std::array<std::uint64_t, kSensorFaultNames.size()> sensor_faults_{};
  std::array<std::uint64_t, kMischiefNames.size()> other_faults_{};
  double first_mb_ = 0, seconds_ = 0;
};

}  // namespace

void add_bench_soak(CLI::App& bench, Run& run) {
  auto options = std::make_shared<SoakOptions>();
  CLI::App* soak = bench.add_subcommand(
      "soak",
      "Simulated days of a daemon at a kiosk, with faults: unplugging, stalls, crashes, torn frames, hostile peers");
  soak->add_option("--hours", options->hours, "Simulated hours")
      ->check(CLI::Range(0.01, 10'000.0))
      ->capture_default_str();
  soak->add_option("--faults", options->faults, "How many, evenly spread; without it 10,000 in 72 hours")
      ->check(CLI::Range(1L, 100'000'000L));
  soak->add_option("--visits", options->visits, "Share of the time in which somebody is there, tracked in full")
      ->check(CLI::Range(0.01, 0.9))
      ->capture_default_str();
  soak->add_option("--seed", options->seed, "Of the faults")->capture_default_str();
  soak->add_flag("--json", options->json, "One JSON object");
  soak->footer(
      "The clock is injected and frames are rendered before: an hour takes seconds. The daemon is the real one, with "
      "its\n"
      "sockets; the sensor is simulated as a capture process shows it. Fails where a zero is later than 250 ms after "
      "a\n"
      "sensor fault, a recovery than 5 s, anything from elsewhere is felt, memory grows, or it is slower than 100 "
      "times\n"
      "real time.\n\nExample:\n  armature bench soak --hours 1 --json");
  soak->callback([options, &run] { run = [options] { return Soak(*options).run(); }; });
}

}  // namespace armature::tools
