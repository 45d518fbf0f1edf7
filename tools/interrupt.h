#pragma once

#include <stop_token>
#include <thread>

namespace armature::tools {

/// While it lives, the first SIGINT (Ctrl-C) or SIGTERM stops token() instead of the program, so that a long job can
/// leave its files whole; a second one kills as usual. One at a time in a process.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] std::stop_token token() const noexcept { return source_.get_token(); }
  [[nodiscard]] bool requested() const noexcept { return source_.stop_requested(); }

 private:
  std::stop_source source_;
  std::thread waiter_;
};

}  // namespace armature::tools
