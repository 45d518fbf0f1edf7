#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "firmware_host/control/usb.h"
#include "firmware_host/control/video_nodes.h"
#include "tools/commands/appliance/appliance.h"
#include "tools/interrupt.h"
#include "tools/json_lines.h"

namespace armature::tools {
namespace {

struct Row {
  std::string name, serial, uri, where, problem;
};

Expected<std::vector<Row>> plugged_in() {
  auto sensors = list_usb_sensors();
  if (!sensors) return tl::unexpected(sensors.error());
  std::vector<Row> rows;
  for (const UsbSensor& sensor : *sensors) {
    // What a kernel driver serves is opened by its video node, whoever may open it over USB.
    const std::string problem = sensor.uri.empty() ? "" : sensor.problem;
    rows.push_back({sensor.name, sensor.serial, sensor.uri, "usb " + sensor.port, problem});
  }
  for (const VideoNode& node : list_depth_nodes()) {
    rows.push_back({node.name.empty() ? "video device" : node.name + " " + node.format, "", "v4l2:" + node.path,
                    node.bus, node.problem});
  }
  return rows;
}

Expected<void> print(bool json) {
  const auto rows = plugged_in();
  if (!rows) return tl::unexpected(rows.error());
  if (rows->empty() && !json) std::puts("no depth sensor is plugged in; `armature doctor` looks for the reason");
  for (const Row& row : *rows) {
    if (json) {
      auto written = write_json_line(stdout, {{"name", row.name},
                                              {"serial", row.serial},
                                              {"uri", row.uri},
                                              {"where", row.where},
                                              {"problem", row.problem}});
      if (!written) return written;
      continue;
    }
    std::printf("%s\n", fmt::format("{:<28} {:<20} {:<20} {}{}", row.name, row.uri, row.serial, row.where,
                                    row.problem.empty() ? "" : "  ! " + row.problem)
                            .c_str());
  }
  return {};
}

Expected<void> watch(bool json) {
  const Interrupt interrupt;
  auto watch = UsbWatch::start([json](bool in, std::uint16_t vendor, std::uint16_t product) {
    const char* name = sensor_name(vendor, product);
    if (json) {
      (void)write_json_line(stdout, {{"name", name}, {"plugged_in", in}});
    } else {
      std::printf("%s %s\n", in ? "+" : "-", name);
    }
    std::fflush(stdout);
  });
  if (!watch) return tl::unexpected(watch.error());
  while (!interrupt.requested()) (*watch)->wait(std::chrono::milliseconds(200));
  return {};
}

}  // namespace

void add_devices(CLI::App& app, Run& run) {
  struct Options {
    bool json = false, watch = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("devices", "List the depth sensors that are plugged in: name, URI, serial, port");
  command->add_flag("--watch", options->watch, "Say who is plugged in (+) and out (-) until Ctrl-C");
  command->add_flag("--json", options->json, "One JSON object a sensor");
  command->footer(
      "The URI is what `armatured --source` and `armature record` take.\n\nExample:\n  armature devices --json");
  command->callback(
      [options, &run] { run = [options] { return options->watch ? watch(options->json) : print(options->json); }; });
}

}  // namespace armature::tools
