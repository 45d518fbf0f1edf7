#include "tracker/daemon/daemon.h"

#include <fstream>
#include <thread>

#include <armature/navproto/control.h>
#include <armature/navproto/publisher.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "tracker/daemon/capture.h"
#include "tracker/daemon/feed_thread.h"
#include "tracker/daemon/latency.h"
#include "tracker/daemon/wire.h"
#include "tracker/installation.h"
#include "tracker/synth/open_source.h"

namespace armature {
namespace {

using namespace std::chrono_literals;
namespace wire = navproto;

/// A source that has been silent for so long is said to be lost: sooner than subscribers stop by themselves.
constexpr std::chrono::nanoseconds kSilence = 200ms;
constexpr std::chrono::nanoseconds kHealthInterval = 1s;
constexpr auto kVersion = ARMATURE_VERSION;

std::uint64_t resident_bytes() {
  std::uint64_t pages_in_all = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> pages_in_all >> resident_pages;
  return resident_pages * 4096;
}

Expected<std::shared_ptr<const Forest>> load_model(const Config& config) {
  auto forest = Forest::load(config.model.empty() ? installed_model() : std::filesystem::path(config.model));
  if (!forest) return tl::unexpected(forest.error());
  return std::make_shared<const Forest>(std::move(*forest));
}

Expected<void> write_file(const std::filesystem::path& path, const std::string& text) {
  auto temporary = path;
  temporary += ".new";
  std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
  out << text << std::flush;
  std::error_code error;
  if (out) std::filesystem::rename(temporary, path, error);
  if (out && !error) return {};
  std::filesystem::remove(temporary, error);
  return fail(path.string() + ": cannot be written; the old file is as it was");
}

}  // namespace

struct Daemon::State {
  State(DaemonOptions all, std::shared_ptr<const Forest> model, std::unique_ptr<DepthSource> source,
        wire::Publisher out, wire::ControlServer server, std::unique_ptr<FeedThread> feed_thread)
      : options(std::move(all)),
        config(options.config),
        forest(std::move(model)),
        pipeline(std::make_unique<Pipeline>(forest, config.tracker, options.clock)),
        publisher(std::move(out)),
        control(std::move(server)),
        feed(std::move(feed_thread)),
        capture(std::move(source), config.lossless),
        started(options.clock->now()) {
    pipeline->reset(capture.info().intrinsics);
  }

  void track(const DepthFrame& frame);
  void serve_between_frames();
  void stop_camera(wire::StopReason reason);
  void notice_silence();
  void publish_health();
  [[nodiscard]] wire::HealthMessage health() const;
  void say(wire::EventKind kind, const std::string& text);
  void say(wire::EventMessage message);
  Expected<void> reload();
  Expected<void> save() const;
  wire::ControlReply answer(const wire::ControlRequest& request);

  DaemonOptions options;
  Config config;
  std::shared_ptr<const Forest> forest;
  std::unique_ptr<Pipeline> pipeline;
  wire::Publisher publisher;
  wire::ControlServer control;
  std::unique_ptr<FeedThread> feed;
  Capture capture;

  wire::NavigationMessage navigation;
  wire::SkeletonMessage skeleton;
  Latency latency;
  std::chrono::nanoseconds started{0}, last_frame{0}, last_health{0};
  std::uint64_t processed = 0, processed_at_last_health = 0;
  float frames_per_second = 0;
  bool silent = false;
  bool rest_requested = false;
};

Expected<std::unique_ptr<Daemon>> Daemon::create(DaemonOptions options) {
  const Config& config = options.config;
  if (config.source.empty()) return fail("no source: name one with --source URI or source.uri in the configuration");
  auto model = load_model(config);
  if (!model) return tl::unexpected(model.error());
  auto source = open_source(config.source,
                            {.pacing = config.lossless ? Pacing::Lossless : Pacing::RealTime, .clock = options.clock});
  if (!source) return tl::unexpected(source.error());
  const auto clock = options.clock;
  auto publisher = wire::Publisher::bind(config.endpoint, {.now = [clock] { return clock->now(); }});
  if (!publisher) return fail(publisher.error().message);
  auto control = wire::ControlServer::bind(config.endpoint);
  if (!control) return fail(control.error().message);
  auto feed = FeedThread::start(config.endpoint);
  if (!feed) return tl::unexpected(feed.error());
  return std::unique_ptr<Daemon>(
      new Daemon(std::make_unique<State>(std::move(options), std::move(*model), std::move(*source),
                                         std::move(*publisher), std::move(*control), std::move(*feed))));
}

Daemon::Daemon(std::unique_ptr<State> state) : state_(std::move(state)) {}
Daemon::~Daemon() = default;

Expected<void> Daemon::run(const std::stop_token& stop) {
  State& s = *state_;
  s.say(wire::EventKind::Started, fmt::format("armatured {} reads {}", kVersion, s.config.source));
  s.last_frame = s.options.clock->now();
  while (!stop.stop_requested()) {
    if (reload_requested_.exchange(false, std::memory_order_relaxed)) (void)s.reload();
    if (const DepthFrame* frame = s.capture.next(50ms)) {
      s.track(*frame);
    } else if (s.capture.finished()) {
      break;
    } else {
      s.notice_silence();
    }
    s.serve_between_frames();
  }

  if (stop.stop_requested()) {
    s.stop_camera(wire::StopReason::Exit);
    s.say(wire::EventKind::Stopping, "asked to stop");
    return {};
  }
  if (s.capture.failure()) {
    s.stop_camera(wire::StopReason::SourceFailed);
    s.say(wire::EventKind::SourceLost, s.capture.failure()->message);
    return tl::unexpected(*s.capture.failure());
  }
  s.stop_camera(wire::StopReason::EndOfStream);
  s.say(wire::EventKind::Stopping, fmt::format("end of {} after {} frames", s.config.source, s.processed));
  return {};
}

void Daemon::State::track(const DepthFrame& frame) {
  const auto received = frame.host.time;
  const TrackerOutput& output = pipeline->process(frame.view());
  fill_message(navigation, output, pipeline->navigation_options().pair);
  if (rest_requested && output.state == EngagementState::Calibrating) {
    navigation.stop_reason = wire::StopReason::RestRequested;
  }
  if (!publisher.publish_navigation(navigation)) {
    spdlog::error("frame {}: its message contradicts itself and was not published; the camera is stopped",
                  output.sequence);
    stop_camera(wire::StopReason::SourceFailed);
  }
  last_frame = options.clock->now();
  latency.add(last_frame - received);
  ++processed;

  fill_message(skeleton, output);
  publisher.publish_skeleton(skeleton);
  feed->offer(frame.view(), output.user_of_pixel);
  for (const TrackerEvent& event : output.events) {
    if (event.kind == TrackerEventKind::RestCaptured) rest_requested = false;
    say(event_message(event, output.navigation));
  }
  if (silent) {
    silent = false;
    say(wire::EventKind::SourceRecovered, "frames come again");
  }
}

void Daemon::State::serve_between_frames() {
  publisher.serve();
  control.serve([this](const wire::ControlRequest& request) { return answer(request); }, 0ms);
  if (options.clock->now() - last_health >= kHealthInterval) publish_health();
}

void Daemon::State::stop_camera(wire::StopReason reason) {
  fill_stop(navigation, reason);
  publisher.publish_navigation(navigation);
}

void Daemon::State::notice_silence() {
  if (silent || options.clock->now() - last_frame < kSilence) return;
  silent = true;
  stop_camera(wire::StopReason::SourceFailed);
  say(wire::EventKind::SourceLost, fmt::format("{} has sent no frame for {} ms", config.source, kSilence / 1ms));
}

wire::HealthMessage Daemon::State::health() const {
  const auto now = options.clock->now();
  const auto us = [](std::chrono::nanoseconds t) { return std::chrono::duration<float, std::micro>(t).count(); };
  wire::HealthMessage message;
  message.time = now;
  message.uptime_s = std::chrono::duration<double>(now - started).count();
  message.version = kVersion;
  message.source = config.source;
  message.source_alive = !silent;
  message.frames_processed = processed;
  message.frames_dropped = capture.dropped();
  message.frames_received = processed + capture.dropped();
  message.frames_per_second = frames_per_second;
  message.latency_p50_us = us(latency.percentile(0.50));
  message.latency_p99_us = us(latency.percentile(0.99));
  message.resident_bytes = resident_bytes();
  return message;
}

void Daemon::State::publish_health() {
  const auto now = options.clock->now();
  if (last_health.count() != 0) {
    frames_per_second = static_cast<float>(processed - processed_at_last_health) /
                        std::chrono::duration<float>(now - last_health).count();
  }
  last_health = now;
  processed_at_last_health = processed;
  auto message = health();
  publisher.publish_health(message);
}

void Daemon::State::say(wire::EventKind kind, const std::string& text) {
  wire::EventMessage message;
  message.kind = kind;
  message.text = text;
  say(std::move(message));
}

void Daemon::State::say(wire::EventMessage message) {
  message.time = options.clock->now();
  spdlog::info("{}: {}", name(message.kind), message.text);
  publisher.publish_event(message);
}

Expected<void> Daemon::State::reload() {
  if (options.config_file.empty()) return fail("started without --config: there is nothing to reload");
  auto read = load_config(options.config_file);
  if (!read) {
    say(wire::EventKind::ConfigRejected, read.error().message + "; the configuration stays as it is");
    return tl::unexpected(read.error());
  }
  options.override_config(*read);
  stop_camera(wire::StopReason::Reload);
  if (read->model != config.model) {
    auto model = load_model(*read);
    if (!model) {
      say(wire::EventKind::ConfigRejected, model.error().message + "; the configuration stays as it is");
      return tl::unexpected(model.error());
    }
    forest = std::move(*model);
  }
  std::string note = options.config_file.string() + " is in force; whoever steers stands still for a new rest pose";
  if (read->source != config.source || read->endpoint != config.endpoint || read->lossless != config.lossless) {
    note += "; source, lossless and endpoint change only with a restart";
    read->source = config.source;
    read->endpoint = config.endpoint;
    read->lossless = config.lossless;
  }
  config = std::move(*read);
  pipeline = std::make_unique<Pipeline>(forest, config.tracker, options.clock);
  pipeline->reset(capture.info().intrinsics);
  say(wire::EventKind::ConfigReloaded, note);
  return {};
}

Expected<void> Daemon::State::save() const {
  if (options.config_file.empty()) return fail("started without --config: there is no file to save to");
  return write_file(options.config_file, print_config(config));
}

wire::ControlReply Daemon::State::answer(const wire::ControlRequest& request) {
  Expected<void> done;
  switch (request.kind) {
    case wire::RequestKind::Status: break;
    case wire::RequestKind::Rerest:
      pipeline->capture_rest();
      rest_requested = true;
      stop_camera(wire::StopReason::RestRequested);
      break;
    case wire::RequestKind::Set: {
      auto now = changed(pipeline->navigation_options(), request.settings);
      if (!now) {
        done = tl::unexpected(now.error());
      } else {
        pipeline->set_navigation(*now);
        config.tracker.navigation = *now;
      }
      break;
    }
    case wire::RequestKind::Save:
      done = save();
      if (done) say(wire::EventKind::ConfigSaved, options.config_file.string());
      break;
    case wire::RequestKind::Reload: done = reload(); break;
  }
  wire::ControlReply reply;
  if (!done) reply.error = done.error().message;
  reply.engagement = navigation.engagement;
  reply.user_id = navigation.user_id;
  reply.settings = settings_of(pipeline->navigation_options());
  reply.health = health();
  return reply;
}

}  // namespace armature
