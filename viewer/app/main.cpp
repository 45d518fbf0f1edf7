#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "viewer/app/run.h"
#include "viewer/session/command.h"

namespace {

using namespace armature::viewer;

struct Options {
  std::vector<std::string> files;
  std::string script, screenshot, size, connect;
  double scale = 0;
  bool person = false, headless = false;
};

armature::sdk::Expected<void> run(const Options& arguments) {
  RunOptions options{.scale = static_cast<float>(arguments.scale), .screenshot = arguments.screenshot};
  if (!arguments.size.empty() &&
      (std::sscanf(arguments.size.c_str(), "%dx%d", &options.width, &options.height) != 2 || options.width < 16 ||
       options.height < 16 || options.width > 16384 || options.height > 16384))
    return armature::sdk::fail("--size: expected WIDTHxHEIGHT of 16 to 16384 pixels, found " + arguments.size);
  std::vector<std::string> lines;
  for (const std::string& file : arguments.files) lines.push_back("open " + as_word(file));
  if (!arguments.connect.empty()) lines.push_back("connect " + as_word(arguments.connect));
  if (arguments.person) lines.emplace_back("person");
  Session session;
  Script script(std::move(lines));
  if (!arguments.script.empty()) {
    auto read = Script::read(arguments.script);
    if (!read) return armature::sdk::fail(read.error().message);
    script.append(std::move(*read));
  }
  const bool headless = arguments.headless || !arguments.screenshot.empty();
  return headless ? run_headless(session, std::move(script), options) : run_window(session, std::move(script), options);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("armature-viewer: walk with your body, model with your hands.");
  Options arguments;
  app.add_option("FILES", arguments.files, "meshes (OFF, OBJ, PLY, STL), sphere-meshes (.ma) and hierarchies (.smh)");
  app.add_option("--script", arguments.script, "carry out the commands of this file, a line each (below)")
      ->type_name("FILE");
  app.add_option("--screenshot", arguments.screenshot, "no window: write what it would show after the script, and end")
      ->type_name("OUT.png");
  app.add_option("--size", arguments.size, "of the window or the picture [1280x800]")->type_name("WxH");
  app.add_option("--scale", arguments.scale, "pixels a unit of layout [as the display says]")
      ->check(CLI::Range(0.5, 4.0));
  app.add_option("--connect", arguments.connect, "walk by what a daemon publishes: ipc://PATH or tcp://HOST:PORT")
      ->type_name("ENDPOINT");
  app.add_flag("--person", arguments.person, "walk with a synthetic person: starts a daemon of its own");
  app.add_flag("--headless", arguments.headless, "no window: play the script and end");
  app.footer("Commands, in scripts and in the log of the window:\n" + list_of_commands() +
             "\nA line that begins with `try` may fail. # begins a comment.\n\n"
             "Examples:\n"
             "  armature-viewer creature.off\n"
             "  armature-viewer --person\n"
             "  armature-viewer creature.off --script demo.txt --screenshot demo.png --size 1280x800");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? 0 : 2;
  }
  const auto done = run(arguments);
  if (done) return 0;
  fmt::print(stderr, "armature-viewer: {}\n", done.error().message);
  return 1;
}
