#include "tracker/daemon/daemon.h"

#include <fstream>
#include <utility>

#include <fmt/format.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "tracker/daemon/daemon_state.h"
#include "tracker/daemon/security.h"
#include "tracker/daemon/startup.h"
#include "tracker/daemon/wire.h"
#include "tracker/segmentation/stored_background.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// A live source that has been silent for so long is said to be lost: with a cycle of the loop on top, sooner than
/// subscribers stop by themselves. A slow sensor gets two and a half of its frames, if they come so soon.
constexpr std::chrono::nanoseconds kSilence = 150ms;
constexpr std::chrono::nanoseconds kLongestSilence = 200ms;
/// A sensor that shows nothing for so long is blind.
constexpr std::chrono::nanoseconds kBlindAfter = 5s;
constexpr auto kBlind = "sees nothing: is the lens covered, the projector off, the sun on it, or all too near?";
constexpr std::chrono::nanoseconds kHealthInterval = 1s;
constexpr auto kCycle = 40ms;
constexpr auto kVersion = ARMATURE_VERSION;

std::uint64_t resident_bytes() {
  std::uint64_t pages_in_all = 0, resident_pages = 0;
  std::ifstream("/proc/self/statm") >> pages_in_all >> resident_pages;
  return resident_pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

/// Frames come, as long as the last one is no older: two and a half of them.
std::chrono::nanoseconds few_frames(const SourceInfo& info, const SourceHealth& now) {
  const double fps = now.frames_per_second > 0 ? now.frames_per_second : info.frames_per_second;
  return std::chrono::nanoseconds(static_cast<std::int64_t>(2.5e9 / std::max(1.0, fps)));
}

template <class T>
Expected<T> as_ours(navproto::Expected<T>&& result) {
  if (!result) return fail(result.error().message);
  return *std::move(result);
}

}  // namespace

Expected<std::unique_ptr<Daemon>> Daemon::create(DaemonOptions options) {
  // One arena for all threads: with one a thread each keeps what any of them once needed, and over days of peers that
  // come and go memory creeps up. All wait for its lock then, but shortly: a frame takes memory only where it is
  // published, a few times, for what ZeroMQ sends.
  ::mallopt(M_ARENA_MAX, 1);
  const Config& config = options.config;
  auto source = options.source ? Expected<std::unique_ptr<DepthSource>>(std::move(options.source))
                               : source_of(config, options.clock);
  if (!source) return tl::unexpected(source.error());
  const auto door = door_of(config);
  if (!door) return tl::unexpected(door.error());
  const auto control_at = control_endpoint(config);
  if (!control_at) return tl::unexpected(control_at.error());
  auto uids = control_uids(config);
  if (!uids) return tl::unexpected(uids.error());
  auto model = model_of(config);
  if (!model) return tl::unexpected(model.error());
  const auto clock = options.clock;
  auto publisher =
      as_ours(wire::Publisher::bind(config.endpoint, {.now = [clock] { return clock->now(); }, .curve = *door}));
  if (!publisher) return tl::unexpected(publisher.error());
  auto control = as_ours(wire::ControlServer::bind(*control_at, {.allowed_uids = std::move(*uids)}));
  if (!control) return tl::unexpected(control.error());
  auto feed = FeedThread::start(config.endpoint, *door);
  if (!feed) return tl::unexpected(feed.error());
  if (config.endpoint.starts_with("tcp:") && !*door) {
    // An error for the log: whatever else it leaves out, this is said at every start.
    spdlog::error("{} is insecure, as configured: everybody on the network may listen", config.endpoint);
  }
  const int port = config.metrics_port;
  auto state = std::make_unique<State>(std::move(options), std::move(*model), std::move(*source), std::move(*publisher),
                                       std::move(*control), std::move(*feed));
  if (port != 0) {
    auto server = MetricsServer::start(port, [s = state.get()] { return prometheus_text(s->metrics, kVersion); });
    if (!server) return tl::unexpected(server.error());
    state->metrics_server = std::move(*server);
  }
  return std::unique_ptr<Daemon>(new Daemon(std::move(state)));
}

Daemon::Daemon(std::unique_ptr<State> state) : state_(std::move(state)) {}
Daemon::~Daemon() = default;

const Metrics& Daemon::metrics() const noexcept {
  return state_->metrics;
}

Expected<void> Daemon::run(const std::stop_token& stop) {
  State& s = *state_;
  s.say(wire::EventKind::Started, fmt::format("armatured {} reads {}", kVersion, s.config.source));
  s.last_frame = s.last_sight = s.options.clock->now();
  s.stop_camera(wire::StopReason::NoUser);  // the first thing anybody hears
  s.service.ready();
  s.show_state();
  while (!stop.stop_requested()) {
    if (reload_requested_.exchange(false, std::memory_order_relaxed)) (void)s.reload();
    s.cycle();
    if (s.capture.finished()) break;
  }
  s.service.stopping();
  s.capture.show(StatusLight::Off);

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

/// Says once that they do not go together.
void Daemon::State::compare_background(const Intrinsics& image) {
  const auto& empty = config.tracker.segmentation.background;
  if (empty == nullptr || said_background_misfits || empty->fits(image)) return;
  said_background_misfits = true;
  say(wire::EventKind::Warning,
      fmt::format("{} is {} x {}, the sensor's image {} x {}: the background is learned from what is seen; make it "
                  "anew with `armature doctor --site URI --background FILE`",
                  config.background, empty->width, empty->height, image.width, image.height));
}

void Daemon::State::watch_sight() {
  if (guard.sees() || (silent && !blind)) last_sight = last_frame;
  const bool sees_nothing = last_frame - last_sight > kBlindAfter;
  metrics.source_blind.store(sees_nothing, std::memory_order_relaxed);
  if (sees_nothing == std::exchange(blind, sees_nothing)) return;
  say(wire::EventKind::Warning, fmt::format("{} {}", config.source, blind ? kBlind : "sees again"));
}

bool Daemon::State::track(const DepthFrame& frame) {
  const auto received = frame.host.time;
  const char* complaint = capture.info().live ? guard.complaint(frame.view()) : nullptr;
  capture.judge(complaint == nullptr);
  if (complaint != nullptr) {
    metrics.bad_frames.fetch_add(1, std::memory_order_relaxed);
    stop_camera(wire::StopReason::SourceFailed);
    last_refused = options.clock->now();
    if (refused_for == nullptr) {
      refused_for = complaint;
      if (!silent)
        say(wire::EventKind::Warning, fmt::format("{}: {}; the camera is stopped", config.source, complaint));
    }
    return false;
  }
  refused_for = nullptr;
  compare_background(frame.intrinsics);
  const TrackerOutput& output = pipeline->process(frame.view());
  fill_message(navigation, output, pipeline->navigation_options().pair);
  if (rest_requested && output.state == EngagementState::Calibrating) {
    navigation.stop_reason = wire::StopReason::RestRequested;
  }
  const bool sent = publisher.publish_navigation(navigation);
  if (sent && options.published) options.published(navigation);
  if (!sent) {
    stop_camera(wire::StopReason::SourceFailed);
    say(wire::EventKind::Warning,
        fmt::format("frame {}: its message contradicts itself and was not published; the camera is stopped",
                    output.sequence));
  }
  last_frame = options.clock->now();
  latency.add(last_frame - received);
  ++processed;
  metrics.frames.fetch_add(1, std::memory_order_relaxed);
  metrics.latency.add(last_frame - received);
  for (std::size_t stage = 0; stage < kStageCount; ++stage) metrics.stage[stage].add(output.stage_time[stage]);
  watch_sight();
  if (silent) {
    silent = false;
    trouble.clear();
    show_state();
    say(wire::EventKind::SourceRecovered, "good frames come again");
  }
  note_state(output.state);

  fill_message(skeleton, output);
  publisher.publish_skeleton(skeleton);
  feed->offer(frame.view(), output.user_of_pixel);
  for (const TrackerEvent& event : output.events) tell(event, output.navigation);
  metrics.source_alive.store(true, std::memory_order_relaxed);
  return true;
}

void Daemon::State::tell(const TrackerEvent& event, const Navigation& steering) {
  if (event.kind == TrackerEventKind::RestCaptured || event.kind == TrackerEventKind::UserLeft) rest_requested = false;
  if (event.kind == TrackerEventKind::Engaged) metrics.engaged.fetch_add(1, std::memory_order_relaxed);
  if (event.kind == TrackerEventKind::Released) metrics.released.fetch_add(1, std::memory_order_relaxed);
  say(event_message(event, steering));
}

void Daemon::State::note_state(EngagementState state) {
  metrics.engagement.store(static_cast<int>(state), std::memory_order_relaxed);
  navigation.engagement = wire_engagement(state);
  if (state != std::exchange(last_state, state) && !silent) show_light();
}

void Daemon::State::let_go() {
  for (const TrackerEvent& event : pipeline->release()) tell(event, {});
  navigation.user_id = 0;
  note_state(EngagementState::Absent);
}

void Daemon::State::show_state() {
  service.status(silent ? "source lost: " + trouble : "running");
  show_light();
}

void Daemon::State::show_light() {
  capture.show(silent                                       ? StatusLight::Trouble
               : last_state == EngagementState::Engaged     ? StatusLight::Engaged
               : last_state == EngagementState::Calibrating ? StatusLight::Calibrating
                                                            : StatusLight::Ready);
}

void Daemon::State::cycle() {
  const DepthFrame* frame = capture.next(kCycle);
  watch_source(frame != nullptr && track(*frame));
  serve_between_frames();
  service.cycle_done(options.clock->now());
}

void Daemon::State::watch_source(bool good_frame) {
  const SourceHealth source = capture.health();
  metrics.restarts.store(source.restarts, std::memory_order_relaxed);
  metrics.dropped.store(capture.dropped(), std::memory_order_relaxed);
  if (source.bad_frames != torn_on_the_way) {
    metrics.bad_frames.fetch_add(source.bad_frames - torn_on_the_way, std::memory_order_relaxed);
    torn_on_the_way = source.bad_frames;
    stop_camera(wire::StopReason::SourceFailed);
  }
  if (good_frame) return;
  const auto now = options.clock->now();
  const auto few = few_frames(capture.info(), source);
  if (now - last_refused > few) refused_for = nullptr;
  const std::string known = !source.trouble.empty() ? source.trouble
                            : refused_for != nullptr
                                ? fmt::format("{} sends no good frames: {}", config.source, refused_for)
                                : "";
  const auto nothing_for = [this](std::chrono::nanoseconds span) {
    return fmt::format("{} has sent no frame for {} ms", config.source, span / 1ms);
  };
  const auto unheard_of = now - last_frame;
  if (silent) {
    if (last_state != EngagementState::Absent && unheard_of > config.tracker.engagement.lost_timeout) {
      let_go();
      stop_camera(wire::StopReason::SourceFailed);
    }
    // Why, as far as is known by now: at first it is only that nothing comes, or frames that are no good, until they
    // stop as well.
    const bool nothing_comes = known.empty() && blames_frames && now - last_refused > kLongestSilence;
    if (!nothing_comes && (known.empty() || known == trouble)) return;
    trouble = nothing_comes ? nothing_for(now - last_refused) : known;
    blames_frames = source.trouble.empty() && refused_for != nullptr;
    show_state();
    say(wire::EventKind::Warning, trouble);
    return;
  }
  if (source.trouble.empty() && unheard_of < std::clamp(few, kSilence, kLongestSilence)) return;
  silent = true;
  trouble = known.empty() ? nothing_for(now - std::max(last_frame, last_refused)) : known;
  blames_frames = source.trouble.empty() && refused_for != nullptr;
  guard.start_over();
  metrics.source_alive.store(false, std::memory_order_relaxed);
  metrics.source_blind.store(false, std::memory_order_relaxed);
  metrics.stops.fetch_add(1, std::memory_order_relaxed);
  if (last_state == EngagementState::Engaged) note_state(EngagementState::Lost);
  stop_camera(wire::StopReason::SourceFailed);
  show_state();
  say(wire::EventKind::SourceLost, trouble);
}

void Daemon::State::serve_between_frames() {
  publisher.serve();
  control.serve([this](const wire::ControlRequest& request) { return answer(request); }, 0ms);
  if (options.clock->now() - last_health >= kHealthInterval) publish_health();
}

void Daemon::State::stop_camera(wire::StopReason reason) {
  const bool ends = reason == wire::StopReason::Exit || reason == wire::StopReason::EndOfStream;
  pipeline->halt();
  fill_stop(navigation, silent && !ends ? wire::StopReason::SourceFailed : reason);
  if (publisher.publish_navigation(navigation) && options.published) options.published(navigation);
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
  message.source_trouble = silent ? trouble : blind ? kBlind : "";
  message.frames_processed = processed;
  message.frames_dropped = capture.dropped();
  message.frames_received = processed + capture.dropped() + metrics.bad_frames.load(std::memory_order_relaxed);
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
  metrics.strangers.store(publisher.counters().strangers + feed->strangers(), std::memory_order_relaxed);
  metrics.control_refused.store(control.refused(), std::memory_order_relaxed);
  processed_at_last_health = processed;
  auto message = health();
  metrics.resident_bytes.store(message.resident_bytes, std::memory_order_relaxed);
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
  std::uint64_t held_back = 0;
  if (log_limit.admit(static_cast<std::size_t>(message.kind), message.time, held_back)) {
    const auto level = message.kind == wire::EventKind::SourceLost || message.kind == wire::EventKind::ConfigRejected ||
                               message.kind == wire::EventKind::Warning
                           ? spdlog::level::warn
                           : spdlog::level::info;
    spdlog::log(level, "{}: {}{}", name(message.kind), message.text,
                held_back > 0 ? fmt::format(" ({} of these were not logged)", held_back) : "");
  }
  publisher.publish_event(message);
}

}  // namespace armature
