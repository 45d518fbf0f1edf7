#include "navproto/src/session.h"

#include <random>

#include <armature/navproto/publisher.h>

namespace armature::navproto {

std::chrono::nanoseconds monotonic_now() noexcept {
  return std::chrono::steady_clock::now().time_since_epoch();
}

std::uint64_t random_session_id() {
  std::random_device device;
  const std::uint64_t id = (std::uint64_t{device()} << 32U) | device();
  return id == 0 ? 1 : id;
}

}  // namespace armature::navproto
