#include <array>
#include <condition_variable>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <armature/navproto/codec.h>
#include <armature/navproto/endpoints.h>
#include <armature/navproto/feed.h>

#include "navproto/src/entrance.h"
#include "navproto/src/gatekeeper.h"
#include "navproto/src/session.h"
#include "navproto/src/socket.h"
#include "navproto/src/wake.h"

namespace armature::navproto {
namespace {

// Two images under way: one being sent, one waiting. (ZMQ_CONFLATE leaks, see subscriber.cpp.)
constexpr int kFeedQueue = 2;

}  // namespace

struct FeedPublisher::Impl {
  Entrance entrance{kOfSubscribers};  // first, so that it outlives the context
  PublisherOptions options;
  ContextHandle context = make_context();
  std::unique_ptr<Gatekeeper> gatekeeper;
  Socket socket{context.get(), ZMQ_XPUB};
  Encoder encoder;
  Part request;
  std::set<std::string, std::less<>> subscriptions;  // XPUB reports each once, and when its last holder goes
  std::uint64_t sequence = 0;

  void collect() {
    while (socket.receive(request)) {
      const auto bytes = request.bytes();
      if (bytes.empty()) continue;
      std::string topic(reinterpret_cast<const char*>(bytes.data()) + 1, bytes.size() - 1);
      if (bytes[0] == std::byte{1})
        subscriptions.insert(std::move(topic));
      else
        subscriptions.erase(topic);
    }
  }
  [[nodiscard]] bool wanted() const {
    const std::string_view ours = kTopicPrefixes[static_cast<std::size_t>(Topic::Feed)];
    for (const std::string& topic : subscriptions) {
      if (ours.substr(0, topic.size()) == std::string_view(topic).substr(0, ours.size())) return true;
    }
    return false;
  }
};

Expected<FeedPublisher> FeedPublisher::bind(std::string_view endpoint, PublisherOptions options) {
  const auto endpoints = endpoints_of(endpoint);
  if (!endpoints) return tl::unexpected(endpoints.error());
  auto impl = std::make_unique<Impl>();
  impl->options = std::move(options);
  if (impl->options.session_id == 0) impl->options.session_id = random_session_id();
  impl->socket.set(ZMQ_SNDHWM, kFeedQueue).set(ZMQ_LINGER, 0);
  if (impl->options.curve && endpoints->feed.starts_with("tcp:")) {
    impl->gatekeeper = std::make_unique<Gatekeeper>(impl->context.get(), *impl->options.curve);
    if (!impl->gatekeeper->at_the_door())
      return fail("nobody can check who connects: no socket is left; let the process have more open files");
    impl->gatekeeper->guard(impl->socket);
  }
  if (auto bound = impl->entrance.open(endpoints->feed, impl->socket); !bound) return tl::unexpected(bound.error());
  return FeedPublisher(std::move(impl));
}

FeedPublisher::FeedPublisher(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
FeedPublisher::~FeedPublisher() = default;
FeedPublisher::FeedPublisher(FeedPublisher&&) noexcept = default;
FeedPublisher& FeedPublisher::operator=(FeedPublisher&&) noexcept = default;

std::uint64_t FeedPublisher::strangers() const noexcept {
  return impl_->gatekeeper ? impl_->gatekeeper->refused() : 0;
}

bool FeedPublisher::wanted() noexcept {
  impl_->collect();
  return impl_->wanted();
}

Expected<bool> FeedPublisher::publish(const FeedView& view) {
  if (!wanted()) return false;
  FeedView stamped = view;
  const auto now = impl_->options.now();
  stamped.header = {impl_->options.session_id, impl_->sequence + 1, now, false};
  stamped.times.published = now;
  if (const auto complaint = check(stamped)) return fail("feed: " + complaint->message);
  const auto part = impl_->encoder.encode(stamped);
  if (part.empty()) return fail("feed: the image could not be compressed");
  ++impl_->sequence;
  return impl_->socket.send(part);
}

/// A thread of its own reads what comes and keeps the newest, so that nothing old waits for whoever comes late.
struct FeedSubscriber::Impl {
  ContextHandle context = make_context();
  Socket socket{context.get(), ZMQ_SUB};
  Wake stop;

  // Shared with the receiving thread.
  std::mutex mutex;
  std::condition_variable arrived;
  std::vector<std::byte> newest;
  bool fresh = false;  // nobody took it yet

  std::vector<std::byte> taken;
  std::jthread thread;  // last: it stops before what it uses goes

  ~Impl() { stop.wake(); }

  void receive_until_stopped() {
    std::array<zmq_pollitem_t, 2> items{
        {{nullptr, stop.descriptor(), ZMQ_POLLIN, 0}, {socket.get(), 0, ZMQ_POLLIN, 0}}};
    Part part;
    std::vector<std::byte> bytes;
    for (;;) {
      if (!poll(items, std::chrono::milliseconds(-1))) continue;
      if (items[0].revents != 0) return;
      for (int i = 0; i < kMostAtATime && socket.receive(part); ++i) {
        bytes.assign(part.bytes().begin(), part.bytes().end());
        {
          const std::lock_guard lock(mutex);
          newest.swap(bytes);
          fresh = true;
        }
        arrived.notify_one();
      }
    }
  }
};

Expected<FeedSubscriber> FeedSubscriber::connect(std::string_view endpoint, const std::optional<CurveClient>& curve) {
  const auto endpoints = endpoints_of(endpoint);
  if (!endpoints) return tl::unexpected(endpoints.error());
  auto impl = std::make_unique<Impl>();
  if (!impl->stop) return fail("no file descriptor is left to listen with; raise `ulimit -n`");
  impl->socket.set(ZMQ_LINGER, 0).set(ZMQ_RECONNECT_IVL, 50).set(ZMQ_RECONNECT_IVL_MAX, 400);
  impl->socket.set(ZMQ_RCVHWM, kFeedQueue);
  impl->socket.set_max_bytes(kMaxFeedBytes);
  if (curve) identify(impl->socket, *curve);
  if (auto connected = navproto::connect(impl->socket, endpoints->feed); !connected) {
    return tl::unexpected(connected.error());
  }
  impl->socket.subscribe(kTopicPrefixes[static_cast<std::size_t>(Topic::Feed)]);
  impl->thread = std::jthread([self = impl.get()] { self->receive_until_stopped(); });
  return FeedSubscriber(std::move(impl));
}

FeedSubscriber::FeedSubscriber(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
FeedSubscriber::~FeedSubscriber() = default;
FeedSubscriber::FeedSubscriber(FeedSubscriber&&) noexcept = default;
FeedSubscriber& FeedSubscriber::operator=(FeedSubscriber&&) noexcept = default;

Expected<std::optional<FeedMessage>> FeedSubscriber::receive(std::chrono::milliseconds timeout) {
  {
    std::unique_lock lock(impl_->mutex);
    if (!impl_->arrived.wait_for(lock, timeout, [this] { return impl_->fresh; })) return std::optional<FeedMessage>();
    impl_->taken.swap(impl_->newest);
    impl_->fresh = false;
  }
  auto message = decode<FeedMessage>(impl_->taken);
  if (!message) return tl::unexpected(std::move(message).error());
  return std::optional(*std::move(message));
}

}  // namespace armature::navproto
