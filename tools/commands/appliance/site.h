#pragma once

#include <string>

#include "tools/commands/appliance/findings.h"

namespace armature::tools {

struct SiteOptions {
  std::string source;      ///< a URI
  std::string background;  ///< where to store the empty place; empty: nowhere
  double seconds = 3;      ///< of the source's own time
};

/// Looks at the empty site: light, how the sensor stands, whether it sees the floor, and what the active zone should
/// be.
void look_at_site(const SiteOptions& options, Findings& findings);

}  // namespace armature::tools
