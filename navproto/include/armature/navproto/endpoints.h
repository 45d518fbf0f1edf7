#pragma once

#include <string>
#include <string_view>

#include <armature/navproto/error.h>

namespace armature::navproto {

/// Where the daemon publishes if nothing else is configured.
inline constexpr std::string_view kDefaultEndpoint = "ipc:///run/armature/nav";

/// The sockets of one publisher. `ipc:///run/armature/nav` has its siblings beside it (`.skeleton`, `.events`, `.feed`,
/// `.control`), `tcp://HOST:PORT` on the four ports that follow. Where the newest message counts, subscribers read all
/// that come and keep the last; ZMQ_CONFLATE, which promises that, leaks (libzmq 4.3.4).
struct Endpoints {
  std::string navigation;  ///< Navigation; the newest counts
  std::string skeleton;    ///< Skeleton; the newest counts
  std::string events;      ///< Event and Health; all count
  std::string feed;        ///< Feed; the newest counts
  std::string control;     ///< Request and Reply
};

/// The sockets beside `base`. Fails where `base` is neither `ipc://PATH` (with room for the suffixes in a socket
/// address) nor `tcp://HOST:PORT` with a port from 1 to 65531.
[[nodiscard]] Expected<Endpoints> endpoints_of(std::string_view base);

/// What whom a socket of ipc does not let in can do about it.
inline constexpr std::string_view kHowToBeLetIn =
    "ask as root, or join the group of the socket (for the installed daemon: `adduser USER armature`, then log in "
    "anew)";

/// Why nothing will ever come from a socket, a member of Endpoints: fails where this user may not connect to its path.
/// That nobody listens there is no failure, and of tcp nothing is known. Connects for a moment.
/// Thread-safe: yes. Realtime-safe: no.
[[nodiscard]] Expected<void> may_connect(std::string_view endpoint);

}  // namespace armature::navproto
