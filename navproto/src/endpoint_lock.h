#pragma once

#include <string>
#include <utility>

#include <armature/navproto/error.h>

#include "navproto/src/descriptor.h"

namespace armature::navproto {

/// The right to bind an ipc endpoint. The file at the path of a socket outlives it, and whoever takes one away may take
/// a live program's; so a lock file beside it (`PATH.lock`, flock) says who is alive. The kernel drops the lock with
/// its process: what a killed publisher leaves is in nobody's way. Gone, it takes the socket's file and its own along.
/// Other transports need no lock and get an empty one.
class EndpointLock {
 public:
  /// Fails where a live program holds the endpoint or something other than a socket stands at its path. A dead
  /// program's socket is removed.
  [[nodiscard]] static Expected<EndpointLock> take(const std::string& endpoint);

  EndpointLock() = default;
  ~EndpointLock();
  EndpointLock(EndpointLock&& other) noexcept = default;
  EndpointLock& operator=(EndpointLock&& other) noexcept;

 private:
  EndpointLock(Descriptor descriptor, std::string path) : descriptor_(std::move(descriptor)), path_(std::move(path)) {}
  Descriptor descriptor_;
  std::string path_;  // of the socket
};

}  // namespace armature::navproto
