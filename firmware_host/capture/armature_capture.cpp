#include <cstdio>

#include "firmware_host/capture/capture_process.h"

// Started by CaptureProcess, and by nobody else.
int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("armature-capture: started by armatured, for one source; nothing to start by hand\n", stderr);
    return 2;
  }
  return armature::run_capture(argv[1], armature::kFramesDescriptor, armature::kWakeDescriptor);
}
