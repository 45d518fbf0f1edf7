#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <stop_token>
#include <string>

#include <armature/navproto/messages.h>

#include "firmware_host/clock.h"
#include "firmware_host/depth_source.h"
#include "firmware_host/error.h"
#include "tracker/config.h"
#include "tracker/daemon/metrics.h"

namespace armature {

struct DaemonOptions {
  Config config;
  /// Where config came from: what `reload` reads and `save` writes. Empty: neither is possible.
  std::filesystem::path config_file;
  /// What the command line set on top of the file; set again after a reload.
  std::function<void(Config&)> override_config = [](Config&) {};
  std::shared_ptr<Clock> clock = std::make_shared<SteadyClock>();
  /// Instead of what config.source names; for simulations.
  std::unique_ptr<DepthSource> source{};
  /// Hears every navigation message that was handed to the socket, on the daemon's thread; for simulations.
  std::function<void(const navproto::NavigationMessage&)> published{};
};

/// One sensor in, one navigation stream out: reads frames on a thread of its own (newest wins, except where the source
/// is read losslessly), tracks, publishes, and answers the control channel between frames.
///
/// Whenever steering ends (nobody there, tracking lost, source silent, end of stream, reload, exit) a velocity of zero
/// is published at once, with its reason.
class Daemon {
 public:
  /// Opens model, source and endpoint; one line where one of them cannot be had. Has malloc() keep one arena for the
  /// whole process.
  [[nodiscard]] static Expected<std::unique_ptr<Daemon>> create(DaemonOptions options);
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Runs until the stream ends or `stop` is asked for, which both are success. Blocks. Call once.
  [[nodiscard]] Expected<void> run(const std::stop_token& stop);

  /// Counters, for whoever asks. Any thread.
  [[nodiscard]] const Metrics& metrics() const noexcept;

  /// Reads the configuration again before the next frame. Any thread; safe in a signal handler.
  void request_reload() noexcept { reload_requested_.store(true, std::memory_order_relaxed); }

 private:
  struct State;
  explicit Daemon(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
  std::atomic<bool> reload_requested_{false};
};

}  // namespace armature
