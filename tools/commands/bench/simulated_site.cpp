#include "tools/commands/bench/simulated_site.h"

#include <algorithm>

#include "tracker/synth/synth_source.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;
/// 15 Hz, as many depth cameras have: half as many frames to work through.
constexpr std::chrono::nanoseconds kFrame{66'666'667};

}  // namespace

Expected<std::unique_ptr<SimulatedSite>> SimulatedSite::build(std::shared_ptr<ManualClock> clock, int width, int height,
                                                              double visits) {
  auto synth = SynthSource::open("walk_in?seed=3&fps=15&size=" + std::to_string(width) + "x" + std::to_string(height));
  if (!synth) return tl::unexpected(synth.error());
  std::unique_ptr<SimulatedSite> site(new SimulatedSite(std::move(clock)));
  site->visits_ = visits;
  site->info_ = (*synth)->info();
  site->info_.uri = "simulated";
  site->info_.live = true;
  site->info_.frame_count = -1;
  DepthFrame frame;
  while ((*synth)->read(frame, 1s).value_or(ReadStatus::EndOfStream) == ReadStatus::Frame) {
    if (!(*synth)->truth().present && site->visit_.empty()) {
      site->empty_.push_back(frame.depth_mm);
    } else {
      site->visit_.push_back(frame.depth_mm);
    }
  }
  if (site->empty_.empty() || site->visit_.empty()) return fail("simulated site: the script shows nobody");
  site->empty_left_ = 300;
  return site;
}

void SimulatedSite::befall(SensorFault fault, std::chrono::nanoseconds how_long) {
  const auto now = clock_->now();
  switch (fault) {
    case SensorFault::Unplug:
      silent_until_ = now + how_long;
      health_.trouble = "simulated: no Kinect is plugged in";
      return;
    case SensorFault::Stall: silent_until_ = now + how_long; return;
    case SensorFault::Freeze: frozen_until_ = now + how_long; return;
    case SensorFault::Torn: torn_ = true; return;
    case SensorFault::Garbage: garbage_ = true; return;
    case SensorFault::TimeJump: sensor_offset_ += (noise_() % 2 == 0 ? 1 : -1) * 1h; return;
    case SensorFault::Crash:
      silent_until_ = now + how_long;
      health_.trouble = "simulated: the capture process died: Segmentation fault";
      ++health_.restarts;
      return;
  }
}

Expected<ReadStatus> SimulatedSite::read(DepthFrame& frame, std::chrono::milliseconds timeout) {
  if (before_read && !before_read()) return ReadStatus::EndOfStream;
  if (clock_->now() < silent_until_) {
    clock_->advance(std::min<std::chrono::nanoseconds>(timeout, silent_until_ - clock_->now()));
    return ReadStatus::Timeout;
  }
  health_.trouble.clear();
  clock_->advance(kFrame);
  const auto& loop = visited_ ? visit_ : empty_;
  if (clock_->now() >= frozen_until_ || last_ == nullptr) last_ = &loop[shown_ % loop.size()];
  frame.depth_mm = *last_;
  ++shown_;
  visit_frames_ += visited_ ? 1 : 0;
  if (visited_ && shown_ == visit_.size()) {
    visited_ = false;
    shown_ = 0;
    empty_left_ = static_cast<std::size_t>(static_cast<double>(visit_.size()) * (1 - visits_) / visits_);
  } else if (!visited_ && shown_ >= empty_left_) {
    visited_ = true;
    shown_ = 0;
  }
  if (torn_) {
    const auto kept = static_cast<std::ptrdiff_t>(frame.depth_mm.size() / 3);
    if (noise_() % 2 == 0) {
      std::fill(frame.depth_mm.begin() + kept, frame.depth_mm.end(), std::uint16_t{0});
    } else {
      frame.depth_mm.resize(static_cast<std::size_t>(kept));
    }
  }
  if (garbage_) {
    for (std::uint16_t& depth : frame.depth_mm) depth = static_cast<std::uint16_t>(noise_());
  }
  torn_ = garbage_ = false;
  frame.intrinsics = info_.intrinsics;
  frame.sequence = ++sequence_;
  frame.sensor = {clock_->now() + sensor_offset_ + 24h * 365, ClockId::Device};
  frame.host = {clock_->now(), ClockId::HostMonotonic};
  return ReadStatus::Frame;
}

}  // namespace armature::tools
