#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <armature/navproto/error.h>
#include <sys/types.h>

#include "navproto/src/descriptor.h"
#include "navproto/src/endpoint_lock.h"
#include "navproto/src/socket.h"
#include "navproto/src/wake.h"

namespace armature::navproto {

/// How many peers a socket may have at a time, and how much each may say before it is sent away (and may come again).
struct Allowance {
  std::size_t peers = 0;
  std::size_t bytes = 0;
  bool renewed_by_answers = false;  ///< whoever has been said something may say as much again
};

/// What each subscriber may say: to come in takes 100 bytes, 700 with keys, and a subscription 10, 60 with keys.
inline constexpr Allowance kOfSubscribers{.peers = 96, .bytes = 8192};
/// What each client may say before it is answered.
inline constexpr Allowance kOfClients{.peers = 16, .bytes = 16'384, .renewed_by_answers = true};

/// Where peers come in. It listens in the place of our sockets, which are bound where nobody but it can reach them, and
/// carries what either side says to the other, on a thread of its own and without knowing what it is.
///
/// ZeroMQ alone lets one peer end the program. It keeps the parts of a message until the last one comes, whatever
/// their number (ZMQ_MAXMSGSIZE bounds a part, the high-water mark counts whole messages), and 64 bytes of memory for a
/// part of 2 on the wire; it keeps every topic that anybody subscribes to, 48 bytes a letter; and where no descriptor
/// is left its ipc listener aborts (libzmq 4.3.4). All of that is bounded by who may say how much, and goes with the
/// peer. Nor can anybody keep the others out: of a socket's places no user has more than half, or over tcp no address,
/// a quarter of those at an ipc endpoint and an eighth of the descriptors are for root and our own user, who may have
/// all, and whoever has not shaken hands (and shown a listed key, where there are keys) in 3 s is sent away.
/// Thread-safe: no. Realtime-safe: no; nothing that its thread does holds up who sends or receives.
class Entrance {
 public:
  /// Which of the sockets a local peer is for: its user, by the kernel's word, to an index.
  using Choice = std::function<std::size_t(uid_t)>;

  explicit Entrance(Allowance allowance) : allowance_(allowance) {}
  /// Lets nobody in any more and carries on what is under way, for at most 250 ms: after the sockets' context has
  /// ended, so that their last words are heard.
  ~Entrance();
  Entrance(const Entrance&) = delete;
  Entrance& operator=(const Entrance&) = delete;

  /// Listens at an endpoint nobody else listens at, ipc (of mode 0660) or tcp, on behalf of sockets that are not bound.
  /// Without a choice, and over tcp, all peers are for the first one.
  [[nodiscard]] Expected<void> open(const std::string& endpoint, std::span<Socket* const> sockets, Choice choose = {});
  [[nodiscard]] Expected<void> open(const std::string& endpoint, Socket& socket) {
    return open(endpoint, std::array{&socket});
  }

 private:
  struct Listener;
  struct Connection;
  struct End;
  /// Who a peer is, as far as the kernel knows.
  struct Guest {
    std::uint32_t from = 0;  // its user, or over tcp the address it comes from
    bool is_ours = false;    // root's, or our own user's
    std::size_t socket = 0;  // that it is for
  };
  /// What epoll tells of: a listener, an end of a connection, or neither, which is the stop.
  struct Watched {
    Listener* listener = nullptr;
    End* end = nullptr;
  };
  /// One of the two sides of a connection.
  struct End : Watched {
    Connection* connection = nullptr;
    Descriptor descriptor;
    std::vector<std::byte> pending;  // what the other end has said and this one has no room for
    std::uint32_t interest = 0;      // what epoll watches it for
  };
  struct Connection {
    Connection(Listener& through, const Guest& who, Descriptor from, Descriptor to, std::size_t bytes);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    Listener& listener;
    Guest guest;
    End peer;
    End ours;
    std::size_t bytes_left;  // that the peer may say
    bool accepted = false;   // by the socket it is for
    std::list<Connection>::iterator place;
  };
  struct Listener : Watched {
    EndpointLock lock;
    Descriptor descriptor;
    bool local = false;
    std::vector<Descriptor> sockets;  // names of theirs, as paths
    Choice choose;
    std::list<Connection> connections;
  };

  [[nodiscard]] Expected<void> start();
  void carry_until_stopped();
  void carry_last_words();
  void admit(Listener& listener);
  [[nodiscard]] bool has_place(const Listener& listener, const Guest& guest) const;
  void serve(End& end, std::uint32_t events);
  [[nodiscard]] bool carry(End& from, End& to);
  [[nodiscard]] static bool flush(End& end);
  void watch(End& end) const;
  void part(Connection& connection) const;

  Allowance allowance_;
  std::list<Listener> listeners_;
  std::vector<std::byte> buffer_;
  Watched stopped_;
  Wake stop_;
  Descriptor epoll_;
  std::thread thread_;
};

}  // namespace armature::navproto
