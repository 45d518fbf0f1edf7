#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "firmware_host/depth_source.h"

namespace armature::tools {

/// What can befall a sensor.
enum class SensorFault : std::uint8_t { Unplug, Stall, Freeze, Torn, Garbage, TimeJump, Crash };
inline constexpr std::array<std::string_view, 7> kSensorFaultNames = {"unplug",  "stall",     "freeze", "torn",
                                                                      "garbage", "time_jump", "crash"};

/// A sensor at a site, on an injected clock: an empty place, and now and then somebody who walks in, steers and leaves.
/// Every frame takes a 15th of a second of the clock's time and none of ours. Faults are as a capture process shows
/// them. Thread-safe: no, but for health().
class SimulatedSite final : public DepthSource {
 public:
  /// Renders the frames that are shown over and over. `visits` is the share of time in which somebody is there.
  [[nodiscard]] static Expected<std::unique_ptr<SimulatedSite>> build(std::shared_ptr<ManualClock> clock, int width,
                                                                      int height, double visits);

  /// Befalls the sensor now, for `how_long` where it lasts.
  void befall(SensorFault fault, std::chrono::nanoseconds how_long);
  /// Whether a fault lasts.
  [[nodiscard]] bool troubled() const noexcept { return clock_->now() < std::max(silent_until_, frozen_until_); }
  [[nodiscard]] bool visited() const noexcept { return visited_; }
  [[nodiscard]] std::uint64_t visit_frames() const noexcept { return visit_frames_; }

  /// Called before each read, on the daemon's thread: the place from where a simulation does its mischief. False ends
  /// the stream.
  std::function<bool()> before_read;

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override;
  [[nodiscard]] SourceHealth health() const override { return health_; }

 private:
  explicit SimulatedSite(std::shared_ptr<ManualClock> clock) : clock_(std::move(clock)) {}

  std::shared_ptr<ManualClock> clock_;
  SourceInfo info_;
  SourceHealth health_;
  std::vector<std::vector<std::uint16_t>> empty_, visit_;
  std::mt19937_64 noise_{7};
  double visits_ = 0.1;
  bool visited_ = false;
  std::size_t shown_ = 0;  // of the loop that is shown
  std::size_t empty_left_ = 0;
  std::uint64_t sequence_ = 0, visit_frames_ = 0;
  std::chrono::nanoseconds sensor_offset_{0}, silent_until_{0}, frozen_until_{0};
  const std::vector<std::uint16_t>* last_ = nullptr;  // the image that was shown
  bool torn_ = false, garbage_ = false;
};

}  // namespace armature::tools
