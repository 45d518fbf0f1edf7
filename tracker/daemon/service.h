#pragma once

#include <chrono>
#include <string>

namespace armature {

/// What systemd is told, where it started us (NOTIFY_SOCKET); nothing at all elsewhere. Thread-safe: no.
class Service {
 public:
  Service();

  void ready();
  void reloading();
  void stopping();
  /// What `systemctl status` shows.
  void status(const std::string& line);
  /// A cycle of the daemon's loop is complete. Feeds the watchdog, at most four times in its interval, and not
  /// otherwise: a loop that hangs does not feed it.
  void cycle_done(std::chrono::nanoseconds now);

 private:
  std::chrono::nanoseconds interval_{0};  // between two feedings; 0 = no watchdog
  std::chrono::nanoseconds fed_{0};
};

}  // namespace armature
