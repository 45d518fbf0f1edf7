#include "navproto/src/endpoint_lock.h"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "navproto/src/socket.h"
#include "navproto/src/transport.h"

namespace armature::navproto {
namespace {

constexpr const char* kSuffix = ".lock";

/// Whether somebody listens at the path: a program that takes no lock (an older one, or not ours).
bool somebody_listens(const std::string& path) {
  const Descriptor probe = stream_socket(AF_UNIX);
  const LocalAddress address(path);
  return ::connect(probe.get(), address.get(), address.size) == 0 || errno == EAGAIN;
}

/// Makes way for a bind: removes a socket nobody listens at, refuses anything else.
Expected<void> clear(const std::string& endpoint, const std::string& path) {
  struct stat status {};
  if (::lstat(path.c_str(), &status) != 0) {
    if (errno == ENOENT) return {};
    return refuse(endpoint, errno);
  }
  if (!S_ISSOCK(status.st_mode))
    return fail(endpoint + ": a file that is no socket stands there; choose another endpoint");
  if (somebody_listens(path)) return refuse(endpoint, EADDRINUSE);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return refuse(endpoint, errno);
  return {};
}

}  // namespace

Expected<EndpointLock> EndpointLock::take(const std::string& endpoint) {
  if (!endpoint.starts_with(kIpc)) return EndpointLock{};
  const std::string path = endpoint.substr(kIpc.size());
  // An abstract name has no file: the kernel itself refuses a second bind.
  if (path.starts_with('@')) return EndpointLock{};

  const std::string lock_path = path + kSuffix;
  for (;;) {
    Descriptor descriptor(::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600));
    if (!descriptor) return refuse(endpoint, errno);
    if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) != 0)
      return refuse(endpoint, errno == EWOULDBLOCK ? EADDRINUSE : errno);
    // The holder before us may have removed the file between our open and our flock: then we hold a lock on nothing.
    struct stat ours {};
    struct stat named {};
    const bool same = ::fstat(descriptor.get(), &ours) == 0 && ::stat(lock_path.c_str(), &named) == 0 &&
                      ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
    if (!same) continue;
    if (const auto cleared = clear(endpoint, path); !cleared) {
      ::unlink(lock_path.c_str());
      return tl::unexpected(cleared.error());
    }
    return EndpointLock(std::move(descriptor), path);
  }
}

EndpointLock::~EndpointLock() {
  if (!descriptor_) return;
  // The socket's file is left behind. It is ours to remove while the lock is held, and before it goes.
  ::unlink(path_.c_str());
  ::unlink((path_ + kSuffix).c_str());
}

EndpointLock& EndpointLock::operator=(EndpointLock&& other) noexcept {
  descriptor_ = std::move(other.descriptor_);
  std::swap(path_, other.path_);
  return *this;
}

}  // namespace armature::navproto
