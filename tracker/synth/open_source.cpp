#include "tracker/synth/open_source.h"

#include "tracker/synth/synth_source.h"

namespace armature {

Expected<std::unique_ptr<DepthSource>> open_source(std::string_view uri, const OpenOptions& options) {
  constexpr std::string_view kScheme = "synth:";
  if (!uri.starts_with(kScheme)) return open_depth_source(uri, options);
  auto source = SynthSource::open(uri.substr(kScheme.size()), options);
  if (!source) return fail(source.error().message);
  return std::unique_ptr<DepthSource>(std::move(*source));
}

}  // namespace armature
