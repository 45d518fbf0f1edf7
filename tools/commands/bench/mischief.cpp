#include "tools/commands/bench/mischief.h"

#include <csignal>
#include <cstring>
#include <fstream>
#include <utility>

#include <armature/navproto/control.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

constexpr auto kRecorderPatience = 5s;
constexpr rlim_t kDiskBytes = 100'000;
constexpr int kFlood = 64;

/// ZMTP 3.0: version, no security, a client (RFC 23).
std::string greeting() {
  std::string bytes = std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x03\0", 12) + "NULL";
  bytes.resize(64);
  return bytes;
}

/// The rest of a DEALER's handshake, and the head of a message of so many bytes.
std::string message_head(std::size_t bytes) {
  const std::string ready = std::string("\x05READY\x0bSocket-Type", 18) + std::string("\0\0\0\x06", 4) + "DEALER";
  return '\x04' + (static_cast<char>(ready.size()) + ready) + '\0' + static_cast<char>(bytes);
}

/// A socket at `path`, or -1. Nothing waits for it.
int connected(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  const int peer = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (::connect(peer, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return peer;
  ::close(peer);
  return -1;
}

void say(int peer, const std::string& bytes) {
  if (peer >= 0) (void)::send(peer, bytes.data(), bytes.size(), MSG_NOSIGNAL);
}

}  // namespace

Mischiefs::Mischiefs(std::filesystem::path folder, unsigned seed)
    : folder_(std::move(folder)), nav_(folder_ / "nav"), config_file_(folder_ / "kiosk.toml"), random_(seed) {
  write_config("1.2");
}

Mischiefs::~Mischiefs() {
  recorder_until_ = {};
  message_.clear();
  hang_up();
  look_after_recorder();
}

void Mischiefs::write_config(const char* max_walk) const {
  std::ofstream(config_file_) << "[navigation]\nmax_walk_m_s = " << max_walk << "\n";
}

Mischief Mischiefs::commit(const std::function<void()>& request_reload) {
  const auto draw = [this] { return static_cast<Mischief>(random_() % kMischiefNames.size()); };
  auto which = draw();
  while (which == Mischief::FullDisk && !record_to_a_full_disk()) which = draw();
  switch (which) {
    case Mischief::SubscriberFlood:
      for (int i = 0; i < 8; ++i) crowd_.push_back(std::make_unique<navproto::NavSubscriber>(endpoint()));
      if (auto feed = navproto::FeedSubscriber::connect(endpoint())) feed_ = std::move(*feed);
      break;
    case Mischief::BadReload:
      write_config("'fast'");
      request_reload();
      break;
    case Mischief::GoodReload:
      write_config("1.2");
      request_reload();
      break;
    case Mischief::HostileBytes:
      for (const char* suffix : {"", ".skeleton", ".events", ".feed", ".control"}) {
        throw_noise(nav_.string() + suffix, random_() % 2 == 0 ? greeting() : "");
      }
      break;
    case Mischief::HostileRequests: ask_for_what_may_not_be(1); break;
    case Mischief::HostileMessages: begin_message(); break;
    case Mischief::ControlFlood: ask_for_what_may_not_be(kFlood); break;
    case Mischief::FullDisk: break;  // under way
  }
  return which;
}

void Mischiefs::over() {
  crowd_.clear();
  feed_.reset();
  hang_up();
  look_after_recorder();
}

/// Connects, says `first` and then noise, and hangs up.
void Mischiefs::throw_noise(const std::string& path, std::string first) {
  for (int i = 0; i < 256; ++i) first += static_cast<char>(random_());
  const int peer = connected(path);
  say(peer, first);
  if (peer >= 0) ::close(peer);
}

/// A message takes a handshake, which takes its time: it is said when this is over().
void Mischiefs::begin_message() {
  if (stranger_ < 0) stranger_ = connected(nav_.string() + ".control");
  say(stranger_, greeting());
  const std::size_t bytes = 1 + random_() % 120;
  message_ = message_head(bytes);
  for (std::size_t i = 0; i < bytes; ++i) message_ += static_cast<char>(random_());
}

/// Says what is left to say; the time after, hangs up.
void Mischiefs::hang_up() {
  if (stranger_ < 0) return;
  if (!message_.empty()) return say(stranger_, std::exchange(message_, {}));
  ::close(stranger_);
  stranger_ = -1;
}

/// Without waiting for the answers.
void Mischiefs::ask_for_what_may_not_be(int times) {
  auto client = navproto::ControlClient::connect(endpoint());
  navproto::ControlRequest request{.kind = navproto::RequestKind::Set};
  request.settings.max_walk_m_s = 99.0F;
  request.settings.walk_motion = navproto::MotionId::LeanBust;
  request.settings.turn_motion = navproto::MotionId::LeanBust;
  for (int i = 0; client && i < times; ++i) (void)client->request(request, i == 0 ? 1ms : 0ms);
}

/// `armature record` beside the daemon, which may write so many bytes and no more. False where the one before still
/// does: one at a time, each keeps a core busy.
bool Mischiefs::record_to_a_full_disk() {
  look_after_recorder();
  if (recorder_ > 0) return false;
  const auto out = recording();
  std::error_code ignored;
  std::filesystem::remove(out, ignored);
  const std::string feed = "feed:" + endpoint();
  recorder_ = ::fork();
  if (recorder_ == 0) {  // only what may be called between fork and exec
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit disk{kDiskBytes, kDiskBytes};
    ::setrlimit(RLIMIT_FSIZE, &disk);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::execl("/proc/self/exe", "armature", "record", feed.c_str(), out.c_str(), static_cast<char*>(nullptr));
    ::_exit(127);
  }
  recorder_until_ = std::chrono::steady_clock::now() + kRecorderPatience;
  return recorder_ > 0;
}

void Mischiefs::look_after_recorder() {
  if (recorder_ <= 0) return;
  int status = 0;
  if (::waitpid(recorder_, &status, WNOHANG) == recorder_) {
    std::error_code none;
    const auto bytes = std::filesystem::file_size(recording(), none);
    const bool disk_was_full = !none && bytes >= kDiskBytes;
    recordings_ended_ += disk_was_full && WIFEXITED(status) && WEXITSTATUS(status) == 1 ? 1 : 0;
    recorder_ = -1;
  } else if (std::chrono::steady_clock::now() >= recorder_until_) {
    ::kill(recorder_, SIGKILL);
    ::waitpid(recorder_, nullptr, 0);
    recorder_ = -1;
  }
}

}  // namespace armature::tools
