#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "viewer/app/interrupt.h"
#include "viewer/app/run.h"
#include "viewer/session/command.h"

namespace {

using namespace armature::viewer;

struct Options {
  std::vector<std::string> files;
  std::string script, screenshot, size, connect, keys, server;
  double scale = 0;
  bool person = false, headless = false;
};

armature::sdk::Expected<void> run(const Options& arguments) {
  RunOptions options{
      .scale = static_cast<float>(arguments.scale), .files = arguments.files, .screenshot = arguments.screenshot};
  if (!arguments.size.empty()) options.size = *parse_size(arguments.size);  // it was checked
  std::vector<std::string> lines;
  if (!arguments.connect.empty()) {
    lines.push_back("connect " + as_word(arguments.connect));
    if (!arguments.keys.empty())
      lines.back() += fmt::format(" {} {}", as_word(arguments.keys), as_word(arguments.server));
  }
  if (arguments.person) lines.emplace_back("person");
  Session session;
  Script script(lines);
  if (!arguments.script.empty()) {
    auto read = Script::read(arguments.script);
    if (!read) return armature::sdk::fail(read.error().message);
    script.append(std::move(*read));
  }
  catch_interrupts();
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
      ->type_name("OUT.png")
      ->check([](const std::string& file) {
        return lower_extension(file) == ".png" ? std::string() : file + ": expected a name that ends in .png";
      });
  app.add_option("--size", arguments.size, "of the window or the picture [1280x800]")
      ->type_name("WxH")
      ->check([](const std::string& text) {
        const auto size = parse_size(text);
        return size ? std::string() : size.error().message;
      });
  app.add_option("--scale", arguments.scale, "pixels a unit of layout [as the display says]")
      ->check(CLI::Range(0.5, 4.0));
  app.add_option("--connect", arguments.connect, "walk by what a daemon publishes: ipc://PATH or tcp://HOST:PORT")
      ->type_name("ENDPOINT");
  auto* keys = app.add_option("--keys", arguments.keys, "tcp with keys: our own pair, made by `armature keys new`")
                   ->type_name("FILE");
  auto* server =
      app.add_option("--server", arguments.server, "tcp with keys: the daemon's public key")->type_name("KEY");
  keys->needs(server, "--connect");
  server->needs(keys);
  app.add_flag("--person", arguments.person, "walk with a synthetic person: starts a daemon of its own");
  app.add_flag("--headless", arguments.headless, "no window: play the script and end");
  app.set_version_flag("--version", ARMATURE_VERSION);
  app.footer(
      "Commands, in scripts and in the log of the window:\n" + list_of_commands() +
      "\nBefore its command a line may say `try`: it may fail; and `meanwhile`: it does not wait for the work of those "
      "before it. # begins a comment.\n\n"
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
