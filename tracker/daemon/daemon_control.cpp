#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "tracker/daemon/daemon_state.h"
#include "tracker/daemon/security.h"
#include "tracker/daemon/wire.h"
#include "tracker/installation.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// On the disk before it takes the old one's place: a power cut leaves the one or the other.
Expected<void> write_file(const std::filesystem::path& path, const std::string& text) {
  const std::string temporary = path.string() + ".new";
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  bool written = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  written = written && std::fflush(file) == 0 && ::fsync(::fileno(file)) == 0;
  if (file != nullptr && std::fclose(file) != 0) written = false;
  if (written && std::rename(temporary.c_str(), path.c_str()) == 0) return {};
  const std::string why = std::strerror(errno);
  std::remove(temporary.c_str());
  return fail(path.string() + ": cannot be written: " + why + "; the old file is as it was");
}

}  // namespace

Expected<std::shared_ptr<const Forest>> load_model(const Config& config) {
  auto forest = Forest::load(config.model.empty() ? installed_model() : std::filesystem::path(config.model));
  if (!forest) return tl::unexpected(forest.error());
  return std::make_shared<const Forest>(std::move(*forest));
}

Expected<void> Daemon::State::reload() {
  if (options.config_file.empty()) return fail("started without --config: there is nothing to reload");
  service.reloading();
  auto done = take_config_file();
  service.ready();
  return done;
}

Expected<void> Daemon::State::take_config_file() {
  auto read = load_config(options.config_file);
  // What is refused at the start is refused here: who may connect, and who may change something.
  if (read) {
    options.override_config(*read);
    const auto refuse = [&](const Error& why) { read = fail(options.config_file.string() + ": " + why.message); };
    if (const auto door = door_of(*read); !door)
      refuse(door.error());
    else if (const auto endpoint = control_endpoint(*read); !endpoint)
      refuse(endpoint.error());
    else if (const auto uids = control_uids(*read); !uids)
      refuse(uids.error());
  }
  if (!read) {
    metrics.reloads_refused.fetch_add(1, std::memory_order_relaxed);
    say(wire::EventKind::ConfigRejected, read.error().message + "; the configuration stays as it is");
    return tl::unexpected(read.error());
  }
  if (read->model != config.model) {
    auto model = load_model(*read);
    if (!model) {
      metrics.reloads_refused.fetch_add(1, std::memory_order_relaxed);
      say(wire::EventKind::ConfigRejected, model.error().message + "; the configuration stays as it is");
      return tl::unexpected(model.error());
    }
    forest = std::move(*model);
  }
  let_go();
  stop_camera(wire::StopReason::Reload);
  std::string note = options.config_file.string() + " is in force; whoever steers stands still for a new rest pose";
  const auto keep = [&](auto Config::*field) {
    const bool same = *read.*field == config.*field;
    *read.*field = config.*field;
    return same;
  };
  bool same = keep(&Config::source) & keep(&Config::lossless) & keep(&Config::endpoint) & keep(&Config::keys);
  same = same & keep(&Config::allow) & keep(&Config::insecure) & keep(&Config::control);
  same = same & keep(&Config::control_uids) & keep(&Config::metrics_port);
  if (!same) note += "; source, publish, control and health change only with a restart";
  config = std::move(*read);
  pipeline = std::make_unique<Pipeline>(forest, config.tracker, options.clock);
  pipeline->reset(capture.info().intrinsics);
  said_background_misfits = false;
  metrics.reloads.fetch_add(1, std::memory_order_relaxed);
  say(wire::EventKind::ConfigReloaded, note);
  return {};
}

Expected<void> Daemon::State::save() const {
  if (options.config_file.empty()) return fail("started without --config: there is no file to save to");
  return write_file(options.config_file, print_config(config));
}

wire::ControlReply Daemon::State::answer(const wire::ControlRequest& request) {
  Expected<void> done;
  switch (request.kind) {
    case wire::RequestKind::Status: break;
    case wire::RequestKind::Rerest:
      pipeline->capture_rest();
      rest_requested = navigation.user_id != 0;
      stop_camera(wire::StopReason::RestRequested);
      break;
    case wire::RequestKind::Set: {
      auto now = changed(pipeline->navigation_options(), request.settings);
      if (!now) {
        done = tl::unexpected(now.error());
      } else {
        pipeline->set_navigation(*now);
        config.tracker.navigation = *now;
      }
      break;
    }
    case wire::RequestKind::Save:
      done = save();
      if (done) say(wire::EventKind::ConfigSaved, options.config_file.string());
      break;
    case wire::RequestKind::Reload: done = reload(); break;
  }
  wire::ControlReply reply;
  if (!done) reply.error = done.error().message;
  reply.engagement = navigation.engagement;
  reply.user_id = navigation.user_id;
  reply.settings = settings_of(pipeline->navigation_options());
  reply.health = health();
  return reply;
}

}  // namespace armature
