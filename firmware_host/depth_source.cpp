#include "firmware_host/depth_source.h"

#include "firmware_host/backends/freenect.h"
#include "firmware_host/backends/openni2.h"

namespace armature {

Expected<std::unique_ptr<DepthSource>> open_depth_source(std::string_view uri, const OpenOptions& options) {
  const auto colon = uri.find(':');
  const auto scheme = uri.substr(0, colon);
  const auto rest = colon == std::string_view::npos ? std::string_view{} : uri.substr(colon + 1);
  if (colon == std::string_view::npos || (scheme != "oni" && scheme != "fakenect"))
    return fail("source '" + std::string(uri) + "': expected oni:FILE or fakenect:DIR");
  if (rest.empty()) return fail("source '" + std::string(uri) + "': expected a path after the colon");
  if (rest.find('\0') != std::string_view::npos) return fail("source: expected a path without zero bytes");
  if (scheme == "oni") return open_oni(std::filesystem::path(rest), options);
  return open_fakenect(std::filesystem::path(rest), options);
}

}  // namespace armature
