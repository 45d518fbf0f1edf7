#include "viewer/walk/daemon_link.h"

#include <utility>

#include <armature/navproto/control.h>
#include <armature/navproto/feed.h>

namespace armature::viewer {

using namespace std::chrono_literals;

DaemonLink::DaemonLink(std::string endpoint)
    : endpoint_(std::move(endpoint)),
      stream_(endpoint_),
      feed_thread_([this](const std::stop_token& stop) { receive_feed(stop); }),
      control_thread_([this](const std::stop_token& stop) { serve_requests(stop); }) {}

DaemonLink::~DaemonLink() {
  feed_thread_.request_stop();
  control_thread_.request_stop();
}

std::shared_ptr<const navproto::FeedMessage> DaemonLink::feed() const {
  const std::lock_guard lock(mutex_);
  return feed_;
}

void DaemonLink::want_feed(bool wanted) {
  const std::lock_guard lock(mutex_);
  feed_wanted_ = wanted;
  if (!wanted) feed_.reset();
  asked_.notify_all();
}

void DaemonLink::request(navproto::ControlRequest request) {
  const std::lock_guard lock(mutex_);
  requests_.push_back(std::move(request));
  asked_.notify_all();
}

std::optional<navproto::Expected<navproto::ControlReply>> DaemonLink::take_reply() {
  const std::lock_guard lock(mutex_);
  if (replies_.empty()) return std::nullopt;
  auto reply = std::move(replies_.front());
  replies_.pop_front();
  return reply;
}

std::optional<navproto::ControlSettings> DaemonLink::settings() const {
  const std::lock_guard lock(mutex_);
  return settings_;
}

std::optional<std::string> DaemonLink::error() const {
  const auto error = stream_.error();
  return error ? std::optional(error->message) : std::nullopt;
}

void DaemonLink::receive_feed(const std::stop_token& stop) {
  std::optional<navproto::FeedSubscriber> subscriber;
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      if (!feed_wanted_) {
        subscriber.reset();  // the daemon compresses for nobody
        asked_.wait(lock, stop, [this] { return feed_wanted_; });
        continue;
      }
    }
    if (!subscriber) {
      auto connected = navproto::FeedSubscriber::connect(endpoint_);
      if (!connected) return;  // the stream's subscriber says why
      subscriber = std::move(*connected);
    }
    // A frame that cannot be decoded is skipped: the next one may be fine.
    auto frame = subscriber->receive(100ms);
    if (!frame || !*frame) continue;
    auto shared = std::make_shared<const navproto::FeedMessage>(std::move(**frame));
    const std::lock_guard lock(mutex_);
    feed_ = std::move(shared);
  }
}

void DaemonLink::serve_requests(const std::stop_token& stop) {
  auto client = navproto::ControlClient::connect(endpoint_);
  if (!client) return;
  auto last_status = std::chrono::steady_clock::time_point();
  while (!stop.stop_requested()) {
    std::optional<navproto::ControlRequest> request;
    {
      std::unique_lock lock(mutex_);
      asked_.wait_for(lock, stop, 250ms, [this] { return !requests_.empty(); });
      if (!requests_.empty()) {
        request = std::move(requests_.front());
        requests_.pop_front();
      }
    }
    // Now and then what holds is asked for: others may change it, or the daemon may be another one.
    const bool asks = request.has_value();
    const auto now = std::chrono::steady_clock::now();
    if (!asks && now - last_status < 2s) continue;
    last_status = now;
    auto reply = client->request(request.value_or(navproto::ControlRequest{}), asks ? 2000ms : 500ms);
    const std::lock_guard lock(mutex_);
    if (reply) settings_ = reply->settings;
    if (asks) replies_.push_back(std::move(reply));
  }
}

}  // namespace armature::viewer
