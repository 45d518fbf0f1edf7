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

/// The daemon's settings, written out where there are none; empty where that cannot be done.
fs::path settings_file(const fs::path& program, const fs::path& folder) {
  const char* config = std::getenv("XDG_CONFIG_HOME");  // NOLINT(concurrency-mt-unsafe): nobody changes it
  const char* home = std::getenv("HOME");               // NOLINT(concurrency-mt-unsafe)
  fs::path path = config != nullptr && *config != 0 ? fs::path(config)
                  : home != nullptr                 ? fs::path(home) / ".config"
                                                    : fs::path();
  if (path.empty()) return {};
  path = path / "armature" / "viewer.toml";
  std::error_code error;
  if (fs::exists(path, error)) return path;
  fs::create_directories(path.parent_path(), error);
  const fs::path written = folder / "settings.toml";
  const pid_t child = spawn({program.string(), "--print-config"}, written, "/dev/null");
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0) return {};
  fs::copy_file(written, path, error);
  return error ? fs::path() : path;
}

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
  if (const fs::path settings = settings_file(program, name); !settings.empty())
    words.insert(words.end(), {"--config", settings.string()});
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
