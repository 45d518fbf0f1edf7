#include "firmware_host/backends/openni2_runtime.h"

#include <OpenNI.h>

namespace armature {

Expected<void> load_openni2() {
  static const Expected<void> result = []() -> Expected<void> {
    openni::OpenNI::setLogConsoleOutput(false);
    openni::OpenNI::setLogFileOutput(false);
    if (openni::OpenNI::initialize() != openni::STATUS_OK)
      return fail("OpenNI2: " + openni2_complaint("cannot be initialised") +
                  ": expected its drivers in OpenNI2/Drivers beside libOpenNI2.so.0");
    // Once more: initialising reads the system's own settings.
    openni::OpenNI::setLogConsoleOutput(false);
    openni::OpenNI::setLogFileOutput(false);
    return {};
  }();
  return result;
}

std::string openni2_complaint(const char* otherwise) {
  std::string line;
  for (const char* c = openni::OpenNI::getExtendedError(); *c != '\0'; ++c)
    line += (*c == '\n' || *c == '\t') ? ' ' : *c;
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line.empty() ? otherwise : line;
}

}  // namespace armature
