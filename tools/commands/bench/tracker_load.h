#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <armature/navproto/subscriber.h>

#include "firmware_host/error.h"
#include "tracker/daemon/feed_thread.h"

namespace armature::tools {

/// What goes on beside the tracker while it is measured.
enum class Load : std::uint8_t {
  None,
  Recording,  ///< `armature record` of the feed, a process of its own
  Flood,      ///< 64 subscribers that never read, and one that comes and goes all the time
  Both,
};
inline constexpr std::array<std::string_view, 4> kLoadNames = {"none", "recording", "flood", "both"};

/// Keeps a load up for as long as it lives. Thread-safe: no.
class TrackerLoad {
 public:
  /// `folder` is where the recording goes. Fails where the feed cannot be published or the recorder not be started.
  [[nodiscard]] static Expected<std::unique_ptr<TrackerLoad>> start(Load load, const std::string& endpoint,
                                                                    const std::filesystem::path& folder);
  ~TrackerLoad();
  TrackerLoad(const TrackerLoad&) = delete;
  TrackerLoad& operator=(const TrackerLoad&) = delete;

  /// As the daemon does it after each frame.
  void offer(DepthView frame, std::span<const std::uint8_t> user_of_pixel) noexcept;
  /// Whether everything is under way: a recording has begun. Fails once the recorder has ended.
  [[nodiscard]] Expected<bool> under_way() const;

 private:
  TrackerLoad() = default;
  std::unique_ptr<FeedThread> feed_;
  std::filesystem::path recording_;
  pid_t recorder_ = -1;
  std::vector<std::unique_ptr<navproto::NavSubscriber>> crowd_;
  std::jthread restless_;
};

}  // namespace armature::tools
