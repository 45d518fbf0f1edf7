#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include <armature/navproto/codec.h>
#include <armature/navproto/endpoints.h>
#include <armature/navproto/publisher.h>

#include "navproto/src/entrance.h"
#include "navproto/src/gatekeeper.h"
#include "navproto/src/session.h"
#include "navproto/src/socket.h"
#include "navproto/src/wire.h"

namespace armature::navproto {
namespace {

// What is conflated is worth little when old: a short queue. Events wait for their subscriber as long as memory allows.
constexpr int kMotionQueue = 4;
constexpr int kEventQueue = 10'000;
constexpr int kLingerMs = 250;
constexpr std::size_t kEventsKept = 16;

using Bytes = std::vector<std::byte>;

/// One bound socket and the last parts that went through it, for those who come late.
class Outlet {
 public:
  Outlet() = default;
  Outlet(void* context, int queue) : socket_(context, ZMQ_XPUB) {
    socket_.set(ZMQ_SNDHWM, queue).set(ZMQ_LINGER, kLingerMs).set(ZMQ_XPUB_VERBOSE, 1);
  }

  void guard(const Gatekeeper& gatekeeper) { gatekeeper.guard(socket_); }
  [[nodiscard]] Expected<void> bind(Entrance& entrance, const std::string& endpoint) {
    return entrance.open(endpoint, socket_);
  }

  /// Sends `part` and keeps it in `kept`, whose buffer it reuses.
  bool send(std::span<const std::byte> part, Bytes& kept) {
    kept.assign(part.begin(), part.end());
    return socket_.send(part);
  }

  /// Whether somebody has subscribed to a prefix of `topic` since the last call of collect().
  [[nodiscard]] bool newly_subscribed(Topic topic) const noexcept {
    return newcomers_[static_cast<std::size_t>(topic)];
  }
  void collect() noexcept {
    newcomers_ = {};
    while (socket_.receive(request_)) {
      const auto bytes = request_.bytes();
      if (bytes.empty() || bytes[0] != std::byte{1}) continue;
      for (std::size_t i = 0; i < kTopicPrefixes.size(); ++i) {
        const std::size_t length = std::min(bytes.size() - 1, kTopicPrefixes[i].size());
        if (std::memcmp(bytes.data() + 1, kTopicPrefixes[i].data(), length) == 0) newcomers_[i] = true;
      }
    }
  }
  bool replay(Bytes& part, std::chrono::nanoseconds now) noexcept {
    if (part.empty()) return false;
    mark_replayed(part, now);
    return socket_.send(part);
  }

 private:
  Socket socket_;
  Part request_;
  std::array<bool, kTopicPrefixes.size()> newcomers_{};
};

}  // namespace

struct Publisher::Impl {
  PublisherOptions options;
  Entrance entrance{kOfSubscribers};  // first, so that it outlives the context
  ContextHandle context = make_context();
  std::unique_ptr<Gatekeeper> gatekeeper;
  Outlet navigation{context.get(), kMotionQueue};
  Outlet skeleton{context.get(), kMotionQueue};
  Outlet events{context.get(), kEventQueue};
  Encoder encoder;
  Bytes last_navigation;
  Bytes last_skeleton;
  Bytes last_health;
  std::array<Bytes, kEventsKept> last_events;  // a ring: event n at n % kEventsKept
  std::array<std::uint64_t, kTopicPrefixes.size()> sequence{};
  PublisherCounters counters;

  explicit Impl(PublisherOptions given) : options(std::move(given)) {
    if (options.session_id == 0) options.session_id = random_session_id();
  }

  /// Answers those who have just subscribed to what goes through `outlet`.
  void serve(Outlet& outlet) noexcept {
    outlet.collect();
    const auto answer = [&](Topic topic, Bytes& part) {
      if (outlet.newly_subscribed(topic) && outlet.replay(part, options.now())) ++counters.replayed;
    };
    if (&outlet == &navigation) answer(Topic::Navigation, last_navigation);
    if (&outlet == &skeleton) answer(Topic::Skeleton, last_skeleton);
    if (&outlet != &events) return;
    answer(Topic::Health, last_health);
    const std::uint64_t newest = sequence[static_cast<std::size_t>(Topic::Event)];
    for (std::uint64_t i = 1; i <= kEventsKept; ++i) answer(Topic::Event, last_events[(newest + i) % kEventsKept]);
  }
  void serve() noexcept {
    for (Outlet* outlet : {&navigation, &skeleton, &events}) serve(*outlet);
  }

  template <class Message>
  bool publish(Message& message, Topic topic, Outlet& outlet, Bytes& kept) noexcept {
    serve(outlet);
    const auto now = options.now();
    std::uint64_t& last = sequence[static_cast<std::size_t>(topic)];
    message.header = {options.session_id, last + 1, now, false};
    if constexpr (requires { message.times; }) message.times.published = now;
    const auto part = encoder.encode(message);
    if (part.empty()) {
      ++counters.refused;
      return false;
    }
    ++last;
    ++counters.sent;
    outlet.send(part, kept);
    return true;
  }
};

Expected<Publisher> Publisher::bind(std::string_view endpoint, PublisherOptions options) {
  const auto endpoints = endpoints_of(endpoint);
  if (!endpoints) return tl::unexpected(endpoints.error());
  auto impl = std::make_unique<Impl>(std::move(options));
  const std::array<std::pair<Outlet*, const std::string*>, 3> bindings = {{{&impl->navigation, &endpoints->navigation},
                                                                           {&impl->skeleton, &endpoints->skeleton},
                                                                           {&impl->events, &endpoints->events}}};
  if (impl->options.curve && endpoints->navigation.starts_with("tcp:")) {
    impl->gatekeeper = std::make_unique<Gatekeeper>(impl->context.get(), *impl->options.curve);
    if (!impl->gatekeeper->at_the_door())
      return fail("nobody can check who connects: no socket is left; let the process have more open files");
    for (const auto& [outlet, where] : bindings) outlet->guard(*impl->gatekeeper);
  }
  for (const auto& [outlet, where] : bindings) {
    if (auto bound = outlet->bind(impl->entrance, *where); !bound) return tl::unexpected(bound.error());
  }
  return Publisher(std::move(impl));
}

Publisher::Publisher(std::unique_ptr<Impl> impl) noexcept : impl_(std::move(impl)) {}
Publisher::~Publisher() = default;
Publisher::Publisher(Publisher&&) noexcept = default;
Publisher& Publisher::operator=(Publisher&&) noexcept = default;

bool Publisher::publish_navigation(NavigationMessage& message) noexcept {
  return impl_->publish(message, Topic::Navigation, impl_->navigation, impl_->last_navigation);
}

bool Publisher::publish_skeleton(SkeletonMessage& message) noexcept {
  return impl_->publish(message, Topic::Skeleton, impl_->skeleton, impl_->last_skeleton);
}

bool Publisher::publish_event(EventMessage& message) noexcept {
  message.text = sanitised(std::move(message.text));
  const std::uint64_t next = impl_->sequence[static_cast<std::size_t>(Topic::Event)] + 1;
  return impl_->publish(message, Topic::Event, impl_->events, impl_->last_events[next % kEventsKept]);
}

bool Publisher::publish_health(HealthMessage& message) noexcept {
  message.version = sanitised(std::move(message.version));
  message.source = sanitised(std::move(message.source));
  message.source_trouble = sanitised(std::move(message.source_trouble));
  return impl_->publish(message, Topic::Health, impl_->events, impl_->last_health);
}

void Publisher::serve() noexcept {
  impl_->serve();
}

std::uint64_t Publisher::session_id() const noexcept {
  return impl_->options.session_id;
}

PublisherCounters Publisher::counters() const noexcept {
  PublisherCounters counters = impl_->counters;
  if (impl_->gatekeeper) counters.strangers = impl_->gatekeeper->refused();
  return counters;
}

}  // namespace armature::navproto
