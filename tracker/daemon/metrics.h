#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "firmware_host/error.h"
#include "tracker/pipeline.h"

namespace armature {

/// How often something took how long. Any number of threads. Realtime-safe: add() yes.
class Histogram {
 public:
  static constexpr std::array<double, 12> kBounds_ms = {0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 25, 50, 100, 250};

  void add(std::chrono::nanoseconds took) noexcept;
  /// As Prometheus has it: `NAME_bucket{LABELS,le="S"}` in seconds, `NAME_sum`, `NAME_count`.
  void print(std::string& out, std::string_view name, std::string_view labels) const;

 private:
  std::array<std::atomic<std::uint64_t>, kBounds_ms.size() + 1> counts_{};
  std::atomic<std::int64_t> sum_ns_{0};
};

/// What the daemon counts. Written by its loop, read by whoever asks.
struct Metrics {
  std::atomic<std::uint64_t> frames{0}, dropped{0}, bad_frames{0}, restarts{0}, stops{0}, engaged{0}, released{0};
  std::atomic<std::uint64_t> strangers{0}, control_refused{0}, reloads{0}, reloads_refused{0}, resident_bytes{0};
  std::atomic<bool> source_alive{false}, source_blind{false};
  std::atomic<int> engagement{0};  ///< EngagementState
  Histogram latency;               ///< frame received to message handed to the socket
  std::array<Histogram, kStageCount> stage;
};

/// Prometheus' text format, version 0.0.4.
[[nodiscard]] std::string prometheus_text(const Metrics& metrics, std::string_view version);

/// Answers `GET /metrics` on 127.0.0.1, one request after the other, on a thread of its own; whoever is slow or sends
/// anything else is hung up on.
class MetricsServer {
 public:
  /// Fails in one line where the port is taken. Port 0: any that is free.
  [[nodiscard]] static Expected<std::unique_ptr<MetricsServer>> start(int port, std::function<std::string()> text);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  [[nodiscard]] int port() const noexcept { return port_; }

 private:
  MetricsServer(int listener, int port, std::function<std::string()> text);
  void run(const std::stop_token& stop) const;

  int listener_;
  int port_;
  std::function<std::string()> text_;
  std::jthread thread_;
};

}  // namespace armature
