#include "navproto/src/endpoint_lock.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

namespace armature::navproto {
namespace {

constexpr const char* kSuffix = ".lock";

tl::unexpected<Error> in_use(const std::string& endpoint) {
  return fail(endpoint + ": already in use; stop the program that has it or choose another endpoint");
}

tl::unexpected<Error> refuse(const std::string& endpoint, int error) {
  if (error == ENOENT) {
    return fail(endpoint + ": its directory does not exist; create it or choose another endpoint");
  }
  return fail(endpoint + ": " + std::strerror(error) + "; choose an endpoint this user may create");
}

/// Whether somebody listens at the path: a program that takes no lock (an older one, or not ours).
bool somebody_listens(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return false;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (probe < 0) return false;
  const bool connected =
      ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 || errno == EAGAIN;
  ::close(probe);
  return connected;
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
  if (somebody_listens(path)) return in_use(endpoint);
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) return refuse(endpoint, errno);
  return {};
}

}  // namespace

Expected<EndpointLock> EndpointLock::take(const std::string& endpoint) {
  constexpr std::string_view kIpc = "ipc://";
  if (!endpoint.starts_with(kIpc)) return EndpointLock{};
  const std::string path = endpoint.substr(kIpc.size());
  // An abstract name has no file: the kernel itself refuses a second bind.
  if (path.starts_with('@')) return EndpointLock{};

  const std::string lock_path = path + kSuffix;
  for (;;) {
    const int descriptor = ::open(lock_path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    if (descriptor < 0) return refuse(endpoint, errno);
    EndpointLock lock(descriptor, path);
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      lock.path_.clear();  // the files are their holder's to remove
      if (errno == EWOULDBLOCK) return in_use(endpoint);
      return refuse(endpoint, errno);
    }
    // The holder before us may have removed the file between our open and our flock: then we hold a lock on nothing.
    struct stat ours {};
    struct stat named {};
    const bool same = ::fstat(descriptor, &ours) == 0 && ::stat(lock_path.c_str(), &named) == 0 &&
                      ours.st_ino == named.st_ino && ours.st_dev == named.st_dev;
    if (!same) {
      lock.path_.clear();
      continue;
    }
    if (const auto cleared = clear(endpoint, path); !cleared) {
      ::unlink(lock_path.c_str());
      lock.path_.clear();  // what stands at the path is not ours
      return tl::unexpected(cleared.error());
    }
    return lock;
  }
}

EndpointLock::~EndpointLock() {
  if (descriptor_ < 0) return;
  if (!path_.empty()) {
    // The socket's file is left behind. It is ours to remove while the lock is held, and before it goes.
    ::unlink(path_.c_str());
    ::unlink((path_ + kSuffix).c_str());
  }
  ::close(descriptor_);
}

EndpointLock::EndpointLock(EndpointLock&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}

EndpointLock& EndpointLock::operator=(EndpointLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(path_, other.path_);
  return *this;
}

}  // namespace armature::navproto
