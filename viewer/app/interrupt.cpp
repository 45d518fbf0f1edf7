#include "viewer/app/interrupt.h"

#include <atomic>
#include <csignal>

namespace armature::viewer {
namespace {

// A signal handler has no argument of ours, hence the mutable global.
std::atomic<bool> signalled = false;
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void armature_viewer_on_signal(int /*signal*/) {
  signalled = true;
}

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = armature_viewer_on_signal;
  action.sa_flags = static_cast<int>(SA_RESTART | SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
}

bool interrupted() noexcept {
  return signalled;
}

}  // namespace armature::viewer
