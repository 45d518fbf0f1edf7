#pragma once

#include <chrono>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <armature/navproto/control_messages.h>
#include <armature/navproto/messages.h>
#include <armature/navproto/nav_camera.h>
#include <armature/sdk/error.h>

#include "viewer/scene/camera.h"
#include "viewer/walk/city.h"
#include "viewer/walk/daemon_link.h"
#include "viewer/walk/daemon_process.h"
#include "viewer/walk/path_task.h"

namespace armature::viewer {

/// A walk through the city: by the body, as a daemon publishes it, and by hand. Used by one thread.
class Walk {
 public:
  using Time = std::chrono::nanoseconds;
  static constexpr double kEyeHeight = 1.65;  ///< metres above the ground

  Walk() = default;

  ///@{
  /// To whom it listens. `connect` ends a daemon of our own. `curve`: who we are, to a daemon over tcp that asks.
  [[nodiscard]] sdk::Expected<void> connect(const std::string& endpoint,
                                            std::optional<navproto::CurveClient> curve = {});
  /// Starts a daemon of our own on a source, a synthetic person for instance, and listens to it. It is started again
  /// when its source ends, with the settings that held.
  [[nodiscard]] sdk::Expected<void> start_daemon(const std::string& source);
  void disconnect();
  ///@}
  /// Where `start_daemon` looks for programs; beside this one if empty.
  std::filesystem::path programs;

  /// Moves by what has come and by the hands, from the last call's time to now.
  void update(Time now);
  /// Sends a change of settings, a save, ...; what becomes of it comes with `take_message()`.
  [[nodiscard]] sdk::Expected<void> request(navproto::ControlRequest request);
  /// What the user is to be told, once each.
  [[nodiscard]] std::optional<std::string> take_message(bool& is_error);

  /// Puts the camera somewhere.
  void place(const navproto::CameraPose& pose) { camera_ = navproto::NavCamera(pose); }
  /// Begins to follow the city's path, at its start.
  void start_path();
  void stop_path() { task_.reset(); }

  [[nodiscard]] bool connected() const noexcept { return link_ != nullptr; }
  [[nodiscard]] std::string endpoint() const { return link_ ? link_->endpoint() : std::string(); }
  [[nodiscard]] bool owns_daemon() const noexcept { return daemon_.has_value(); }
  /// How often the source of a daemon of our own has ended.
  [[nodiscard]] int rounds() const noexcept { return rounds_; }
  /// Whether the stream is alive.
  [[nodiscard]] bool fresh() const noexcept { return fresh_; }
  [[nodiscard]] const std::optional<navproto::NavigationMessage>& navigation() const noexcept { return navigation_; }
  [[nodiscard]] const std::optional<navproto::SkeletonMessage>& skeleton() const noexcept { return skeleton_; }
  [[nodiscard]] const std::optional<navproto::HealthMessage>& health() const noexcept { return health_; }
  [[nodiscard]] const std::shared_ptr<const navproto::FeedMessage>& feed() const noexcept { return feed_; }
  [[nodiscard]] const std::optional<navproto::ControlSettings>& settings() const noexcept { return settings_; }
  /// Of the body; zero when nothing fresh comes.
  [[nodiscard]] const navproto::Velocity& velocity() const noexcept { return velocity_; }
  [[nodiscard]] const navproto::CameraPose& pose() const noexcept { return camera_.pose(); }
  [[nodiscard]] double walked_m() const noexcept { return walked_m_; }
  [[nodiscard]] const std::optional<PathTask>& task() const noexcept { return task_; }
  [[nodiscard]] const City& city() const;
  /// Who steers and why it stopped, in plain words.
  [[nodiscard]] std::string state_in_words() const;
  /// What the person sees, in the city's frame.
  [[nodiscard]] Camera camera(double aspect) const;

 private:
  void hear();
  void tell(std::string message, bool is_error);
  void take_answers();
  void look_after_daemon();

  mutable std::optional<City> city_;        // made when first looked at
  std::vector<std::future<void>> endings_;  // of those that were left: they may take seconds
  std::optional<DaemonProcess> daemon_;
  std::unique_ptr<DaemonLink> link_;  // goes before the daemon
  int rounds_ = 0;
  bool fresh_ = false;
  std::optional<navproto::NavigationMessage> navigation_;
  std::optional<navproto::SkeletonMessage> skeleton_;
  std::shared_ptr<const navproto::FeedMessage> feed_;  // or none
  std::optional<navproto::HealthMessage> health_;
  std::optional<navproto::ControlSettings> settings_;
  navproto::Velocity velocity_;
  navproto::NavCamera camera_;
  double walked_m_ = 0;
  std::optional<PathTask> task_;
  std::optional<Time> advanced_, heard_;  // the last step; the last message
  Time daemon_checked_{0};
  std::string message_, error_;  // to be told; the stream's last
  bool message_is_error_ = false;
};

}  // namespace armature::viewer
