#pragma once

#include <memory>
#include <string>

#include "tracker/config.h"

namespace armature::tools {

/// What every command that runs the tracker lets its user choose.
struct TrackerSetup {
  std::string config_file;
  std::string model;
  std::string rest = "auto";  ///< auto, first:N, or a file
};

/// The configuration with the rest mode filled in.
[[nodiscard]] Expected<Config> read_setup(const TrackerSetup& setup);

/// The forest that the configuration names, or the installed one.
[[nodiscard]] Expected<std::shared_ptr<const Forest>> load_forest(const Config& config);

}  // namespace armature::tools
