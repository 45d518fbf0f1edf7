#include "tracker/daemon/startup.h"

#include <filesystem>
#include <utility>

#include "tracker/daemon/security.h"
#include "tracker/installation.h"
#include "tracker/synth/open_source.h"

namespace armature {

using namespace std::chrono_literals;

Expected<std::unique_ptr<DepthSource>> source_of(const Config& config, std::shared_ptr<Clock> clock) {
  if (config.source.empty()) return fail("no source: name one with --source URI or source.uri in the configuration");
  OpenOptions options{.pacing = config.lossless ? Pacing::Lossless : Pacing::RealTime, .wait_for_device = 0ms};
  if (clock) options.clock = std::move(clock);
  auto source = open_source(config.source, options);
  if (!source) return refuse(config, "source.uri", config.source, source.error().message);
  return source;
}

Expected<std::shared_ptr<const Forest>> model_of(const Config& config) {
  auto forest = Forest::load(config.model.empty() ? installed_model() : std::filesystem::path(config.model));
  if (forest) return std::make_shared<const Forest>(std::move(*forest));
  if (config.model.empty()) return tl::unexpected(forest.error());
  return refuse(config, "skeleton.model", config.model, forest.error().message);
}

std::vector<Refusal> refusals(const Config& config, std::string_view running_source) {
  std::vector<Refusal> all;
  const auto look = [&](std::string_view what, const auto& had) {
    if (!had) all.push_back({what, had.error()});
  };
  if (running_source.empty() || config.source != running_source) look("source", source_of(config));
  look("endpoint", door_of(config));
  look("control", control_endpoint(config));
  look("control", control_uids(config));
  return all;
}

}  // namespace armature
