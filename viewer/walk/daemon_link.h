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
  /// `curve`: who we are, to a daemon over tcp that asks. A malformed endpoint leaves a link that never hears anything;
  /// `error()` says so.
  explicit DaemonLink(std::string endpoint, std::optional<navproto::CurveClient> curve = {});
  ~DaemonLink();
  DaemonLink(const DaemonLink&) = delete;
  DaemonLink& operator=(const DaemonLink&) = delete;

  [[nodiscard]] const std::string& endpoint() const noexcept { return endpoint_; }
  [[nodiscard]] navproto::NavSubscriber& stream() noexcept { return stream_; }
  /// The newest frame of the feed; none before the first.
  [[nodiscard]] std::shared_ptr<const navproto::FeedMessage> feed() const;
  /// Whether frames are to be asked for at all.
  void want_feed(bool wanted);

  /// Whether it can be asked for anything: over tcp it cannot.
  [[nodiscard]] bool has_control() const { return endpoint_.starts_with("ipc:"); }
  /// Sends a request when those before it are answered. `quiet`: its answer counts only where it is a failure.
  void request(navproto::ControlRequest request, bool quiet = false);
  /// What became of a request.
  struct Answer {
    navproto::RequestKind kind;
    navproto::Expected<navproto::ControlReply> reply;  ///< or why there is none
  };
  /// The next answer to a request.
  [[nodiscard]] std::optional<Answer> take_answer();
  /// What holds, as the last answer said.
  [[nodiscard]] std::optional<navproto::ControlSettings> settings() const;
  [[nodiscard]] std::optional<std::string> error() const;

 private:
  void receive_feed(const std::stop_token& stop);
  void serve_requests(const std::stop_token& stop);

  struct Asked {
    navproto::ControlRequest request;
    bool quiet;
  };
  std::string endpoint_;
  std::optional<navproto::CurveClient> curve_;
  navproto::NavSubscriber stream_;
  mutable std::mutex mutex_;
  std::condition_variable_any asked_;
  bool feed_wanted_ = true;
  std::shared_ptr<const navproto::FeedMessage> feed_;
  std::deque<Asked> requests_;
  std::deque<Answer> answers_;
  std::optional<navproto::ControlSettings> settings_;
  std::jthread feed_thread_, control_thread_;
};

}  // namespace armature::viewer
