#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <pthread.h>

#include "tracker/config.h"
#include "tracker/daemon/daemon.h"
#include "tracker/daemon/logging.h"

namespace {

using namespace armature;

struct CommandLine {
  std::string config_file, source, endpoint, model, rest;
  bool lossless = false;
  bool print_config = false;
  bool quiet = false;

  void apply(Config& config) const {
    const auto set = [&config](std::string& value, const char* key, const std::string& given, const char* option) {
      if (given.empty()) return;
      value = given;
      config.set_at[key] = option;
    };
    set(config.source, "source.uri", source, "--source");
    set(config.endpoint, "publish.endpoint", endpoint, "--endpoint");
    set(config.model, "skeleton.model", model, "--model");
    if (lossless) config.lossless = true;
    for (std::size_t mode = 0; mode < kRestModeNames.size(); ++mode) {
      if (rest == kRestModeNames[mode]) config.tracker.rest.mode = static_cast<RestMode>(mode);
    }
  }
};

/// SIGTERM and SIGINT stop the daemon, SIGHUP makes it read its configuration again. Signals are taken by one thread
/// that waits for them, so that no handler interrupts anything. Whoever reads the log may go (SIGPIPE): it does not end
/// us, without a zero. The capture process sets its own.
class Signals {
 public:
  Signals() {
    sigemptyset(&set_);
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set_, signal);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);  // before any other thread starts: they inherit it
    std::signal(SIGPIPE, SIG_IGN);
  }

  void watch(Daemon& daemon) {
    thread_ = std::jthread([this, &daemon](const std::stop_token& over) {
      const timespec tick{.tv_sec = 0, .tv_nsec = 100'000'000};
      while (!over.stop_requested()) {
        const int signal = sigtimedwait(&set_, nullptr, &tick);
        if (signal == SIGHUP) daemon.request_reload();
        if (signal == SIGTERM || signal == SIGINT) stop_.request_stop();
      }
    });
  }
  [[nodiscard]] std::stop_token stop() const { return stop_.get_token(); }

 private:
  sigset_t set_{};
  std::stop_source stop_;
  std::jthread thread_;
};

Expected<void> run(const CommandLine& line) {
  DaemonOptions options;
  if (!line.config_file.empty()) {
    auto config = load_config(line.config_file);
    if (!config) return tl::unexpected(config.error());
    options.config = std::move(*config);
    options.config_file = line.config_file;
  }
  options.override_config = [&line](Config& config) { line.apply(config); };
  line.apply(options.config);
  if (line.print_config) {
    std::fputs(print_config(options.config).c_str(), stdout);
    return {};
  }

  Signals signals;
  auto daemon = Daemon::create(std::move(options));
  if (!daemon) return tl::unexpected(daemon.error());
  signals.watch(**daemon);
  return (*daemon)->run(signals.stop());
}

int run_program(int argc, char** argv) {
  CLI::App app{
      "armatured: one depth sensor in, one navigation stream out.\n"
      "Sees a person, measures seven small body motions against her rest pose and publishes camera velocities.",
      "armatured"};
  app.footer(
      "Sources: openni2:, freenect:N or freenect:PORT, v4l2:/dev/videoN (`armature devices` lists them),\n"
      "oni:FILE, fakenect:DIR, synth:NAME (a synthetic person; `armature synth --list`).\n"
      "Signals: SIGTERM and SIGINT stop it with a zero published, SIGHUP reads the configuration again.\n\n"
      "Examples:\n"
      "  armatured --source oni:visitor.oni --endpoint ipc:///tmp/nav\n"
      "  armatured --print-config > kiosk.toml && armatured --config kiosk.toml --source synth:demo");
  CommandLine line;
  app.add_option("--config", line.config_file, "TOML file; what it does not name has its default")->type_name("FILE");
  app.add_option("--source", line.source, "where depth comes from")->type_name("URI");
  app.add_option("--endpoint", line.endpoint, "where velocities are published: ipc://PATH or tcp://ADDRESS:PORT")
      ->type_name("E");
  app.add_option("--model", line.model, "a forest other than the installed one")->type_name("FILE");
  app.add_option("--rest", line.rest, "where the rest pose comes from: stillness (live), auto or first (recordings)")
      ->check(CLI::IsMember({"stillness", "auto", "first"}));
  app.add_flag("--lossless", line.lossless, "read a recording frame by frame, as fast as possible, and drop none");
  app.add_flag("--quiet", line.quiet, "log nothing but failures, and that anybody may listen where that is so");
  app.add_flag("--print-config", line.print_config, "print the configuration in force, documented, and exit");
  app.set_version_flag("--version", ARMATURE_VERSION);
  try {
    app.parse(argc, argv);
    if (line.config_file.empty() && line.source.empty() && !line.print_config) {
      throw CLI::RequiredError("--config FILE or --source URI");
    }
  } catch (const CLI::Success& done) {
    return app.exit(done);
  } catch (const CLI::ParseError& wrong) {
    app.exit(wrong);
    return 2;
  }

  log_to_stderr(line.quiet);
  if (const auto result = run(line); !result) {
    log_failure(result.error().message.c_str());
    return 1;
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run_program(argc, argv);
  } catch (const std::exception& unexpected) {
    log_failure(unexpected.what());
    return 1;
  }
}
