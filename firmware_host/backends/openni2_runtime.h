#pragma once

#include <string>

#include "firmware_host/error.h"

namespace armature {

/// Loads OpenNI2 once for the process, silent on every stream, and never unloads it: its drivers' threads do not
/// survive that. Only the drivers beside the libOpenNI2 that the program was linked to (see firmware_host/README.md)
/// are loaded, so no USB bus is searched. Thread-safe: yes.
[[nodiscard]] Expected<void> load_openni2();

/// OpenNI2's latest complaint as one line, or `otherwise` where it has none.
[[nodiscard]] std::string openni2_complaint(const char* otherwise);

}  // namespace armature
