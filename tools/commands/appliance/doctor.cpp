#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include <armature/navproto/control.h>
#include <armature/navproto/endpoints.h>
#include <armature/navproto/feed.h>
#include <armature/navproto/publisher.h>
#include <fmt/format.h>
#include <unistd.h>

#include "firmware_host/control/usb.h"
#include "firmware_host/control/video_nodes.h"
#include "tools/commands/appliance/appliance.h"
#include "tools/commands/appliance/findings.h"
#include "tools/commands/appliance/readable.h"
#include "tools/commands/appliance/site.h"
#include "tracker/config.h"
#include "tracker/daemon/metrics.h"
#include "tracker/daemon/security.h"
#include "tracker/daemon/startup.h"
#include "tracker/installation.h"

namespace armature::tools {
namespace {

constexpr std::chrono::milliseconds kDaemonAnswers{1000};
/// As in armatured.service.
constexpr std::string_view kDaemonUser = "armature";

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

/// Says who holds a device, as far as this user sees.
void tell_holders(const std::string& what, const std::string& node, Findings& findings) {
  if (const auto busy = who_has_open(node); !busy.empty())
    findings.note("sensor", what + " is open in " + joined(busy));
  else if (::geteuid() == 0)
    findings.good("sensor", what + " is free");
  else
    findings.note("sensor", what + ": no program of yours holds it; as root (`sudo armature doctor`) all can be seen");
}

void look_at_sensors(Findings& findings) {
  const auto sensors = list_usb_sensors();
  if (!sensors) return findings.bad("usb", sensors.error().message, "is /dev/bus/usb there?");
  const auto nodes = list_depth_nodes();
  std::map<int, int> on_bus;
  int kinects = 0;
  for (const UsbSensor& sensor : *sensors) {
    kinects += sensor.uri.starts_with("freenect:") ? 1 : 0;
    ++on_bus[sensor.bus];
    const std::string what = fmt::format("{} on port {}", sensor.name, sensor.port);
    const bool by_node = sensor.uri.empty();  // a kernel driver serves it
    if (!by_node && !sensor.problem.empty()) {
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
    if (!by_node)
      tell_holders(what, fmt::format("/dev/bus/usb/{:03}/{:03}", sensor.bus, sensor.address), findings);
    else if (nodes.empty())
      findings.bad("sensor", what + " has no node in /dev/video*", "`sudo modprobe uvcvideo`, which serves it");
  }
  for (const auto& [bus, count] : on_bus) {
    if (count > 1)
      findings.bad("bandwidth", fmt::format("{} sensors share USB bus {}", count, bus),
                   "a depth stream takes most of a bus: plug them into ports of different controllers (`lsusb -t`)");
  }
  if (kinects == 0 && KinectMotor::open("0"))
    findings.bad("power", "the motor of a Kinect is there and its camera is not",
                 "plug in the Kinect's own power supply: USB alone feeds the motor board only");
  for (const VideoNode& node : nodes) {
    if (!node.problem.empty()) {
      findings.bad("permission", node.path + ": " + node.problem, "join the group 'video', or install the udev rules");
      continue;
    }
    tell_holders(fmt::format("{} ({} {})", node.path, node.name, node.format), node.path, findings);
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

/// What to do about what the daemon refuses.
const char* remedy(std::string_view refused) {
  if (refused == "source") return "`armature devices` lists what is plugged in, with its URI";
  if (refused == "endpoint") return "see publish in `armatured --print-config`";
  return "see control in `armatured --print-config`; `id -u USER` tells a user's number";
}

/// Whether a tcp endpoint can be had, with all its ports.
void look_at_ports(const std::string& endpoint, const std::optional<navproto::CurveServer>& door, Findings& findings) {
  const auto publisher = navproto::Publisher::bind(endpoint, {.curve = door});
  const auto feed = navproto::FeedPublisher::bind(endpoint, {.curve = door});
  if (publisher && feed) return findings.good("endpoint", endpoint + " can be had");
  findings.bad(
      "endpoint", publisher ? feed.error().message : publisher.error().message,
      "another program has the port or one of the three that follow (`ss -ltnp` tells which), or the address is "
      "none of this machine's (`ip address`)");
}

/// Whether the installed daemon, another user, may read what root sees.
void look_at_files(const DoctorOptions& options, const Config& config, Findings& findings) {
  std::vector<std::string> files;
  for (const std::string& file : {options.config, config.background, config.model, config.keys, config.allow}) {
    if (!file.empty()) files.push_back(file);
  }
  for (const std::string& file : unreadable_by(std::string(kDaemonUser), files))
    findings.bad("permission",
                 fmt::format("{} cannot be read by the user {}, as whom the service runs", file, kDaemonUser),
                 "`systemd-tmpfiles --create armature.conf` for what is in /etc/armature; another: "
                 "`chgrp armature FILE && chmod g+r FILE`, and its folders likewise (g+x)");
}

void look_at_configuration(const DoctorOptions& options, Findings& findings) {
  const std::string& file = options.config;
  Config config;
  if (!file.empty()) {
    auto read = load_config(file);
    if (!read)
      return findings.bad("config", read.error().message, "mend that line; `armatured --print-config` lists all keys");
    config = std::move(*read);
  }
  const auto refused = refusals(config);
  for (const Refusal& refusal : refused) {
    if (!file.empty() || refusal.what != "source")
      findings.bad(std::string(refusal.what), refusal.why.message, remedy(refusal.what));
  }
  const auto model = model_of(config);
  if (!model) {
    findings.bad("model", model.error().message, "install the package again, or name another in skeleton.model");
  } else {
    findings.good("model", (config.model.empty() ? installed_model().string() : config.model) + " is in order");
  }
  if (!file.empty() && refused.empty() && model) findings.good("config", file + " is in order");
  look_at_files(options, config, findings);
  const auto door = door_of(config);
  const bool tcp = config.endpoint.starts_with("tcp:");
  if (tcp && door && !*door) findings.note("endpoint", config.endpoint + " is insecure, as configured");
  if (const auto control = control_endpoint(config)) {
    const auto at = navproto::endpoints_of(*control);
    if (at && !navproto::may_connect(at->control))
      return findings.bad("daemon", at->control + ": permission denied: whether a daemon runs there cannot be told",
                          std::string(navproto::kHowToBeLetIn));
    // What the endpoint and the port are for is there already.
    if (const auto daemon = ask_daemon(*control)) return look_at_daemon(*daemon, options, findings);
  }
  if (tcp && door) look_at_ports(config.endpoint, *door, findings);
  constexpr std::string_view kIpc = "ipc://";
  if (config.endpoint.starts_with(kIpc) && door) {
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
