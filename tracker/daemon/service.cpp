#include "tracker/daemon/service.h"

#include <cstdint>

#include <systemd/sd-daemon.h>

namespace armature {

Service::Service() {
  std::uint64_t watchdog_us = 0;
  if (sd_watchdog_enabled(0, &watchdog_us) > 0) interval_ = std::chrono::microseconds(watchdog_us) / 4;
}

void Service::ready() {
  sd_notify(0, "READY=1");
}
void Service::reloading() {
  sd_notify(0, "RELOADING=1");
}
void Service::stopping() {
  sd_notify(0, "STOPPING=1");
}
void Service::status(const std::string& line) {
  sd_notify(0, ("STATUS=" + line).c_str());
}
void Service::cycle_done(std::chrono::nanoseconds now) {
  if (interval_.count() == 0 || now - fed_ < interval_) return;
  fed_ = now;
  sd_notify(0, "WATCHDOG=1");
}

}  // namespace armature
