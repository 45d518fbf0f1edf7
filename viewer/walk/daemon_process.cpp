#include "viewer/walk/daemon_process.h"

#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace armature::viewer {
namespace {

namespace fs = std::filesystem;

/// Runs a program with stdout and stderr going to files; its number, or -1.
pid_t spawn(const std::vector<std::string>& words, const fs::path& out, const fs::path& log) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));  // NOLINT: execv's type
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child != 0) return child;
  // Only what is safe between fork and exec.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(1);
  const int in = open("/dev/null", O_RDONLY | O_CLOEXEC);
  const int to = open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const int errors = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  dup2(in, 0);
  dup2(to, 1);
  dup2(errors, 2);
  execv(arguments.front(), arguments.data());
  _exit(127);
}

/// Where a user's settings are kept; empty for a user without a home.
fs::path kept_settings() {
  const char* config = std::getenv("XDG_CONFIG_HOME");  // NOLINT(concurrency-mt-unsafe): nobody changes it
  const char* home = std::getenv("HOME");               // NOLINT(concurrency-mt-unsafe)
  const fs::path folder = config != nullptr && *config != 0 ? fs::path(config)
                          : home != nullptr                 ? fs::path(home) / ".config"
                                                            : fs::path();
  return folder.empty() ? fs::path() : folder / "armature" / "viewer.toml";
}

/// The daemon's own copy of the settings: those that were kept, or the defaults. Whether there is one.
bool write_settings(const fs::path& program, const fs::path& copy) {
  std::error_code error;
  const fs::path kept = kept_settings();
  if (!kept.empty() && fs::copy_file(kept, copy, error)) return true;
  const pid_t child = spawn({program.string(), "--print-config"}, copy, "/dev/null");
  int status = 0;
  return child >= 0 && waitpid(child, &status, 0) == child && status == 0;
}

constexpr const char* kSettings = "settings.toml";

}  // namespace

navproto::Expected<DaemonProcess> DaemonProcess::start(const std::string& source, const fs::path& programs) {
  std::error_code error;
  const fs::path folder = programs.empty() ? fs::read_symlink("/proc/self/exe", error).parent_path() : programs;
  const fs::path program = folder / "armatured";
  if (!fs::exists(program, error))
    return navproto::fail(program.string() + ": not there; build or install it, or connect to a daemon that runs");
  std::string name = (fs::temp_directory_path(error) / "armature-viewer.XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) return navproto::fail(name + ": no folder can be made there");
  DaemonProcess daemon;
  daemon.folder_ = name;
  daemon.source_ = source;
  daemon.endpoint_ = "ipc://" + name + "/nav";
  std::vector<std::string> words = {program.string(), "--source", source, "--endpoint", daemon.endpoint_};
  const fs::path settings = daemon.folder_ / kSettings;
  if (write_settings(program, settings)) words.insert(words.end(), {"--config", settings.string()});
  daemon.process_ = spawn(words, "/dev/null", daemon.folder_ / "log");
  if (daemon.process_ < 0) return navproto::fail(program.string() + ": could not be started");
  return daemon;
}

DaemonProcess::DaemonProcess(DaemonProcess&& other) noexcept
    : process_(std::exchange(other.process_, -1)),
      endpoint_(std::move(other.endpoint_)),
      source_(std::move(other.source_)),
      folder_(std::exchange(other.folder_, {})) {}

DaemonProcess& DaemonProcess::operator=(DaemonProcess&& other) noexcept {
  std::swap(process_, other.process_);
  std::swap(endpoint_, other.endpoint_);
  std::swap(source_, other.source_);
  std::swap(folder_, other.folder_);
  return *this;
}

DaemonProcess::~DaemonProcess() {
  end();
}

navproto::Expected<fs::path> DaemonProcess::keep_settings() const {
  const fs::path kept = kept_settings();
  if (kept.empty()) return navproto::fail("there is no home to keep settings in; set HOME or XDG_CONFIG_HOME");
  std::error_code error;
  fs::create_directories(kept.parent_path(), error);
  const fs::path unfinished = kept.string() + ".part." + std::to_string(getpid());
  fs::copy_file(folder_ / kSettings, unfinished, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(unfinished, kept, error);
  if (error) {
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    return navproto::fail(kept.string() + ": cannot be written: " + error.message());
  }
  return kept;
}

bool DaemonProcess::running() {
  if (process_ < 0) return false;
  if (waitpid(process_, nullptr, WNOHANG) == 0) return true;
  process_ = -1;
  return false;
}

std::string DaemonProcess::last_words() const {
  std::ifstream log(folder_ / "log");
  std::string line, last;
  while (std::getline(log, line))
    if (!line.empty()) last = line;
  // The daemon knows its own copy of the settings; people know the file that it is a copy of.
  const std::string copy = folder_ / kSettings;
  const fs::path kept = kept_settings();
  std::error_code none;
  if (const auto at = last.find(copy); at != std::string::npos && fs::exists(kept, none))
    last.replace(at, copy.size(), kept.string());
  return last;
}

void DaemonProcess::end() {
  if (process_ >= 0) {
    kill(process_, SIGTERM);
    // It stops within a frame; whoever hangs is ended.
    for (int i = 0; i < 300 && running(); ++i) usleep(10'000);
    if (process_ >= 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
      process_ = -1;
    }
  }
  std::error_code error;
  if (!folder_.empty()) fs::remove_all(folder_, error);
  folder_.clear();
}

}  // namespace armature::viewer
