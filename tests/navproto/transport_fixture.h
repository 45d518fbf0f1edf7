#pragma once

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <armature/navproto/publisher.h>
#include <armature/navproto/subscriber.h>

#include "tests/support/temporary_directory.h"

namespace armature::navproto {

/// Long enough for a loaded machine; no test waits so long unless it fails.
inline constexpr std::chrono::milliseconds kPatience{20'000};

/// An ipc endpoint in a folder of its own, which goes with it.
class TemporaryEndpoint {
 public:
  [[nodiscard]] std::filesystem::path path() const { return folder_ / "nav"; }
  [[nodiscard]] std::string uri() const { return "ipc://" + path().string(); }

 private:
  test::TemporaryDirectory folder_;
};

struct TcpPublisher {
  std::string uri;
  Publisher publisher;
};
/// At ports of this machine that nobody has; nothing where there are none.
[[nodiscard]] inline std::optional<TcpPublisher> publisher_over_tcp(const PublisherOptions& options = {}) {
  // Five free ports in a row are not to be had from the kernel; try a few places.
  for (int port = 20'500; port < 20'900; port += 10) {
    std::string uri = "tcp://127.0.0.1:" + std::to_string(port);
    if (auto publisher = Publisher::bind(uri, options)) return TcpPublisher{std::move(uri), *std::move(publisher)};
  }
  return std::nullopt;
}

/// A clock that the ends of a test share and that only the test moves.
class SharedClock {
 public:
  [[nodiscard]] Now now() const {
    return [time = time_] { return std::chrono::nanoseconds(*time); };
  }
  void advance(std::chrono::nanoseconds by) { *time_ += by.count(); }

 private:
  std::shared_ptr<std::atomic<std::int64_t>> time_ = std::make_shared<std::atomic<std::int64_t>>(1'000'000'000);
};

[[nodiscard]] inline NavigationMessage walking(double linear_m_s) {
  NavigationMessage message;
  message.engagement = Engagement::Engaged;
  message.velocity = {linear_m_s, 0};
  return message;
}

/// Runs `step` and `arrived` in turn until the latter is true; false when patience ends first.
template <class Step, class Predicate>
[[nodiscard]] bool repeat_until(Step step, Predicate arrived) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!arrived()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    step();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace armature::navproto
