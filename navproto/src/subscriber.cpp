#include <algorithm>
#include <array>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include <armature/navproto/codec.h>
#include <armature/navproto/endpoints.h>
#include <armature/navproto/subscriber.h>

#include "navproto/src/freshness.h"
#include "navproto/src/gatekeeper.h"
#include "navproto/src/socket.h"
#include "navproto/src/wake.h"

namespace armature::navproto {
namespace {

constexpr std::size_t kMaxQueuedEvents = 1024;
/// Of navigation and skeletons the newest counts; a thread of ours reads them as they come and keeps that. ZMQ_CONFLATE
/// is not for us: where writing meets reading, libzmq 4.3.4 never frees what was written before, 18 KB a time.
constexpr int kMotionQueue = 64;
constexpr int kUnlimited = 0;

std::string_view prefix(Topic topic) {
  return kTopicPrefixes[static_cast<std::size_t>(topic)];
}

}  // namespace

struct NavSubscriber::Impl {
  SubscriberOptions options;
  ContextHandle context = make_context();
  Socket navigation_socket{context.get(), ZMQ_SUB};
  Socket skeleton_socket{context.get(), ZMQ_SUB};
  Socket events_socket{context.get(), ZMQ_SUB};
  Wake stop;

  // Shared with the receiving thread.
  mutable std::mutex mutex;
  std::condition_variable arrived;
  Arrivals arrivals;
  std::optional<NavigationMessage> navigation;
  std::optional<SkeletonMessage> skeleton;
  std::optional<HealthMessage> health;
  std::deque<EventMessage> events;
  std::uint64_t event_session = 0;
  std::uint64_t last_event = 0;
  std::optional<Error> error;
  Freshness freshness;
  std::chrono::nanoseconds made_at{0};  // the newest navigation, by our clock

  std::jthread thread;  // last: it stops before what it uses goes

  explicit Impl(SubscriberOptions given) : options(std::move(given)) {}
  ~Impl() { stop.wake(); }

  Expected<void> connect_all(std::string_view endpoint) {
    const auto endpoints = endpoints_of(endpoint);
    if (!endpoints) return tl::unexpected(endpoints.error());
    if (!stop) return fail("no file descriptor is left to listen with; raise `ulimit -n`");
    const auto open = [this](Socket& socket, const std::string& where, int queue) {
      socket.set(ZMQ_LINGER, 0).set(ZMQ_RECONNECT_IVL, 50).set(ZMQ_RECONNECT_IVL_MAX, 400).set(ZMQ_RCVHWM, queue);
      if (options.curve) identify(socket, *options.curve);
      return connect(socket, where);
    };
    auto opened = open(navigation_socket, endpoints->navigation, kMotionQueue);
    navigation_socket.subscribe(prefix(Topic::Navigation));
    if (opened && options.skeleton) {
      opened = open(skeleton_socket, endpoints->skeleton, kMotionQueue);
      skeleton_socket.subscribe(prefix(Topic::Skeleton));
    }
    if (opened && options.events) {
      opened = open(events_socket, endpoints->events, kUnlimited);
      events_socket.subscribe(prefix(Topic::Event));
      events_socket.subscribe(prefix(Topic::Health));
    }
    return opened;
  }

  void receive_until_stopped() {
    std::array<zmq_pollitem_t, 4> items{};
    items[0] = {nullptr, stop.descriptor(), ZMQ_POLLIN, 0};
    items[1] = {navigation_socket.get(), 0, ZMQ_POLLIN, 0};
    items[2] = {skeleton_socket.get(), 0, ZMQ_POLLIN, 0};
    items[3] = {events_socket.get(), 0, ZMQ_POLLIN, 0};
    Part part;
    for (;;) {
      if (!poll(items, std::chrono::milliseconds(-1))) continue;
      if (items[0].revents != 0) return;
      for (Socket* socket : {&navigation_socket, &skeleton_socket, &events_socket}) {
        for (int i = 0; i < kMostAtATime && socket->receive(part); ++i) accept(part.bytes());
      }
    }
  }

  void accept(std::span<const std::byte> part) {
    switch (topic_of(part).value_or(Topic::Feed)) {
      case Topic::Navigation: return accept_as<NavigationMessage>(part);
      case Topic::Skeleton: return accept_as<SkeletonMessage>(part);
      case Topic::Event: return accept_as<EventMessage>(part);
      case Topic::Health: return accept_as<HealthMessage>(part);
      default: return;
    }
  }

  template <class Message>
  void accept_as(std::span<const std::byte> part) {
    auto message = decode<Message>(part);
    const std::lock_guard lock(mutex);
    if (message) {
      take(*std::move(message));
    } else {
      error = std::move(message).error();
      arrivals.error = true;
    }
    if (arrivals) arrived.notify_all();
  }

  void take(const NavigationMessage& message) {
    const bool same_session = navigation && navigation->header.session_id == message.header.session_id;
    if (!same_session) freshness = {};
    const auto made =
        freshness.made_at(message.times.published, message.header.sent, std::max(options.now(), decltype(made_at){0}));
    if (same_session && message.header.sequence <= navigation->header.sequence) return;
    made_at = made;
    navigation = message;
    arrivals.navigation = true;
  }
  void take(const SkeletonMessage& message) {
    if (is_old(skeleton, message)) return;
    skeleton = message;
    arrivals.skeleton = true;
  }
  void take(HealthMessage&& message) {
    if (is_old(health, message)) return;
    health = std::move(message);
    arrivals.health = true;
  }
  void take(EventMessage&& message) {
    const Header& header = message.header;
    if (header.session_id == event_session && header.sequence <= last_event) return;
    event_session = header.session_id;
    last_event = header.sequence;
    if (events.size() == kMaxQueuedEvents) events.pop_front();
    events.push_back(std::move(message));
    arrivals.events = true;
  }
  template <class Message>
  static bool is_old(const std::optional<Message>& have, const Message& message) {
    return have && have->header.session_id == message.header.session_id &&
           message.header.sequence <= have->header.sequence;
  }
};

NavSubscriber::NavSubscriber(std::string_view endpoint, SubscriberOptions options)
    : impl_(std::make_unique<Impl>(std::move(options))) {
  if (auto connected = impl_->connect_all(endpoint); !connected) {
    impl_->error = std::move(connected).error();
    impl_->arrivals.error = true;
    return;
  }
  impl_->thread = std::jthread([impl = impl_.get()] { impl->receive_until_stopped(); });
}

NavSubscriber::~NavSubscriber() = default;

Velocity NavSubscriber::velocity() const noexcept {
  const auto now = impl_->options.now();
  const std::lock_guard lock(impl_->mutex);
  if (!impl_->navigation || now - impl_->made_at > impl_->options.max_age) return {};
  return impl_->navigation->velocity;
}

std::optional<NavigationMessage> NavSubscriber::navigation() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->navigation;
}

std::optional<SkeletonMessage> NavSubscriber::skeleton() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->skeleton;
}

std::optional<HealthMessage> NavSubscriber::health() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->health;
}

std::vector<EventMessage> NavSubscriber::take_events() {
  const std::lock_guard lock(impl_->mutex);
  std::vector<EventMessage> events(std::make_move_iterator(impl_->events.begin()),
                                   std::make_move_iterator(impl_->events.end()));
  impl_->events.clear();
  return events;
}

Arrivals NavSubscriber::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(impl_->mutex);
  impl_->arrived.wait_for(lock, timeout, [this] { return static_cast<bool>(impl_->arrivals); });
  return std::exchange(impl_->arrivals, {});
}

std::optional<Error> NavSubscriber::error() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->error;
}

}  // namespace armature::navproto
