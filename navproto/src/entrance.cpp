#include "navproto/src/entrance.h"

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <system_error>

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/epoll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>

#include "navproto/src/transport.h"

namespace armature::navproto {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr int kBacklog = 128;
constexpr std::size_t kBufferBytes = 16'384;
constexpr milliseconds kLastWords{250};
constexpr milliseconds kShakingHands{3000};
constexpr milliseconds kUntilDescriptorsMayBeFree{10};

/// A way to something open, by which it has a short path and is found whatever its name has become.
std::string path_to(const Descriptor& descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor.get());
}

/// Binds a socket to a file that is gone before anybody could have connected to it; what is returned is its only name.
Expected<Descriptor> hide(Socket& socket, const std::string& endpoint, const std::string& folder) {
  static std::atomic<unsigned> count = 0;
  const auto cannot = [&](int error) {
    return fail(endpoint + ": peers cannot be let in by way of " + folder + ": " + zmq_strerror(error) +
                "; that takes /proc and a folder this user may write to");
  };
  const Descriptor room(::open(folder.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!room) return cannot(errno);
  const std::string file = ".armature-" + std::to_string(::getpid()) + "-" + std::to_string(++count);
  Descriptor listener = stream_socket(AF_UNIX);
  const LocalAddress address(path_to(room) + "/" + file);
  if (::bind(listener.get(), address.get(), address.size) != 0) return cannot(errno);
  Descriptor name(::openat(room.get(), file.c_str(), O_PATH | O_CLOEXEC));
  ::unlinkat(room.get(), file.c_str(), 0);
  if (!name || ::listen(listener.get(), kBacklog) != 0) return cannot(errno);
  socket.set(ZMQ_USE_FD, listener.get()).set(ZMQ_HANDSHAKE_IVL, static_cast<int>(kShakingHands.count()));
  if (zmq_bind(socket.get(), "ipc:///armature") != 0) return cannot(zmq_errno());
  (void)listener.release();  // ZeroMQ's now
  return name;
}

Expected<Descriptor> listen_local(const std::string& endpoint) {
  const std::string path = endpoint.substr(kIpc.size());
  Descriptor listener = stream_socket(AF_UNIX);
  const LocalAddress address(path);
  if (::bind(listener.get(), address.get(), address.size) != 0) return refuse(endpoint, errno);
  // Its owner and its group may connect, nobody else. (Of an abstract name there is no file.)
  if (!path.starts_with('@')) ::chmod(path.c_str(), 0660);
  if (::listen(listener.get(), kBacklog) != 0) return refuse(endpoint, errno);
  return listener;
}

Expected<Descriptor> listen_tcp(const std::string& endpoint) {
  const std::size_t colon = endpoint.rfind(':');
  const std::string host = endpoint.substr(kTcp.size(), colon - kTcp.size());
  addrinfo hints{};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE;
  addrinfo* found = nullptr;
  const int unknown = ::getaddrinfo(host == "*" ? nullptr : host.c_str(), endpoint.c_str() + colon + 1, &hints, &found);
  if (unknown != 0) return fail(endpoint + ": " + ::gai_strerror(unknown) + "; give an address of this machine, or *");
  Descriptor listener = stream_socket(AF_INET);
  const int on = 1;
  ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool bound = ::bind(listener.get(), found->ai_addr, found->ai_addrlen) == 0;
  const int error = errno;
  ::freeaddrinfo(found);
  if (!bound) return refuse(endpoint, error);
  if (::listen(listener.get(), kBacklog) != 0) return refuse(endpoint, errno);
  return listener;
}

/// Nothing waits for more to send, and a dead peer is found in seconds.
void tune_tcp(const Descriptor& peer) {
  const auto set = [&](int level, int option, int value) {
    ::setsockopt(peer.get(), level, option, &value, sizeof value);
  };
  set(IPPROTO_TCP, TCP_NODELAY, 1);
  set(SOL_SOCKET, SO_KEEPALIVE, 1);
  set(IPPROTO_TCP, TCP_KEEPIDLE, 1);
  set(IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set(IPPROTO_TCP, TCP_KEEPCNT, 3);
  set(IPPROTO_TCP, TCP_USER_TIMEOUT, 3000);
}

/// By the kernel's word; where it has none, nobody.
std::optional<uid_t> user_of(const Descriptor& peer) {
  ucred credentials{};
  socklen_t size = sizeof credentials;
  if (::getsockopt(peer.get(), SOL_SOCKET, SO_PEERCRED, &credentials, &size) != 0) return std::nullopt;
  return credentials.uid;
}

std::optional<in_addr_t> address_of(const Descriptor& peer) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  if (::getpeername(peer.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0) return std::nullopt;
  return address.sin_addr.s_addr;
}

/// Connections to sockets of ours, in the whole process, that ZeroMQ has not accepted yet: a descriptor each.
std::atomic<int> under_way = 0;

/// An eighth of the descriptors that the process may have is for everything else: ZeroMQ aborts where none is left. A
/// second one is for peers of ours.
bool leaves_descriptors(const Descriptor& newest, bool is_ours) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return true;
  const int in_use = newest.get() + under_way;
  return static_cast<rlim_t>(in_use) < limit.rlim_cur - limit.rlim_cur / (is_ours ? 8 : 4);
}

bool would_block() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

}  // namespace

Entrance::Connection::Connection(Listener& through, const Guest& who, Descriptor from, Descriptor to, std::size_t bytes)
    : listener(through), guest(who), bytes_left(bytes) {
  ++under_way;
  peer.descriptor = std::move(from);
  ours.descriptor = std::move(to);
  for (End* end : {&peer, &ours}) {
    end->end = end;
    end->connection = this;
  }
}

Entrance::Connection::~Connection() {
  if (!accepted) --under_way;
}

Entrance::~Entrance() {
  if (!thread_.joinable()) return;
  stop_.wake();
  thread_.join();
}

Expected<void> Entrance::start() {
  if (thread_.joinable()) return {};
  buffer_.resize(kBufferBytes);
  epoll_ = Descriptor(::epoll_create1(EPOLL_CLOEXEC));
  epoll_event event{.events = EPOLLIN, .data = {.ptr = &stopped_}};
  if (!epoll_ || ::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, stop_.descriptor(), &event) != 0)
    return fail("nobody can let peers in: no descriptor is left; let the process have more open files");
  try {
    thread_ = std::thread([this] { carry_until_stopped(); });
  } catch (const std::system_error& error) {
    return fail(std::string("nobody can let peers in: ") + error.what());
  }
  return {};
}

Expected<void> Entrance::open(const std::string& endpoint, std::span<Socket* const> sockets, Choice choose) {
  if (auto started = start(); !started) return started;
  const bool local = endpoint.starts_with(kIpc);
  auto lock = EndpointLock::take(endpoint);
  if (!lock) return tl::unexpected(lock.error());
  auto bound = local ? listen_local(endpoint) : listen_tcp(endpoint);
  if (!bound) return tl::unexpected(bound.error());
  std::filesystem::path folder = local ? std::filesystem::path(endpoint.substr(kIpc.size())).parent_path() : "";
  if (folder.empty()) folder = local && !endpoint.starts_with("ipc://@") ? "." : "/tmp";

  // Ours alone until it is complete.
  std::list<Listener> opened(1);
  Listener& listener = opened.front();
  listener.listener = &listener;
  listener.lock = *std::move(lock);
  listener.descriptor = *std::move(bound);
  listener.local = local;
  listener.choose = std::move(choose);
  for (Socket* socket : sockets) {
    auto name = hide(*socket, endpoint, folder);
    if (!name) return tl::unexpected(name.error());
    listener.sockets.push_back(*std::move(name));
  }
  listeners_.splice(listeners_.end(), opened);
  epoll_event event{.events = EPOLLIN, .data = {.ptr = static_cast<Watched*>(&listener)}};
  if (::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, listener.descriptor.get(), &event) != 0) return refuse(endpoint, errno);
  return {};
}

void Entrance::carry_until_stopped() {
  for (;;) {
    // One at a time: whoever is served may part with ends of which others of a batch would still tell.
    epoll_event event{};
    if (::epoll_wait(epoll_.get(), &event, 1, -1) != 1) continue;
    auto* const what = static_cast<Watched*>(event.data.ptr);
    if (what->listener != nullptr) {
      admit(*what->listener);
    } else if (what->end != nullptr) {
      serve(*what->end, event.events);
    } else {
      return carry_last_words();
    }
  }
}

void Entrance::carry_last_words() {
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, stop_.descriptor(), nullptr);
  for (Listener& listener : listeners_) ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, listener.descriptor.get(), nullptr);
  const auto all_gone = [&] {
    for (const Listener& listener : listeners_) {
      if (!listener.connections.empty()) return false;
    }
    return true;
  };
  const auto deadline = steady_clock::now() + kLastWords;
  while (!all_gone()) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - steady_clock::now());
    epoll_event event{};
    if (left.count() <= 0) return;
    if (::epoll_wait(epoll_.get(), &event, 1, static_cast<int>(left.count())) == 1)
      serve(*static_cast<Watched*>(event.data.ptr)->end, event.events);
  }
}

void Entrance::admit(Listener& listener) {
  Descriptor peer(::accept4(listener.descriptor.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!peer) {
    if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM)
      std::this_thread::sleep_for(kUntilDescriptorsMayBeFree);
    return;
  }
  const auto from = listener.local ? user_of(peer) : address_of(peer);
  if (!from) return;
  Guest guest{.from = *from};
  if (listener.local) {
    guest.is_ours = guest.from == 0 || guest.from == ::geteuid();
    if (listener.choose) guest.socket = listener.choose(guest.from);
  } else {
    tune_tcp(peer);
  }
  if (!has_place(listener, guest) || !leaves_descriptors(peer, guest.is_ours)) return;
  Descriptor ours = stream_socket(AF_UNIX);
  const LocalAddress address(path_to(listener.sockets[guest.socket]));
  if (::connect(ours.get(), address.get(), address.size) != 0) return;
  Connection& connection =
      listener.connections.emplace_back(listener, guest, std::move(peer), std::move(ours), allowance_.bytes);
  connection.place = std::prev(listener.connections.end());
  watch(connection.peer);
  watch(connection.ours);
}

bool Entrance::has_place(const Listener& listener, const Guest& guest) const {
  std::size_t taken = 0, by_them = 0;
  for (const Connection& connection : listener.connections) {
    if (connection.guest.socket != guest.socket) continue;
    ++taken;
    if (connection.guest.from == guest.from) ++by_them;
  }
  if (guest.is_ours) return taken < allowance_.peers;
  const std::size_t kept = listener.local ? allowance_.peers / 4 : 0;
  return taken < allowance_.peers - kept && by_them < allowance_.peers / 2;
}

void Entrance::serve(End& end, std::uint32_t events) {
  Connection& connection = *end.connection;
  End& other = &end == &connection.peer ? connection.ours : connection.peer;
  bool goes_on = flush(end);
  if (goes_on && other.pending.empty() && (events & ~std::uint32_t{EPOLLOUT}) != 0) goes_on = carry(end, other);
  if (!goes_on) return part(connection);
  watch(connection.peer);
  watch(connection.ours);
}

/// Hands what one end has to say to the other; false where it has gone, or has said more than it may.
bool Entrance::carry(End& from, End& to) {
  Connection& connection = *from.connection;
  const ssize_t got = ::recv(from.descriptor.get(), buffer_.data(), buffer_.size(), 0);
  if (got <= 0) return got < 0 && would_block();
  const auto bytes = std::span(buffer_).first(static_cast<std::size_t>(got));
  if (&from == &connection.peer) {
    if (bytes.size() > connection.bytes_left) return false;
    connection.bytes_left -= bytes.size();
  } else {
    if (!connection.accepted) --under_way;
    connection.accepted = true;  // ZeroMQ greets whom it accepts
    if (allowance_.renewed_by_answers) connection.bytes_left = allowance_.bytes;
  }
  to.pending.assign(bytes.begin(), bytes.end());
  return flush(to);
}

/// Sends what is pending as far as there is room; false where nobody is there any more.
bool Entrance::flush(End& end) {
  if (end.pending.empty()) return true;
  const ssize_t sent = ::send(end.descriptor.get(), end.pending.data(), end.pending.size(), MSG_NOSIGNAL);
  if (sent < 0) return would_block();
  end.pending.erase(end.pending.begin(), end.pending.begin() + sent);
  return true;
}

/// Has epoll tell of an end what can be done with it now. Of one that nothing can be done with it tells nothing, not
/// even that it has gone, which it would tell again and again.
void Entrance::watch(End& end) const {
  const Connection& connection = *end.connection;
  const End& other = &end == &connection.peer ? connection.ours : connection.peer;
  const std::uint32_t interest =
      (other.pending.empty() ? std::uint32_t{EPOLLIN} : 0U) | (end.pending.empty() ? 0U : std::uint32_t{EPOLLOUT});
  if (interest == end.interest) return;
  const int operation = end.interest == 0 ? EPOLL_CTL_ADD : interest == 0 ? EPOLL_CTL_DEL : EPOLL_CTL_MOD;
  epoll_event event{.events = interest, .data = {.ptr = static_cast<Watched*>(&end)}};
  ::epoll_ctl(epoll_.get(), operation, end.descriptor.get(), &event);
  end.interest = interest;
}

/// Ends a connection. Its ends are taken from epoll first: a process forked meanwhile may keep them open.
void Entrance::part(Connection& connection) const {
  for (const End* end : {&connection.peer, &connection.ours}) {
    if (end->interest != 0) ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, end->descriptor.get(), nullptr);
  }
  connection.listener.connections.erase(connection.place);
}

}  // namespace armature::navproto
