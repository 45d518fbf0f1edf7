#include "tools/interrupt.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <mutex>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

namespace armature::tools {
namespace {

// A signal handler may only write to a pipe: requesting a stop takes locks. The handler has no argument of ours, hence
// the mutable global.
std::array<int, 2> signal_pipe = {-1, -1};
constexpr char kSignal = 's';
constexpr char kEnd = 'e';

extern "C" void armature_on_signal(int /*signal*/) {
  const int saved = errno;
  [[maybe_unused]] const auto written = write(signal_pipe[1], &kSignal, 1);
  errno = saved;
}

constexpr std::array<int, 2> kSignals = {SIGINT, SIGTERM};

std::mutex coming_and_going;

}  // namespace

/// Catches signals from its construction to its end.
class Interrupt::Watch {
 public:
  Watch() {
    if (pipe2(signal_pipe.data(), O_CLOEXEC) != 0) std::abort();
    waiter_ = std::thread([this] {
      char what = 0;
      while (true) {
        const auto got = read(signal_pipe[0], &what, 1);
        if (got == 1 && what == kSignal) source.request_stop();
        if ((got == 1 && what == kEnd) || (got != 1 && errno != EINTR)) return;
      }
    });
    struct sigaction action {};
    action.sa_handler = armature_on_signal;
    action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
    for (const int signal : kSignals) sigaction(signal, &action, nullptr);
  }
  ~Watch() {
    struct sigaction action {};
    action.sa_handler = SIG_DFL;
    for (const int signal : kSignals) sigaction(signal, &action, nullptr);
    [[maybe_unused]] const auto written = write(signal_pipe[1], &kEnd, 1);
    waiter_.join();
    for (int& end : signal_pipe) {
      close(end);
      end = -1;
    }
  }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

  std::stop_source source;

 private:
  std::thread waiter_;
};

Interrupt::Interrupt() : source_(std::nostopstate) {
  static std::weak_ptr<Watch> running;
  const std::lock_guard lock(coming_and_going);
  watch_ = running.lock();
  if (!watch_) running = watch_ = std::make_shared<Watch>();
  source_ = watch_->source;
}

Interrupt::~Interrupt() {
  const std::lock_guard lock(coming_and_going);
  watch_.reset();
}

}  // namespace armature::tools
