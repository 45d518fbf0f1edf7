#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <armature/navproto/feed.h>
#include <armature/navproto/subscriber.h>

#include "firmware_host/error.h"

namespace armature::tools {

/// What can befall a daemon from elsewhere than its sensor, and must not be felt.
enum class Mischief : std::uint8_t {
  SubscriberFlood,  ///< eight that read nothing, and one of the feed
  BadReload,        ///< a configuration that is refused
  GoodReload,       ///< one that is taken
  HostileBytes,     ///< noise on every socket, with and without ZeroMQ's greeting
  HostileRequests,  ///< well-formed requests for what may not be
  HostileMessages,  ///< whole messages on the control channel that hold noise
  ControlFlood,     ///< more requests than anybody answers at a time, from somebody who does not listen
  FullDisk,         ///< a recording beside the daemon whose disk is full after a few frames
};
inline constexpr std::array<std::string_view, 8> kMischiefNames = {
    "subscriber_flood", "bad_reload",       "good_reload",   "hostile_bytes",
    "hostile_requests", "hostile_messages", "control_flood", "full_disk"};

/// Whoever does it to the daemon at `folder`/nav with the configuration `folder`/kiosk.toml. Thread-safe: no.
class Mischiefs {
 public:
  Mischiefs(std::filesystem::path folder, unsigned seed);
  ~Mischiefs();
  Mischiefs(const Mischiefs&) = delete;
  Mischiefs& operator=(const Mischiefs&) = delete;

  [[nodiscard]] std::string endpoint() const { return "ipc://" + nav_.string(); }
  [[nodiscard]] const std::filesystem::path& config_file() const noexcept { return config_file_; }

  /// One of them, drawn by lot and again where it cannot be had now; `request_reload` is the daemon's.
  Mischief commit(const std::function<void()>& request_reload);
  /// Everybody who still hangs on goes. A recorder may take its time: five seconds, in our time.
  void over();
  /// Recordings that filled their disk and said so.
  [[nodiscard]] std::uint64_t recordings_ended() const noexcept { return recordings_ended_; }

 private:
  void write_config(const char* max_walk) const;
  void throw_noise(const std::string& path, std::string first);
  void begin_message();
  void hang_up();
  void ask_for_what_may_not_be(int times);
  bool record_to_a_full_disk();
  [[nodiscard]] std::filesystem::path recording() const { return folder_ / "visitor.oni"; }
  void look_after_recorder();

  std::filesystem::path folder_, nav_, config_file_;
  std::mt19937_64 random_;
  std::vector<std::unique_ptr<navproto::NavSubscriber>> crowd_;
  std::optional<navproto::FeedSubscriber> feed_;
  int stranger_ = -1;    // somebody on the control channel, greeted
  std::string message_;  // what he will say next
  pid_t recorder_ = -1;
  std::chrono::steady_clock::time_point recorder_until_;
  std::uint64_t recordings_ended_ = 0;
};

}  // namespace armature::tools
