#pragma once

#include <memory>
#include <stop_token>

namespace armature::tools {

/// While one lives, the first SIGINT (Ctrl-C) or SIGTERM stops token() instead of the program, so that a long job can
/// leave its files whole; a second one kills as usual. Those that live at the same time stop together, also one that is
/// made after the signal. Thread-safe: yes.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] std::stop_token token() const noexcept { return source_.get_token(); }
  [[nodiscard]] bool requested() const noexcept { return source_.stop_requested(); }

 private:
  class Watch;
  std::shared_ptr<Watch> watch_;  // of all that live
  std::stop_source source_;
};

}  // namespace armature::tools
