#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string_view>

#include <sys/socket.h>
#include <sys/un.h>

#include "navproto/src/descriptor.h"

namespace armature::navproto {

/// What the text of an endpoint begins with.
inline constexpr std::string_view kIpc = "ipc://";
inline constexpr std::string_view kTcp = "tcp://";

/// A path, of at most 107 bytes, or an abstract name, which begins with '@' and is of its own length, as the kernel
/// wants it.
struct LocalAddress {
  sockaddr_un address{};
  socklen_t size = sizeof address;
  explicit LocalAddress(std::string_view path) {
    address.sun_family = AF_UNIX;
    const std::size_t length = std::min(path.size(), sizeof address.sun_path - 1);
    std::memcpy(address.sun_path, path.data(), length);
    if (!path.starts_with('@')) return;
    address.sun_path[0] = '\0';
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + length);
  }
  [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

/// One that waits for nothing and that no program started from here has.
[[nodiscard]] inline Descriptor stream_socket(int family) {
  return Descriptor(::socket(family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

}  // namespace armature::navproto
