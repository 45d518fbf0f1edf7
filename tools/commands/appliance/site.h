#pragma once

#include <string>

#include <Eigen/Core>

#include "tools/commands/appliance/findings.h"

namespace armature::tools {

struct SiteOptions {
  std::string source;      ///< a URI
  std::string background;  ///< where to store the empty place; empty: nowhere
  double seconds = 3;      ///< of the source's own time
};

/// The angle between two directions, 0 to 180. Between up by gravity and a floor's normal: how far the floor leans,
/// whichever way.
[[nodiscard]] float degrees_between(const Eigen::Vector3f& a, const Eigen::Vector3f& b);

/// Looks at the empty site: light, how the sensor stands, whether it sees the floor, and what the active zone should
/// be.
void look_at_site(const SiteOptions& options, Findings& findings);

}  // namespace armature::tools
