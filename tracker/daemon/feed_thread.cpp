#include "tracker/daemon/feed_thread.h"

#include <algorithm>
#include <chrono>
#include <vector>

namespace armature {

using namespace std::chrono_literals;

Expected<std::unique_ptr<FeedThread>> FeedThread::start(std::string_view endpoint,
                                                        const std::optional<navproto::CurveServer>& door) {
  auto publisher = navproto::FeedPublisher::bind(endpoint, {.curve = door});
  if (!publisher) return fail(publisher.error().message);
  return std::unique_ptr<FeedThread>(new FeedThread(std::move(*publisher)));
}

FeedThread::FeedThread(navproto::FeedPublisher publisher) : publisher_(std::move(publisher)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

FeedThread::~FeedThread() {
  thread_.request_stop();
  thread_.join();
}

void FeedThread::offer(DepthView frame, std::span<const std::uint8_t> user_of_pixel) noexcept {
  if (!wanted_.load(std::memory_order_relaxed)) return;
  DepthFrame& slot = frames_.slot();
  const std::size_t pixels = frame.depth_mm.size();
  if (user_of_pixel.size() != pixels) return;
  slot.depth_mm.resize(2 * pixels);
  std::copy(frame.depth_mm.begin(), frame.depth_mm.end(), slot.depth_mm.begin());
  std::copy(user_of_pixel.begin(), user_of_pixel.end(), slot.depth_mm.begin() + static_cast<std::ptrdiff_t>(pixels));
  slot.intrinsics = frame.intrinsics;
  slot.sequence = frame.sequence;
  slot.sensor = frame.sensor;
  slot.host = frame.host;
  frames_.publish();
}

void FeedThread::run(const std::stop_token& stop) {
  std::vector<std::uint8_t> mask;
  while (!stop.stop_requested()) {
    wanted_.store(publisher_.wanted(), std::memory_order_relaxed);
    const DepthFrame* frame = frames_.take(50ms);
    if (frame == nullptr) continue;
    const std::size_t pixels = frame->depth_mm.size() / 2;
    mask.assign(frame->depth_mm.begin() + static_cast<std::ptrdiff_t>(pixels), frame->depth_mm.end());

    navproto::FeedView view;
    view.times = {.frame = frame->sequence,
                  .sensor = frame->sensor.time,
                  .sensor_clock = static_cast<navproto::SensorClock>(frame->sensor.clock),
                  .received = frame->host.time};
    const Intrinsics& k = frame->intrinsics;
    view.intrinsics = {k.width, k.height, k.focal_x_px, k.focal_y_px, k.centre_x_px, k.centre_y_px};
    view.depth_mm = std::span(frame->depth_mm).first(pixels);
    view.user_mask = mask;
    (void)publisher_.publish(view);
  }
}

}  // namespace armature
