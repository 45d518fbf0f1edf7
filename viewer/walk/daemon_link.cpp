#include "viewer/walk/daemon_link.h"

#include <utility>

#include <armature/navproto/control.h>
#include <armature/navproto/feed.h>

namespace armature::viewer {

using namespace std::chrono_literals;

DaemonLink::DaemonLink(std::string endpoint, std::optional<navproto::CurveClient> curve)
    : endpoint_(std::move(endpoint)),
      curve_(std::move(curve)),
      stream_(endpoint_, {.curve = curve_}),
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

void DaemonLink::request(navproto::ControlRequest request, bool quiet) {
  const std::lock_guard lock(mutex_);
  requests_.push_back({std::move(request), quiet});
  asked_.notify_all();
}

std::optional<DaemonLink::Answer> DaemonLink::take_answer() {
  const std::lock_guard lock(mutex_);
  if (answers_.empty()) return std::nullopt;
  auto answer = std::move(answers_.front());
  answers_.pop_front();
  return answer;
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
      auto connected = navproto::FeedSubscriber::connect(endpoint_, curve_);
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
  if (!has_control()) return;
  auto client = navproto::ControlClient::connect(endpoint_);
  if (!client) return;
  auto last_status = std::chrono::steady_clock::time_point();
  while (!stop.stop_requested()) {
    std::optional<Asked> asked;
    {
      std::unique_lock lock(mutex_);
      asked_.wait_for(lock, stop, 250ms, [this] { return !requests_.empty(); });
      if (!requests_.empty()) {
        asked = std::move(requests_.front());
        requests_.pop_front();
      }
    }
    // Now and then what holds is asked for: others may change it, or the daemon may be another one.
    const auto now = std::chrono::steady_clock::now();
    if (!asked && now - last_status < 2s) continue;
    last_status = now;
    auto reply = client->request(asked ? asked->request : navproto::ControlRequest{}, asked ? 2000ms : 500ms);
    const std::lock_guard lock(mutex_);
    if (reply) settings_ = reply->settings;
    const bool done = reply && reply->error.empty();
    if (asked && !(asked->quiet && done)) answers_.push_back({asked->request.kind, std::move(reply)});
  }
}

}  // namespace armature::viewer
