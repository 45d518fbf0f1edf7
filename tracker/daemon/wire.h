#pragma once

#include <armature/navproto/control_messages.h>
#include <armature/navproto/messages.h>

#include "firmware_host/error.h"
#include "tracker/pipeline.h"

// The one place where the tracker's types become messages.

namespace armature {

/// Fills everything but header and times.published. Realtime-safe: yes.
void fill_message(navproto::NavigationMessage& message, const TrackerOutput& output, const SteeringPair& pair) noexcept;
void fill_message(navproto::SkeletonMessage& message, const TrackerOutput& output) noexcept;

/// Zero, and why. Realtime-safe: yes.
void fill_stop(navproto::NavigationMessage& message, navproto::StopReason reason) noexcept;

[[nodiscard]] navproto::EventMessage event_message(const TrackerEvent& event, const Navigation& navigation);
[[nodiscard]] navproto::Engagement wire_engagement(EngagementState state) noexcept;
[[nodiscard]] navproto::StopReason wire_stop(StopReason reason) noexcept;

/// All settings in force.
[[nodiscard]] navproto::ControlSettings settings_of(const NavigationOptions& options);

/// `options` with what the request changes; an error where a value is out of the configuration's bounds or the pair
/// cannot be steered with, and then nothing changes.
[[nodiscard]] Expected<NavigationOptions> changed(const NavigationOptions& options,
                                                  const navproto::ControlSettings& settings);

}  // namespace armature
