#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "tracker/daemon/daemon_state.h"
#include "tracker/daemon/startup.h"
#include "tracker/daemon/wire.h"

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

/// Calls `visit` with each field that changes only with a restart: source, publish, control and health.
template <class Visit>
void of_a_restart(Visit visit) {
  for (const auto field :
       {&Config::source, &Config::endpoint, &Config::keys, &Config::allow, &Config::control, &Config::control_uids})
    visit(field);
  visit(&Config::lossless);
  visit(&Config::insecure);
  visit(&Config::metrics_port);
}

}  // namespace

Expected<void> Daemon::State::reload() {
  service.reloading();
  auto taken = take_config_file();
  if (!taken) {
    metrics.reloads_refused.fetch_add(1, std::memory_order_relaxed);
    say(wire::EventKind::ConfigRejected, taken.error().message + "; the configuration stays as it is");
  }
  service.ready();
  return taken;
}

Expected<void> Daemon::State::take_config_file() {
  if (options.config_file.empty()) return fail("started without --config: there is nothing to reload");
  auto read = load_config(options.config_file);
  if (!read) return tl::unexpected(read.error());
  options.override_config(*read);
  // What would be refused at the next start is refused here.
  if (const auto refused = refusals(*read, config.source); !refused.empty()) return tl::unexpected(refused.front().why);
  if (read->model != config.model) {
    auto model = model_of(*read);
    if (!model) return tl::unexpected(model.error());
    forest = std::move(*model);
  }
  let_go();
  stop_camera(wire::StopReason::Reload);
  std::string note = options.config_file.string() + " is in force; whoever steers stands still for a new rest pose";
  bool same = true;
  of_a_restart([&](auto Config::*field) {
    same = same && *read.*field == config.*field;
    *read.*field = config.*field;
  });
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
  Config saved = config;
  // What waits for a restart is as the file has it, whatever the command line said, if one could be started with it.
  if (const auto file = load_config(options.config_file)) {
    Config at_restart = *file;
    options.override_config(at_restart);
    if (refusals(at_restart, config.source).empty())
      of_a_restart([&](auto Config::*field) { saved.*field = *file.*field; });
  }
  return write_file(options.config_file, print_config(saved));
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
