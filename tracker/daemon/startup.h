#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include "firmware_host/clock.h"
#include "firmware_host/depth_source.h"
#include "tracker/config.h"
#include "tracker/forest/forest.h"

// What a daemon takes from its configuration when it starts. Whatever else accepts a configuration (a reload, the
// doctor) asks here whether one would start with it. Errors name file, line and key.

namespace armature {

/// The source that it names, opened as the daemon reads it: a device is not touched before the first frame is asked
/// for.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> source_of(const Config& config, std::shared_ptr<Clock> clock = {});

/// The forest that it names, or the installed one.
[[nodiscard]] Expected<std::shared_ptr<const Forest>> model_of(const Config& config);

/// Why a daemon would not start.
struct Refusal {
  std::string_view what;  ///< "source", "endpoint" or "control"
  Error why;
};

/// All that would keep a daemon from starting with this configuration, but for its model and for what only trying tells
/// (whether a port is free, which device a URI names behind its scheme). The source is not looked at where it is
/// `running_source`.
[[nodiscard]] std::vector<Refusal> refusals(const Config& config, std::string_view running_source = {});

}  // namespace armature
