#pragma once

#include <filesystem>
#include <string>

#include "firmware_host/depth_source.h"
#include "firmware_host/recording/recorder.h"

namespace armature::tools {

/// What is wrong with the name of a recording to write, as CLI11's checks say it: it must end in `.oni`, which catches
/// an output that was forgotten. Empty when nothing is.
[[nodiscard]] std::string check_recording_name(const std::string& name);

struct RecordingReport {
  std::string title;  ///< of the progress bar
  bool json = false;  ///< the result as one JSON line instead of a sentence
};

/// What `record` and `import` share: writes the recording behind a progress bar, heeds Ctrl-C and prints the result.
[[nodiscard]] Expected<void> record_with_progress(DepthSource& source, const std::filesystem::path& out,
                                                  WriteRecordingOptions options, const RecordingReport& report);

}  // namespace armature::tools
