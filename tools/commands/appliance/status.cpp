#include <cstdio>
#include <memory>

#include <armature/navproto/control.h>
#include <armature/navproto/endpoints.h>
#include <fmt/format.h>

#include "tools/commands/appliance/appliance.h"
#include "tools/json_lines.h"

namespace armature::tools {
namespace {

struct StatusOptions {
  std::string endpoint{navproto::kDefaultEndpoint};
  std::string request = "status";
  double timeout_s = 2;
  bool json = false;
};

Expected<void> status(const StatusOptions& options) {
  auto client = navproto::ControlClient::connect(options.endpoint);
  if (!client) return fail(client.error().message);
  navproto::ControlRequest request;
  for (const auto kind : {navproto::RequestKind::Status, navproto::RequestKind::Rerest, navproto::RequestKind::Save,
                          navproto::RequestKind::Reload}) {
    if (name(kind) == options.request) request.kind = kind;
  }
  const auto reply = client->request(request, std::chrono::milliseconds(static_cast<long>(options.timeout_s * 1000)));
  if (!reply) return fail(reply.error().message);
  if (!reply->error.empty()) return fail(options.endpoint + ": " + reply->error);
  const navproto::HealthMessage& health = reply->health;
  if (options.json) {
    return write_json_line(stdout, {{"endpoint", options.endpoint},
                                    {"version", health.version},
                                    {"uptime_s", number(health.uptime_s)},
                                    {"source", health.source},
                                    {"source_alive", health.source_alive},
                                    {"source_trouble", health.source_trouble},
                                    {"engagement", std::string(name(reply->engagement))},
                                    {"user", reply->user_id},
                                    {"frames_processed", health.frames_processed},
                                    {"frames_dropped", health.frames_dropped},
                                    {"frames_per_second", number(static_cast<double>(health.frames_per_second))},
                                    {"latency_p50_us", number(static_cast<double>(health.latency_p50_us))},
                                    {"latency_p99_us", number(static_cast<double>(health.latency_p99_us))},
                                    {"resident_bytes", health.resident_bytes}});
  }
  const auto hours = health.uptime_s / 3600;
  std::printf("%s\n",
              fmt::format("armatured {} at {}, up {:.1f} h\n"
                          "source     {}: {}\n"
                          "engagement {}{}\n"
                          "frames     {} processed, {} dropped, {:.1f} a second\n"
                          "latency    p50 {:.1f} ms, p99 {:.1f} ms\n"
                          "memory     {:.1f} MB",
                          health.version, options.endpoint, hours, health.source,
                          (health.source_alive ? "alive" : "LOST") +
                              (health.source_trouble.empty() ? "" : ": " + health.source_trouble),
                          name(reply->engagement), reply->user_id == 0 ? "" : fmt::format(" (user {})", reply->user_id),
                          health.frames_processed, health.frames_dropped, health.frames_per_second,
                          health.latency_p50_us / 1000, health.latency_p99_us / 1000,
                          static_cast<double>(health.resident_bytes) / 1e6)
                  .c_str());
  return {};
}

}  // namespace

void add_status(CLI::App& app, Run& run) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command = app.add_subcommand("status", "Ask a running daemon how it fares, or to do something");
  command->add_option("endpoint", options->endpoint, "ipc://PATH whose PATH.control is the daemon's control socket")
      ->capture_default_str();
  command
      ->add_option("--request", options->request,
                   "status; rerest (take the rest pose anew), reload or save (the configuration): root's and the "
                   "daemon's own user's")
      ->check(CLI::IsMember({"status", "rerest", "save", "reload"}))
      ->capture_default_str();
  command->add_option("--timeout", options->timeout_s, "Seconds to wait for an answer")
      ->check(CLI::Range(0.01, 600.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "One JSON object");
  command->footer("Example:\n  armature status --json | jq .source_alive");
  command->callback([options, &run] { run = [options] { return status(*options); }; });
}

}  // namespace armature::tools
