#include "firmware_host/depth_source.h"

#include <array>

#include "firmware_host/backends/freenect.h"
#include "firmware_host/backends/freenect_device.h"
#include "firmware_host/backends/openni2.h"
#include "firmware_host/backends/openni2_device.h"
#include "firmware_host/backends/v4l2.h"
#include "firmware_host/capture/capture_process.h"

namespace armature {
namespace {

using Source = std::unique_ptr<DepthSource>;
struct Scheme {
  std::string_view name;
  bool device = false;
  bool needs_rest = true;
  Expected<Source> (*open)(std::string_view rest, const OpenOptions& options) = nullptr;
};

constexpr std::array<Scheme, 5> kSchemes = {{
    {"oni", false, true, [](std::string_view rest, const OpenOptions& o) { return open_oni(rest, o); }},
    {"fakenect", false, true, [](std::string_view rest, const OpenOptions& o) { return open_fakenect(rest, o); }},
    {"openni2", true, false, open_openni2_device},
    {"freenect", true, true, open_freenect_device},
    {"v4l2", true, true, open_v4l2},
}};
constexpr std::string_view kProcess = "process:";

const Scheme* scheme_of(std::string_view uri) noexcept {
  const auto colon = uri.find(':');
  for (const Scheme& scheme : kSchemes) {
    if (colon != std::string_view::npos && scheme.name == uri.substr(0, colon)) return &scheme;
  }
  return nullptr;
}

}  // namespace

bool names_device(std::string_view uri) noexcept {
  const Scheme* scheme = scheme_of(uri);
  return uri.starts_with(kProcess) || (scheme != nullptr && scheme->device);
}

Expected<Source> open_in_this_process(std::string_view uri, const OpenOptions& options) {
  const Scheme* scheme = scheme_of(uri);
  if (scheme == nullptr) {
    return fail("source '" + std::string(uri) +
                "': expected oni:FILE, fakenect:DIR, openni2:, freenect:N or v4l2:/dev/videoN");
  }
  const auto rest = uri.substr(scheme->name.size() + 1);
  if (rest.empty() && scheme->needs_rest) {
    return fail("source '" + std::string(uri) + "': expected a path after the colon");
  }
  if (rest.find('\0') != std::string_view::npos) return fail("source: expected a path without zero bytes");
  return scheme->open(rest, options);
}

Expected<Source> open_depth_source(std::string_view uri, const OpenOptions& options) {
  if (!names_device(uri)) return open_in_this_process(uri, options);
  if (uri.starts_with(kProcess)) uri.remove_prefix(kProcess.size());
  auto source = CaptureProcess::open(uri, options);
  if (!source) return tl::unexpected(source.error());
  return Source(std::move(*source));
}

}  // namespace armature
