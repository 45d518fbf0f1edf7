#include "tools/tracking/feed_source.h"

#include <optional>
#include <utility>

#include <armature/navproto/endpoints.h>
#include <armature/navproto/feed.h>

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

class FeedSource final : public DepthSource {
 public:
  FeedSource(std::string endpoint, navproto::FeedSubscriber feed, const OpenOptions& options)
      : endpoint_(std::move(endpoint)), feed_(std::move(feed)), clock_(options.clock) {
    info_.uri = std::string(kFeedScheme) + endpoint_;
    info_.live = true;
  }

  Expected<void> await_first(std::chrono::milliseconds patience) {
    auto first = feed_.receive(patience);
    if (!first) return fail(first.error().message);
    if (!*first) {
      if (const auto at = navproto::endpoints_of(endpoint_)) {
        if (const auto allowed = navproto::may_connect(at->feed); !allowed) return fail(allowed.error().message);
      }
      return fail(endpoint_ + ": no depth came; is armatured running there, and has it a sensor?");
    }
    waiting_ = std::move(**first);
    const navproto::FeedIntrinsics& k = waiting_->intrinsics;
    info_.intrinsics = {k.width, k.height, k.focal_x_px, k.focal_y_px, k.centre_x_px, k.centre_y_px};
    return {};
  }

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }

  Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override {
    if (!waiting_) {
      auto received = feed_.receive(timeout);
      if (!received) return fail(received.error().message);
      if (!*received) return ReadStatus::Timeout;
      waiting_ = std::move(**received);
    }
    navproto::FeedMessage message = *std::exchange(waiting_, std::nullopt);
    const navproto::FeedIntrinsics& k = message.intrinsics;
    const Intrinsics now{k.width, k.height, k.focal_x_px, k.focal_y_px, k.centre_x_px, k.centre_y_px};
    if (now != info_.intrinsics) return fail(endpoint_ + ": the image has changed its size");
    if (message.times.sensor == last_) return ReadStatus::Timeout;
    last_ = message.times.sensor;
    frame.depth_mm = std::move(message.depth_mm);
    frame.intrinsics = now;
    frame.sequence = message.times.frame;
    frame.sensor = {message.times.sensor, static_cast<ClockId>(message.times.sensor_clock)};
    frame.host = {clock_->now(), ClockId::HostMonotonic};
    return ReadStatus::Frame;
  }

 private:
  std::string endpoint_;
  navproto::FeedSubscriber feed_;
  std::shared_ptr<Clock> clock_;
  SourceInfo info_;
  std::optional<navproto::FeedMessage> waiting_;
  std::chrono::nanoseconds last_{std::chrono::nanoseconds::min()};
};

}  // namespace

Expected<std::unique_ptr<DepthSource>> open_feed(const std::string& endpoint, const OpenOptions& options) {
  auto feed = navproto::FeedSubscriber::connect(endpoint);
  if (!feed) return fail(feed.error().message);
  auto source = std::make_unique<FeedSource>(endpoint, std::move(*feed), options);
  if (auto first = source->await_first(options.wait_for_device); !first) return tl::unexpected(first.error());
  return std::unique_ptr<DepthSource>(std::move(source));
}

}  // namespace armature::tools
