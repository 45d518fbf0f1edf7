#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include <armature/navproto/control.h>
#include <armature/navproto/endpoints.h>
#include <fmt/format.h>
#include <unistd.h>

#include "firmware_host/control/usb.h"
#include "firmware_host/control/video_nodes.h"
#include "tools/commands/appliance/appliance.h"
#include "tools/commands/appliance/findings.h"
#include "tools/commands/appliance/site.h"
#include "tracker/config.h"
#include "tracker/daemon/metrics.h"
#include "tracker/daemon/security.h"
#include "tracker/installation.h"

namespace armature::tools {
namespace {

constexpr std::chrono::milliseconds kDaemonAnswers{1000};

struct DoctorOptions {
  std::string config;
  SiteOptions site;
  bool json = false;
};

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void look_at_sensors(Findings& findings) {
  const auto sensors = list_usb_sensors();
  if (!sensors) return findings.bad("usb", sensors.error().message, "is /dev/bus/usb there?");
  std::map<int, int> on_bus;
  int kinects = 0;
  for (const UsbSensor& sensor : *sensors) {
    kinects += sensor.uri.starts_with("freenect:") ? 1 : 0;
    ++on_bus[sensor.bus];
    const std::string what = fmt::format("{} on port {}", sensor.name, sensor.port);
    if (!sensor.problem.empty()) {
      findings.bad(
          "permission", what + ": " + sensor.problem,
          "join the group 'armature' of the package's udev rules, or without the package: copy "
          "tracker/daemon/60-armature.rules to /etc/udev/rules.d, run `udevadm control --reload`, plug it in again");
      continue;
    }
    if (sensor.speed_mbit > 0 && sensor.speed_mbit < 480) {
      findings.bad("bandwidth", fmt::format("{}: {} Mbit/s", what, sensor.speed_mbit),
                   "it needs USB 2.0 at high speed: another port, no long cable, no USB 1.1 hub");
    }
    const auto busy = who_has_open(fmt::format("/dev/bus/usb/{:03}/{:03}", sensor.bus, sensor.address));
    if (busy.empty()) {
      findings.good("sensor", what + " is free");
    } else {
      findings.note("sensor", what + " is open in " + joined(busy));
    }
  }
  for (const auto& [bus, count] : on_bus) {
    if (count > 1)
      findings.bad("bandwidth", fmt::format("{} sensors share USB bus {}", count, bus),
                   "a depth stream takes most of a bus: plug them into ports of different controllers (`lsusb -t`)");
  }
  if (kinects == 0 && KinectMotor::open("0"))
    findings.bad("power", "the motor of a Kinect is there and its camera is not",
                 "plug in the Kinect's own power supply: USB alone feeds the motor board only");
  const auto nodes = list_depth_nodes();
  for (const VideoNode& node : nodes) {
    if (!node.problem.empty()) {
      findings.bad("permission", node.path + ": " + node.problem, "join the group 'video', or install the udev rules");
      continue;
    }
    const auto busy = who_has_open(node.path);
    findings.good("sensor", fmt::format("{} ({} {}){}", node.path, node.name, node.format,
                                        busy.empty() ? " is free" : " is open in " + joined(busy)));
  }
  if (sensors->empty() && nodes.empty())
    findings.bad("sensor", "no depth sensor is plugged in",
                 "check cable, hub and power; `lsusb` lists what the kernel sees");
}

/// What the daemon at that control endpoint says of itself, where one answers.
std::optional<navproto::HealthMessage> ask_daemon(const std::string& control) {
  auto client = navproto::ControlClient::connect(control);
  if (!client) return std::nullopt;
  auto reply = client->request({}, kDaemonAnswers);
  if (!reply || !reply->error.empty()) return std::nullopt;
  return std::move(reply->health);
}

void look_at_daemon(const navproto::HealthMessage& daemon, const DoctorOptions& options, Findings& findings) {
  const std::string what = fmt::format("armatured {} reads {}", daemon.version, daemon.source);
  if (daemon.source_alive && daemon.source_trouble.empty()) {
    findings.good("daemon", fmt::format("{}, {:.1f} frames a second", what, daemon.frames_per_second));
  } else if (daemon.source_alive) {
    findings.bad("daemon", what + ", which " + daemon.source_trouble, "look at the sensor");
  } else {
    findings.bad("daemon", what + ", which is lost: " + daemon.source_trouble,
                 "see the sensors above; `journalctl -u armatured` has the story");
  }
  if (options.site.source == daemon.source)
    findings.note("daemon", "it holds the sensor that --site asks for: `systemctl stop armatured` first");
}

void look_at_configuration(const DoctorOptions& options, Findings& findings) {
  const std::string& file = options.config;
  Config config;
  if (!file.empty()) {
    auto read = load_config(file);
    if (!read)
      return findings.bad("config", read.error().message, "mend that line; `armatured --print-config` lists all keys");
    findings.good("config", file + " is in order");
    config = std::move(*read);
    if (config.source.empty())
      findings.bad("source", "source.uri names none", "`armature devices` lists what is plugged in, with its URI");
  }
  const std::filesystem::path model = config.model.empty() ? installed_model() : std::filesystem::path(config.model);
  if (const auto forest = Forest::load(model); !forest) {
    findings.bad("model", forest.error().message, "install the package again, or name another in skeleton.model");
  } else {
    findings.good("model", model.string() + " is in order");
  }
  if (const auto door = door_of(config); !door) {
    findings.bad("endpoint", door.error().message, "see publish in `armatured --print-config`");
  } else if (config.endpoint.starts_with("tcp:") && !*door) {
    findings.note("endpoint", config.endpoint + " is insecure, as configured");
  }
  const auto control = control_endpoint(config);
  if (!control) findings.bad("control", control.error().message, "see control in `armatured --print-config`");
  if (const auto uids = control_uids(config); !uids)
    findings.bad("control", uids.error().message, "`id -u USER` tells a user's number");
  if (control) {
    const auto at = navproto::endpoints_of(*control);
    if (at && !navproto::may_connect(at->control))
      return findings.bad("daemon", at->control + ": permission denied: whether a daemon runs there cannot be told",
                          std::string(navproto::kHowToBeLetIn));
    // What the endpoint and the port are for is there already.
    if (const auto daemon = ask_daemon(*control)) return look_at_daemon(*daemon, options, findings);
  }
  constexpr std::string_view kIpc = "ipc://";
  if (config.endpoint.starts_with(kIpc)) {
    auto folder = std::filesystem::path(config.endpoint.substr(kIpc.size())).parent_path();
    if (folder.empty()) folder = ".";
    if (config.endpoint == navproto::kDefaultEndpoint && ::access(folder.c_str(), F_OK) != 0) {
      findings.note("endpoint", folder.string() +
                                    " is not there: systemd makes it when it starts the service; by hand "
                                    "take another (`armatured --endpoint ipc:///tmp/nav`)");
    } else if (::access(folder.c_str(), W_OK | X_OK) != 0) {
      findings.bad("endpoint", folder.string() + " cannot be written by this user",
                   "choose another publish.endpoint, or `mkdir` it");
    } else {
      findings.good("endpoint", config.endpoint + " can be had");
    }
  }
  if (config.metrics_port != 0) {
    if (const auto server = MetricsServer::start(config.metrics_port, [] { return std::string(); }); !server) {
      findings.bad("port", server.error().message, "another program has it; `ss -ltnp` tells which");
    } else {
      findings.good("port", fmt::format("127.0.0.1:{} is free", config.metrics_port));
    }
  }
}

Expected<void> examine(const DoctorOptions& options) {
  Findings findings(options.json);
  look_at_sensors(findings);
  look_at_configuration(options, findings);
  if (!options.site.source.empty()) look_at_site(options.site, findings);
  if (findings.problems() > 0)
    return fail(fmt::format("{} problem{}, with {} above", findings.problems(), findings.problems() == 1 ? "" : "s",
                            findings.problems() == 1 ? "its remedy" : "their remedies"));
  return {};
}

}  // namespace

void add_doctor(CLI::App& app, Run& run) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor", "Find what is wrong: permissions, busy devices, USB bandwidth and power, configuration, model, ports");
  command->add_option("--config", options->config, "The daemon's TOML file")->type_name("FILE");
  CLI::Option* site =
      command
          ->add_option("--site", options->site.source,
                       "Commission a site: look at the empty place through this source and say how the sensor stands, "
                       "whether it sees the floor, and what the active zone should be")
          ->type_name("URI");
  command
      ->add_option("--background", options->site.background,
                   "With --site: store the empty place in FILE.pgm, for segmentation.background in the configuration")
      ->type_name("FILE")
      ->needs(site);
  command->add_option("--seconds", options->site.seconds, "How long to look at the site")
      ->check(CLI::Range(0.5, 60.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "One JSON object a finding");
  command->footer(
      "Exits 1 when there is a problem.\n\nExample:\n  armature doctor --config /etc/armature/daemon/armatured.toml "
      "--site freenect:0 --background /etc/armature/background.pgm");
  command->callback([options, &run] { run = [options] { return examine(*options); }; });
}

}  // namespace armature::tools
