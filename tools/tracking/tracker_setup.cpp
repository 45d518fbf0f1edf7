#include "tools/tracking/tracker_setup.h"

#include <charconv>

#include "tools/tracking/frame_json.h"
#include "tracker/installation.h"

namespace armature::tools {

Expected<Config> read_setup(const TrackerSetup& setup) {
  Config config;
  if (!setup.config_file.empty()) {
    auto read = load_config(setup.config_file);
    if (!read) return tl::unexpected(read.error());
    config = std::move(*read);
  }
  if (!setup.model.empty()) config.model = setup.model;

  RestOptions& rest = config.tracker.rest;
  constexpr std::string_view kFirst = "first:";
  if (setup.rest == "auto") {
    rest.mode = RestMode::Auto;
  } else if (setup.rest == "stillness") {
    rest.mode = RestMode::Stillness;
  } else if (setup.rest.starts_with(kFirst)) {
    rest.mode = RestMode::First;
    const char* begin = setup.rest.data() + kFirst.size();
    const char* end = setup.rest.data() + setup.rest.size();
    const auto [stop, error] = std::from_chars(begin, end, rest.first_frames);
    if (error != std::errc() || stop != end || rest.first_frames < 1 || rest.first_frames > 128) {
      return fail("--rest " + setup.rest + ": expected first:N with N from 1 to 128 frames");
    }
  } else {
    auto pose = read_rest(setup.rest);
    if (!pose) return tl::unexpected(pose.error());
    rest.mode = RestMode::Fixed;
    rest.fixed = std::move(*pose);
  }
  return config;
}

Expected<std::shared_ptr<const Forest>> load_forest(const Config& config) {
  auto forest = Forest::load(config.model.empty() ? installed_model() : std::filesystem::path(config.model));
  if (!forest) return tl::unexpected(forest.error());
  return std::make_shared<const Forest>(std::move(*forest));
}

}  // namespace armature::tools
