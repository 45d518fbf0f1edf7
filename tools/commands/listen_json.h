#pragma once

#include <armature/navproto/messages.h>

#include "tools/json_lines.h"

namespace armature::tools {

// What `armature listen --json` prints for each message: "type" first, then the message's fields as the schema names
// them. Metres, radians, seconds; times in nanoseconds; every number finite.

[[nodiscard]] Json to_json(const navproto::NavigationMessage& message);
[[nodiscard]] Json to_json(const navproto::SkeletonMessage& message);
[[nodiscard]] Json to_json(const navproto::EventMessage& message);
[[nodiscard]] Json to_json(const navproto::HealthMessage& message);

}  // namespace armature::tools
