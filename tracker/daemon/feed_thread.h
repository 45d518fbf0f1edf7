#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <thread>

#include <armature/navproto/feed.h>

#include "firmware_host/depth_frame.h"
#include "firmware_host/error.h"
#include "firmware_host/latest_frame.h"
#include "tracker/pipeline.h"

namespace armature {

/// Compresses and sends depth and user mask on a thread of its own, newest frame first, while somebody subscribes.
class FeedThread {
 public:
  [[nodiscard]] static Expected<std::unique_ptr<FeedThread>> start(
      std::string_view endpoint, const std::optional<navproto::CurveServer>& door = {});
  ~FeedThread();

  /// Peers sent away because of their keys.
  [[nodiscard]] std::uint64_t strangers() const noexcept { return publisher_.strangers(); }

  /// Hands a frame over where somebody wants it; costs one copy then, and a look at a flag otherwise. For the tracking
  /// thread. Realtime-safe: yes, after the first frame.
  void offer(DepthView frame, std::span<const std::uint8_t> user_of_pixel) noexcept;

 private:
  explicit FeedThread(navproto::FeedPublisher publisher);
  void run(const std::stop_token& stop);

  navproto::FeedPublisher publisher_;
  std::atomic<bool> wanted_{false};
  LatestFrame frames_;  // the mask rides in the rows below the image: [2 height][width]
  std::jthread thread_;
};

}  // namespace armature
