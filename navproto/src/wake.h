#pragma once

#include <cstdint>

#include <sys/eventfd.h>

#include "navproto/src/descriptor.h"

namespace armature::navproto {

/// Wakes a thread that waits in poll() or epoll; void where descriptors have run out, and then nothing may wait for it.
/// Thread-safe: yes.
class Wake {
 public:
  void wake() const noexcept {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(descriptor_.get(), &one, sizeof one);
  }
  explicit operator bool() const noexcept { return descriptor_.get() >= 0; }
  /// Readable from the first wake() on.
  [[nodiscard]] int descriptor() const noexcept { return descriptor_.get(); }

 private:
  Descriptor descriptor_{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)};
};

}  // namespace armature::navproto
