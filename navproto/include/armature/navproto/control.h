#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string_view>

#include <armature/navproto/control_messages.h>
#include <armature/navproto/error.h>

namespace armature::navproto {

/// Whom a ControlServer answers.
struct ControlServerOptions {
  /// Control has no passwords: it is for programs of this machine, whom the socket file's permissions let in.
  bool allow_tcp = false;
};

/// Answers ControlClients, one request at a time. Thread-safe: no. Realtime-safe: no.
class ControlServer {
 public:
  /// Carries a request out and says what holds then.
  using Handler = std::function<ControlReply(const ControlRequest&)>;

  /// Binds `control` of endpoints_of(endpoint); fails as Publisher::bind does, and for tcp unless it is allowed.
  [[nodiscard]] static Expected<ControlServer> bind(std::string_view endpoint, ControlServerOptions options = {});
  ~ControlServer();
  ControlServer(ControlServer&&) noexcept;
  ControlServer& operator=(ControlServer&&) noexcept;

  /// Waits for a request for at most `timeout`, then answers all that are there; how many. A request that cannot be
  /// decoded is answered with why, without the handler.
  int serve(const Handler& handler, std::chrono::milliseconds timeout);

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
