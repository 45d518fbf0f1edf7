#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <numbers>

#include <fmt/format.h>
#include <unistd.h>

#include "firmware_host/control/usb.h"
#include "firmware_host/control/video_nodes.h"
#include "tools/commands/appliance/appliance.h"
#include "tools/interrupt.h"
#include "tools/json_lines.h"
#include "tools/progress.h"
#include "tracker/config.h"
#include "tracker/daemon/metrics.h"
#include "tracker/daemon/security.h"
#include "tracker/installation.h"
#include "tracker/synth/open_source.h"

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

struct DoctorOptions {
  std::string config, site;
  double seconds = 3;
  bool json = false;
};

/// What was found, line by line.
class Findings {
 public:
  explicit Findings(bool json) : json_(json) {}
  void good(const std::string& what, const std::string& found) { say("ok", what, found, ""); }
  void note(const std::string& what, const std::string& found) { say("note", what, found, ""); }
  void bad(const std::string& what, const std::string& found, const std::string& remedy) {
    ++problems_;
    say("problem", what, found, remedy);
  }
  [[nodiscard]] int problems() const noexcept { return problems_; }

 private:
  void say(const char* kind, const std::string& what, const std::string& found, const std::string& remedy) const {
    if (json_) {
      (void)write_json_line(stdout, {{"kind", kind}, {"what", what}, {"found", found}, {"remedy", remedy}});
      return;
    }
    std::printf("%-8s %-12s %s%s%s\n", kind, what.c_str(), found.c_str(), remedy.empty() ? "" : "\n         -> ",
                remedy.c_str());
  }
  bool json_;
  int problems_ = 0;
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
  if (kinects == 0 && KinectMotor::open(0))
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

void look_at_configuration(const std::string& file, Findings& findings) {
  Config config;
  if (!file.empty()) {
    auto read = load_config(file);
    if (!read)
      return findings.bad("config", read.error().message, "mend that line; `armatured --print-config` lists all keys");
    findings.good("config", file + " is in order");
    config = std::move(*read);
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
  constexpr std::string_view kIpc = "ipc://";
  if (config.endpoint.starts_with(kIpc)) {
    const auto folder = std::filesystem::path(config.endpoint.substr(kIpc.size())).parent_path();
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
      findings.bad("endpoint", folder.string() + " cannot be written by this user",
                   "systemd makes it for the service; by hand: another endpoint, or `mkdir` it");
    } else {
      findings.good("endpoint", config.endpoint + " can be had");
    }
  }
  if (config.metrics_port != 0) {
    if (const auto server = MetricsServer::start(config.metrics_port, [] { return std::string(); }); !server) {
      findings.bad("port", server.error().message, "or is the daemon running? then all is well");
    } else {
      findings.good("port", fmt::format("127.0.0.1:{} is free", config.metrics_port));
    }
  }
}

/// Looks at the empty site: how the sensor stands and what the active zone should be.
void look_at_site(const DoctorOptions& options, Findings& findings) {
  auto source = open_source(options.site);
  if (!source) return findings.bad("site", source.error().message, "`armature devices` lists what is plugged in");
  const Interrupt interrupt;
  Segmenter segmenter(SegmentationOptions{.far_m = 9, .half_width_m = 6});
  DepthFrame frame;
  std::chrono::nanoseconds first{-1};
  FloorPlane floor;
  int frames = 0, with_floor = 0, with_people = 0;
  double seen_share = 0;
  while (!interrupt.requested()) {
    const auto status = (*source)->read(frame, 500ms);
    if (!status) return findings.bad("site", status.error().message, "see above");
    if (*status == ReadStatus::EndOfStream) break;
    if (*status == ReadStatus::Timeout) {
      if (frames == 0) continue;
      break;
    }
    if (first.count() < 0) first = frame.sensor.time;
    if (std::chrono::duration<double>(frame.sensor.time - first).count() > options.seconds) break;
    const Segmentation& seen = segmenter.process(frame.view());
    if (seen.floor) floor = *seen.floor;
    ++frames;
    with_floor += seen.floor ? 1 : 0;
    with_people += seen.users.empty() ? 0 : 1;
    const auto known = std::count_if(frame.depth_mm.begin(), frame.depth_mm.end(), [](auto d) { return d != 0; });
    seen_share += static_cast<double>(known) / static_cast<double>(frame.depth_mm.size());
  }
  if (frames == 0) return findings.bad("site", options.site + ": not a single frame", "see the sensor above");
  seen_share /= frames;
  if (seen_share < 0.3)
    findings.bad("light", fmt::format("{:.0f} % of the image has depth", seen_share * 100),
                 "direct sunlight, glass or black surfaces: turn the sensor or shade it");
  else
    findings.good("light", fmt::format("{:.0f} % of the image has depth", seen_share * 100));
  if (with_people > frames / 4)
    findings.note("people", "somebody is in view: for commissioning the place should be empty");
  if (with_floor < std::max(1, frames / 2)) {
    return findings.bad("floor", fmt::format("seen in {} of {} frames", with_floor, frames),
                        "tilt the sensor down until the floor two metres before it is in view");
  }
  const Eigen::Vector3f up = floor.normal;
  const float degrees = 180 / std::numbers::pi_v<float>;
  const float tilt = std::asin(std::clamp(-up.z(), -1.0F, 1.0F)) * degrees;
  const float roll = std::atan2(up.x(), -up.y()) * degrees;
  const std::string stands =
      fmt::format("{:.2f} m above the floor, looks down by {:.0f} degrees, rolled by {:.0f}", floor.offset, tilt, roll);
  if (std::abs(roll) > 5)
    findings.bad("stand", stands, "level it: roll should be within 5 degrees");
  else if (floor.offset < 0.4F || floor.offset > 2.6F || std::abs(tilt) > 40)
    findings.bad("stand", stands, "0.6 to 2.2 m high and tilted by at most 30 degrees see people best");
  else
    findings.good("stand", stands);
  // How far the floor is free: the nearest thing above it within a metre of the middle.
  const Intrinsics& k = frame.intrinsics;
  float free_to = 9;
  const Eigen::Vector3f ahead = (Eigen::Vector3f::UnitZ() - up.z() * up).normalized();
  const Eigen::Vector3f right(ahead.y() * up.z() - ahead.z() * up.y(), ahead.z() * up.x() - ahead.x() * up.z(),
                              ahead.x() * up.y() - ahead.y() * up.x());
  std::array<int, 90> standing{};  // cells of 10 cm
  for (int v = 0; v < k.height; v += 4) {
    for (int u = 0; u < k.width; u += 4) {
      const float z = static_cast<float>(frame.view().at(u, v)) / 1000;
      if (z <= 0) continue;
      const Eigen::Vector3f p(z * static_cast<float>((u - k.centre_x_px) / k.focal_x_px),
                              z * static_cast<float>((v - k.centre_y_px) / k.focal_y_px), z);
      const float above = up.dot(p) + floor.offset, away = ahead.dot(p);
      if (above > 0.25F && above < 2 && std::abs(right.dot(p)) < 0.8F && away > 0 && away < 9)
        ++standing[static_cast<std::size_t>(away * 10)];
    }
  }
  for (std::size_t cell = 0; cell < standing.size(); ++cell) {
    if (standing[cell] > 30) {
      free_to = static_cast<float>(cell) / 10;
      break;
    }
  }
  const float far = std::min(4.0F, free_to - 0.3F);
  if (far < 1.5F) {
    return findings.bad("zone", fmt::format("something stands {:.1f} m before the sensor", free_to),
                        "clear the floor between 1.2 and 3 m before it, or move it");
  }
  findings.good("zone",
                fmt::format("free to {:.1f} m; in the configuration: [engagement] near_m = 1.2, far_m = {:.1f}, "
                            "half_width_m = 0.8",
                            free_to, far));
  if (const auto motor = KinectMotor::open(0)) {
    if (const auto posture = (*motor)->posture()) {
      const auto& g = posture->up_m_s2;
      const double by_gravity = std::atan2(-g[2], -g[1]) * 180 / std::numbers::pi;
      findings.note("gravity", fmt::format("the accelerometer says {:.0f} degrees down", by_gravity));
    }
  }
}

Expected<void> examine(const DoctorOptions& options) {
  Findings findings(options.json);
  look_at_sensors(findings);
  look_at_configuration(options.config, findings);
  if (!options.site.empty()) look_at_site(options, findings);
  if (findings.problems() > 0)
    return fail(fmt::format("{} problems; each line above has its remedy", findings.problems()));
  return {};
}

}  // namespace

void add_doctor(CLI::App& app, Run& run) {
  auto options = std::make_shared<DoctorOptions>();
  CLI::App* command = app.add_subcommand(
      "doctor", "Find what is wrong: permissions, busy devices, USB bandwidth and power, configuration, model, ports");
  command->add_option("--config", options->config, "The daemon's TOML file")->type_name("FILE");
  command
      ->add_option("--site", options->site,
                   "Commission a site: look at the empty place through this source and say how the sensor stands, "
                   "whether it sees the floor, and what the active zone should be")
      ->type_name("URI");
  command->add_option("--seconds", options->seconds, "How long to look at the site")
      ->check(CLI::Range(0.5, 60.0))
      ->capture_default_str();
  command->add_flag("--json", options->json, "One JSON object a finding");
  command->footer(
      "Exits 1 when there is a problem.\n\nExample:\n  armature doctor --config /etc/armature/armatured.toml --site "
      "freenect:0");
  command->callback([options, &run] { run = [options] { return examine(*options); }; });
}

}  // namespace armature::tools
