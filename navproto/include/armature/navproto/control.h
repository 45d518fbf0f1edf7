#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include <armature/navproto/control_messages.h>
#include <armature/navproto/error.h>

namespace armature::navproto {

/// Whom a ControlServer answers.
struct ControlServerOptions {
  /// Who may change something, besides root and the server's own user; anybody else who may open the socket file may
  /// ask for the status. Users are told by what the kernel says of the other end.
  std::vector<std::uint32_t> allowed_uids{};
  /// Control has no passwords: it is for programs of this machine, whom the socket file's permissions let in.
  bool allow_tcp = false;
};

/// Answers ControlClients, one request at a time. Thread-safe: no. Realtime-safe: no.
class ControlServer {
 public:
  /// Carries a request out and says what holds then.
  using Handler = std::function<ControlReply(const ControlRequest&)>;

  /// Binds `control` of endpoints_of(endpoint); fails as Publisher::bind does, and for tcp unless it is allowed. There
  /// is room for 16 clients who may change something and 16 who may only ask, half of either for one user, but all for
  /// root and the server's own.
  [[nodiscard]] static Expected<ControlServer> bind(std::string_view endpoint, ControlServerOptions options = {});
  ~ControlServer();
  ControlServer(ControlServer&&) noexcept;
  ControlServer& operator=(ControlServer&&) noexcept;

  /// Waits for a request for at most `timeout`, then answers those that are there, but no more than 16 at a time; how
  /// many. A request that cannot be decoded, or whose sender may not make it, is answered with why, without the
  /// handler.
  int serve(const Handler& handler, std::chrono::milliseconds timeout);

  /// Requests that were not carried out because of who sent them or because they could not be decoded.
  [[nodiscard]] std::uint64_t refused() const noexcept;

 private:
  struct Impl;
  explicit ControlServer(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

/// Asks a ControlServer. Thread-safe: no.
class ControlClient {
 public:
  /// Connects to `control` of endpoints_of(endpoint), whether or not somebody answers there yet; fails where the
  /// endpoint is malformed.
  [[nodiscard]] static Expected<ControlClient> connect(std::string_view endpoint);
  ~ControlClient();
  ControlClient(ControlClient&&) noexcept;
  ControlClient& operator=(ControlClient&&) noexcept;

  /// Sends the request (its id is filled in) and waits for its reply. Fails where none comes in time and where the
  /// reply cannot be decoded; a reply with an error of its own is handed out as it is.
  [[nodiscard]] Expected<ControlReply> request(ControlRequest request, std::chrono::milliseconds timeout);

 private:
  struct Impl;
  explicit ControlClient(std::unique_ptr<Impl> impl) noexcept;
  std::unique_ptr<Impl> impl_;
};

}  // namespace armature::navproto
