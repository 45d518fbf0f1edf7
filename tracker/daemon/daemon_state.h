#pragma once

#include <armature/navproto/control.h>
#include <armature/navproto/publisher.h>

#include "tracker/daemon/capture.h"
#include "tracker/daemon/daemon.h"
#include "tracker/daemon/feed_thread.h"
#include "tracker/daemon/frame_guard.h"
#include "tracker/daemon/latency.h"
#include "tracker/daemon/log_limit.h"
#include "tracker/daemon/metrics.h"
#include "tracker/daemon/service.h"

// Private to daemon.cpp (the loop) and daemon_control.cpp (settings).

namespace armature {

namespace wire = navproto;

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
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void cycle();
  /// Whether it was one to steer by.
  bool track(const DepthFrame& frame);
  void compare_background(const Intrinsics& image);
  /// Says when frames come that show nothing, and when they show something again.
  void watch_sight();
  void watch_source(bool good_frame);
  void note_state(EngagementState state);
  void tell(const TrackerEvent& event, const Navigation& steering);
  /// Whoever is there: nobody steers until somebody has stood still.
  void let_go();
  void show_state();  // to the service manager and by the light
  void show_light();  // of the sensor
  void serve_between_frames();
  /// While the sensor is silent that stays the reason, until the end.
  void stop_camera(wire::StopReason reason);
  void publish_health();
  [[nodiscard]] wire::HealthMessage health() const;
  void say(wire::EventKind kind, const std::string& text);
  void say(wire::EventMessage message);
  Expected<void> reload();
  Expected<void> take_config_file();
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
  std::chrono::nanoseconds started{0}, last_health{0};
  std::chrono::nanoseconds last_frame{0};  // the last good one
  std::uint64_t processed = 0, processed_at_last_health = 0;
  float frames_per_second = 0;
  bool silent = false;
  std::string trouble;         // why, while it is silent
  bool blames_frames = false;  // it says what is wrong with those that come
  FrameGuard guard;
  const char* refused_for = nullptr;  // what was wrong with the first of the bad frames that come; null: none do
  std::chrono::nanoseconds last_refused{0};
  bool said_background_misfits = false;
  bool blind = false;                      // good frames come, and show nothing
  std::chrono::nanoseconds last_sight{0};  // the last frame that showed something
  std::uint64_t torn_on_the_way = 0;
  EngagementState last_state = EngagementState::Absent;
  Metrics metrics;
  LogLimit log_limit;
  Service service;
  std::unique_ptr<MetricsServer> metrics_server;  // last: it stops before what it reads goes
  bool rest_requested = false;                    // of the person who is there, who has not got it yet
};

}  // namespace armature
