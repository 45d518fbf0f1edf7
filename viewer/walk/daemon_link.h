#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <armature/navproto/control_messages.h>
#include <armature/navproto/error.h>
#include <armature/navproto/feed_message.h>
#include <armature/navproto/subscriber.h>

namespace armature::viewer {

/// All that a viewer and a daemon have to do with each other: the stream, the depth feed, and the control channel, the
/// last two on threads of their own, so that nothing here waits. The daemon may start later, stop and come back. Used
/// by one thread.
class DaemonLink {
 public:
  /// A malformed endpoint leaves a link that never hears anything; `error()` says so.
  explicit DaemonLink(std::string endpoint);
  ~DaemonLink();
  DaemonLink(const DaemonLink&) = delete;
  DaemonLink& operator=(const DaemonLink&) = delete;

  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }
  [[nodiscard]] navproto::NavSubscriber& stream() noexcept { return stream_; }
  /// The newest frame of the feed; none before the first.
  [[nodiscard]] std::shared_ptr<const navproto::FeedMessage> feed() const;
  /// Whether frames are to be asked for at all.
  void want_feed(bool wanted);

  /// Sends a request when those before it are answered.
  void request(navproto::ControlRequest request);
  /// The next answer to a request that asked for something, or why there is none.
  [[nodiscard]] std::optional<navproto::Expected<navproto::ControlReply>> take_reply();
  /// What holds, as the last answer said.
  [[nodiscard]] std::optional<navproto::ControlSettings> settings() const;
  [[nodiscard]] std::optional<std::string> error() const;

 private:
  void receive_feed(const std::stop_token& stop);
  void serve_requests(const std::stop_token& stop);

  std::string endpoint_;
  navproto::NavSubscriber stream_;
  mutable std::mutex mutex_;
  std::condition_variable_any asked_;
  bool feed_wanted_ = true;
  std::shared_ptr<const navproto::FeedMessage> feed_;
  std::deque<navproto::ControlRequest> requests_;
  std::deque<navproto::Expected<navproto::ControlReply>> replies_;
  std::optional<navproto::ControlSettings> settings_;
  std::jthread feed_thread_, control_thread_;
};

}  // namespace armature::viewer
