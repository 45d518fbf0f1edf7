#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <armature/navproto/messages.h>

namespace armature::navproto {

/// How one motion becomes a speed (sections 3.4.1 and 3.4.2): divided by its range, zero below alpha, then
/// ((x - alpha) / (1 - alpha))^beta. What is absent stays as it is.
struct MotionSetting {
  MotionId motion = MotionId::LeanBust;  ///< whose setting it is
  std::optional<float> range_rad{};      ///< the angle that means 1; (0, pi]
  std::optional<float> alpha{};          ///< [0, 1)
  std::optional<float> beta{};           ///< (0, 16]

  friend bool operator==(const MotionSetting&, const MotionSetting&) = default;
};

/// What is to change (in a request: what is absent stays) or what holds (in a reply: everything is there).
struct ControlSettings {
  std::optional<MotionId> turn_motion{};            ///< which motion drives the angular velocity
  std::optional<MotionId> walk_motion{};            ///< which motion drives the linear velocity
  std::optional<float> max_walk_m_s{};              ///< (0, 100]
  std::optional<float> max_turn_rad_s{};            ///< (0, 100]
  std::optional<float> walk_acceleration_m_s2{};    ///< (0, 100]
  std::optional<float> turn_acceleration_rad_s2{};  ///< (0, 100]
  std::vector<MotionSetting> motions{};             ///< at most one for each motion

  friend bool operator==(const ControlSettings&, const ControlSettings&) = default;
};

/// What a client wants of the daemon.
struct ControlRequest {
  std::uint64_t id = 0;                    ///< chosen by the client, repeated in the reply
  RequestKind kind = RequestKind::Status;  ///< what is to be done
  ControlSettings settings{};              ///< of Set

  friend bool operator==(const ControlRequest&, const ControlRequest&) = default;
};

/// What became of a request, and what holds now.
struct ControlReply {
  std::uint64_t id = 0;  ///< the request's
  std::string error{};   ///< empty = done; else one line that says why not, and nothing was changed
  Engagement engagement = Engagement::NoUser;  ///< of whoever steers
  std::uint32_t user_id = 0;                   ///< 0 = nobody
  ControlSettings settings{};                  ///< all of them, as they hold now
  HealthMessage health{};                      ///< as it is published

  friend bool operator==(const ControlReply&, const ControlReply&) = default;
};

}  // namespace armature::navproto
