#include "firmware_host/backends/freenect.h"

namespace armature {

Expected<std::unique_ptr<DepthSource>> open_fakenect(const std::filesystem::path& directory, const OpenOptions&) {
  return fail(directory.string() + ": fakenect dumps cannot be read yet");
}

}  // namespace armature
