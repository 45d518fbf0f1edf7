#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/navproto/transport_fixture.h"

namespace armature::navproto {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

/// A subscriber in a process of its own that can be made to stand still. It reports over a pipe, a line each time its
/// velocity changes: the velocity in mm/s.
class SubscriberProcess {
 public:
  explicit SubscriberProcess(const std::string& uri) {
    int reports[2];
    if (::pipe(reports) != 0) std::abort();
    child_ = ::fork();
    if (child_ == 0) {
      NavSubscriber nav(uri);
      for (int last = -1;;) {
        (void)nav.wait(milliseconds(5));
        const int now = static_cast<int>(nav.velocity().linear_m_s * 1000);
        if (now == last) continue;
        last = now;
        if (::write(reports[1], &now, sizeof now) != sizeof now) ::_exit(1);
      }
    }
    ::close(reports[1]);
    reports_ = reports[0];
  }
  ~SubscriberProcess() {
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
    ::close(reports_);
  }
  SubscriberProcess(const SubscriberProcess&) = delete;
  SubscriberProcess& operator=(const SubscriberProcess&) = delete;

  void stand_still() const { ::kill(child_, SIGSTOP); }
  void go_on() const { ::kill(child_, SIGCONT); }
  /// The next velocity that it reports, mm/s; waits for it.
  [[nodiscard]] int next_report() const {
    int value = -1;
    if (::read(reports_, &value, sizeof value) != sizeof value) return -1;
    return value;
  }

 private:
  pid_t child_ = -1;
  int reports_ = -1;
};

TEST(SlowSubscriber, NeitherDelaysThePublisherNorSeesStaleMotion) {
  const TemporaryEndpoint endpoint;
  const SubscriberProcess slow(endpoint.uri());  // before this process has threads
  auto publisher = Publisher::bind(endpoint.uri());
  ASSERT_TRUE(publisher);
  NavSubscriber quick(endpoint.uri());

  ASSERT_EQ(slow.next_report(), 0);
  NavigationMessage message = walking(0.5);
  std::jthread publishing([&](const std::stop_token& stop) {
    for (; !stop.stop_requested(); std::this_thread::sleep_for(milliseconds(5))) publisher->publish_navigation(message);
  });
  ASSERT_EQ(slow.next_report(), 500);
  publishing.request_stop();
  publishing.join();

  slow.stand_still();
  // More than any queue between the two holds: 0.6 m/s, as fast as the publisher can. It must not block.
  message = walking(0.6);
  constexpr int kFlood = 20'000;
  for (int i = 0; i < kFlood; ++i) ASSERT_TRUE(publisher->publish_navigation(message));
  EXPECT_TRUE(repeat_until([&] { publisher->publish_navigation(message); },
                           [&] {
                             return quick.velocity() == Velocity{0.6, 0};
                           }))
      << "the others notice nothing";
  std::this_thread::sleep_for(milliseconds(400));  // now all of that is old
  slow.go_on();

  // Old motion is in its queues; none may show. First comes the stop, then what is published from now on.
  EXPECT_EQ(slow.next_report(), 0);
  message = walking(0.7);
  std::jthread again([&](const std::stop_token& stop) {
    for (; !stop.stop_requested(); std::this_thread::sleep_for(milliseconds(5))) publisher->publish_navigation(message);
  });
  EXPECT_EQ(slow.next_report(), 700);
}

}  // namespace
}  // namespace armature::navproto
