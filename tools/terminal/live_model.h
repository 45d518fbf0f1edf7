#pragma once

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <armature/navproto/control_messages.h>
#include <armature/navproto/error.h>
#include <armature/navproto/feed_message.h>
#include <armature/navproto/messages.h>
#include <armature/navproto/nav_camera.h>

namespace armature::tools {

/// Everything the live view shows at one moment.
struct LiveState {
  std::string endpoint;
  std::chrono::duration<double> elapsed{0};  ///< since listening began
  bool fresh = false;                        ///< navigation came within the last quarter of a second
  std::optional<navproto::NavigationMessage> navigation;
  std::optional<navproto::SkeletonMessage> skeleton;
  std::optional<navproto::HealthMessage> health;
  std::optional<navproto::FeedMessage> feed;
  std::array<std::optional<float>, navproto::kMotionCount> alpha;  ///< dead zones by MotionId, where known
  navproto::Velocity velocity;                                     ///< zero when not fresh
  std::vector<navproto::CameraPose> path;                          ///< where the camera came along, thinned
  navproto::CameraPose camera;                                     ///< where it is
  double walked_m = 0;
  double frames_per_second = 0;              ///< of navigation messages, over the last second
  std::chrono::duration<double> latency{0};  ///< frame received by the daemon to message received here, smoothed
  navproto::Vec3 anchor{0, 0, 2.5F};         ///< what the body is drawn about: follows the user slowly
  std::optional<float> floor_height;         ///< of the feet along the user's up, counted from the camera, metres
  std::string event;                         ///< the last one's text, or why a message could not be read
};

/// Turns what a subscriber receives into what the live view shows: a camera that walks, rates, a steady point of view.
/// All times by one monotonic clock. Thread-safe: no.
class LiveModel {
 public:
  LiveModel(std::string endpoint, std::chrono::nanoseconds now);

  void take(const navproto::NavigationMessage& message, std::chrono::nanoseconds now);
  void take(const navproto::SkeletonMessage& message);
  void take(const navproto::HealthMessage& message) { state_.health = message; }
  void take(navproto::FeedMessage message) { state_.feed = std::move(message); }
  void take(const navproto::ControlSettings& settings);
  void take(const navproto::EventMessage& message) { state_.event = message.text; }
  /// A message that could not be read.
  void take(const navproto::Error& error) { state_.event = error.message; }

  /// Moves the camera with this velocity from the last call's time to now.
  void advance(const navproto::Velocity& velocity, std::chrono::nanoseconds now);

  [[nodiscard]] const LiveState& state() const noexcept { return state_; }

 private:
  LiveState state_;
  navproto::NavCamera camera_;
  std::chrono::nanoseconds start_;
  std::chrono::nanoseconds advanced_;
  std::chrono::nanoseconds arrived_{0};
  std::vector<std::chrono::nanoseconds> arrivals_;  // of the last second
};

}  // namespace armature::tools
