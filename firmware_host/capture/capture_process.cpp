#include "firmware_host/capture/capture_process.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "firmware_host/capture/recovery.h"
#include "firmware_host/capture/shared_frames.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// In which it turns the sensor's light off and goes, once it was asked to.
constexpr int kFarewell_ms = 500;

std::filesystem::path program() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  return (self.parent_path() / "../lib/armature/armature-capture").lexically_normal();
}

/// A child that is killed and waited for when its owner goes.
class Child {
 public:
  ~Child() { end(); }
  [[nodiscard]] pid_t pid() const noexcept { return pid_.load(std::memory_order_relaxed); }
  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  [[nodiscard]] bool running() const noexcept { return pid() > 0; }

  /// Fails where it cannot be started.
  Expected<void> start(const std::string& path, const std::string& uri, int frames, int wake) {
    // Copies that are neither of the numbers they become: crossed over, the first would close the second.
    constexpr int kFirstFree = std::max(kFramesDescriptor, kWakeDescriptor) + 1;
    const int frames_copy = ::fcntl(frames, F_DUPFD_CLOEXEC, kFirstFree);
    const int wake_copy = frames_copy < 0 ? -1 : ::fcntl(wake, F_DUPFD_CLOEXEC, kFirstFree);
    int error = wake_copy < 0 ? errno : 0;
    pid_t pid = -1;
    if (error == 0) error = spawn(pid, path, uri, frames_copy, wake_copy);
    for (const int copy : {frames_copy, wake_copy}) {
      if (copy >= 0) ::close(copy);
    }
    if (error != 0) return fail(path + ": cannot be started: " + std::strerror(error));
    pid_.store(pid, std::memory_order_relaxed);
    descriptor_ = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
    return {};
  }
  /// How it ended, where it has.
  bool ended(std::string& how) {
    int status = 0;
    const pid_t waited = running() ? ::waitpid(pid(), &status, WNOHANG) : 0;
    // Where SIGCHLD is ignored, as by whoever started us, nobody is told how it ended.
    const bool untold = waited < 0 && errno == ECHILD;
    if (waited <= 0 && !untold) return false;
    how = "the capture process ";
    if (untold) {
      how += "ended";
    } else if (WIFSIGNALED(status)) {
      how += std::string("died: ") + ::strsignal(WTERMSIG(status));
    } else {
      how += "ended with " + std::to_string(WEXITSTATUS(status));
      if (WEXITSTATUS(status) == kCaptureNotUnderstood) how += ": is it of another version than this program?";
    }
    forget();
    return true;
  }
  /// Waits for it to end by itself, for a moment.
  void wait() const {
    pollfd over{descriptor_, POLLIN, 0};
    if (running() && descriptor_ >= 0) (void)::poll(&over, 1, kFarewell_ms);
  }
  void end() {
    if (!running()) return;
    if (::waitpid(pid(), nullptr, WNOHANG) == 0) {  // else its number may be another's by now
      ::kill(pid(), SIGKILL);
      ::waitpid(pid(), nullptr, 0);
    }
    forget();
  }

 private:
  /// An error number, or 0.
  static int spawn(pid_t& pid, const std::string& path, const std::string& uri, int frames, int wake) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, frames, kFramesDescriptor);
    posix_spawn_file_actions_adddup2(&actions, wake, kWakeDescriptor);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    std::array<std::string, 3> words = {path, std::to_string(::getpid()), uri};
    std::array<char*, 4> arguments = {words[0].data(), words[1].data(), words[2].data(), nullptr};
    const int error = ::posix_spawn(&pid, path.c_str(), &actions, &attributes, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return error;
  }
  void forget() {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    pid_.store(-1, std::memory_order_relaxed);
  }
  std::atomic<pid_t> pid_{-1};
  int descriptor_ = -1;
};

}  // namespace

struct CaptureProcess::State {
  State(SharedFrames shared, int wake_descriptor) : frames(std::move(shared)), wake(wake_descriptor) {}
  ~State() {
    frames.command(CaptureCommand::Stop);
    child.wait();
    ::close(wake);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void supervise();
  [[nodiscard]] Reader reader() const;
  /// For how long the process has not come round its loop. Told by change alone: what it writes may be any number.
  [[nodiscard]] std::chrono::nanoseconds unheard_of(std::chrono::nanoseconds now) {
    const auto said = frames.last_alive();
    if (std::exchange(alive, said) != said) alive_at = now;
    return now - alive_at;
  }
  void wait(std::chrono::nanoseconds at_most);
  void set_trouble(std::string text) {
    const std::lock_guard lock(mutex);
    trouble = std::move(text);
  }

  SourceInfo info;
  std::shared_ptr<Clock> clock;
  SharedFrames frames;
  int wake;
  Child child;
  Recovery recovery;
  std::string path;
  bool ever_started = false;
  bool heard = false;                              // a frame, since the last step of recovery
  std::chrono::nanoseconds alive{0}, alive_at{0};  // what the process said last, and when it said something else
  mutable std::mutex mutex;
  std::string trouble;  // under the mutex; empty: all is well
  std::atomic<std::uint64_t> restarts{0}, bad_frames{0};
  std::atomic<bool> good{true};  // the frames, as far as they were judged
};

Expected<std::unique_ptr<CaptureProcess>> CaptureProcess::open(std::string_view uri, const OpenOptions& options) {
  const std::string path = program().string();
  if (::access(path.c_str(), X_OK) != 0) {
    return fail(path + ": not there: expected the capture program beside the installed libraries");
  }
  auto frames = SharedFrames::create();
  if (!frames) return tl::unexpected(frames.error());
  const int wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (wake < 0) return fail(std::string("eventfd: ") + std::strerror(errno));
  auto state = std::make_unique<State>(std::move(*frames), wake);
  state->info.uri = uri;
  state->info.live = true;
  state->clock = options.clock;
  state->path = path;
  state->trouble = std::string(uri) + ": no frame yet";
  std::unique_ptr<CaptureProcess> source(new CaptureProcess(std::move(state)));
  DepthFrame frame;
  for (const auto begin = options.clock->now(); options.wait_for_device > 0ms;) {
    const auto status = source->read(frame, 100ms);
    if (status && *status == ReadStatus::Frame) {
      source->state_->info.intrinsics = frame.intrinsics;
      source->state_->info.frames_per_second = source->state_->frames.frames_per_second();
    }
    if (status && *status != ReadStatus::Timeout) break;
    if (options.clock->now() - begin > options.wait_for_device) return fail(source->health().trouble);
  }
  return source;
}

CaptureProcess::CaptureProcess(std::unique_ptr<State> state) : state_(std::move(state)) {}
CaptureProcess::~CaptureProcess() = default;

const SourceInfo& CaptureProcess::info() const noexcept {
  return state_->info;
}

SourceHealth CaptureProcess::health() const {
  const std::lock_guard lock(state_->mutex);
  return {state_->trouble, state_->restarts.load(std::memory_order_relaxed),
          state_->bad_frames.load(std::memory_order_relaxed), state_->frames.frames_per_second()};
}

void CaptureProcess::show(StatusLight light) {
  state_->frames.show(static_cast<std::uint32_t>(light));
}

void CaptureProcess::judge(bool good) noexcept {
  state_->good.store(good, std::memory_order_relaxed);
}

pid_t CaptureProcess::process() const noexcept {
  return state_->child.pid();
}

Reader CaptureProcess::State::reader() const {
  if (!child.running()) return Reader::Gone;
  switch (frames.state()) {
    case CaptureState::Opening: return Reader::Opening;
    case CaptureState::Waiting: return Reader::Waiting;
    default: return Reader::Streaming;
  }
}

void CaptureProcess::State::supervise() {
  const auto now = clock->now();
  std::string how;
  if (child.ended(how)) {
    set_trouble(info.uri + ": " + how);
    recovery.process_ended(now);
  }
  if (const Reader at = reader(); at != Reader::Gone && recovery.hangs(unheard_of(now), at)) {
    set_trouble(info.uri + ": the capture process hangs and is started again");
    child.end();
    recovery.process_ended(now, at);
  }
  const Reader seen = reader();
  if (const std::string text = frames.trouble(); seen == Reader::Waiting && !text.empty()) set_trouble(text);
  const Recovery::Step step = recovery.step(now, seen);
  const bool bad_frames_come = step != Recovery::Step::None && std::exchange(heard, false);
  switch (step) {
    case Recovery::Step::None: return;
    case Recovery::Step::RestartStream: return frames.command(CaptureCommand::RestartStream);
    case Recovery::Step::ResetDevice: return frames.command(CaptureCommand::ResetDevice);
    case Recovery::Step::Reopen: return frames.command(CaptureCommand::Reopen);
    case Recovery::Step::RestartProcess: break;
  }
  if (seen == Reader::Streaming && !bad_frames_come)
    set_trouble(info.uri + ": no frame comes; the capture process is started again");
  child.end();
  frames.clear();
  if (ever_started) restarts.fetch_add(1, std::memory_order_relaxed);
  ever_started = true;
  if (const auto started = child.start(path, info.uri, frames.descriptor(), wake); !started)
    set_trouble(started.error().message);
  alive_at = now;
  recovery.process_started(now);
  if (!child.running()) recovery.process_ended(now);
}

void CaptureProcess::State::wait(std::chrono::nanoseconds at_most) {
  std::array<pollfd, 2> events{{{wake, POLLIN, 0}, {child.descriptor(), POLLIN, 0}}};
  const auto ms = std::chrono::ceil<std::chrono::milliseconds>(at_most).count();
  if (::poll(events.data(), child.descriptor() < 0 ? 1 : 2, static_cast<int>(ms)) > 0 && events[0].revents != 0) {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto read = ::read(wake, &count, sizeof count);
  }
}

Expected<ReadStatus> CaptureProcess::read(DepthFrame& frame, std::chrono::milliseconds timeout) {
  State& s = *state_;
  const auto until = s.clock->now() + timeout;
  for (;;) {
    s.supervise();
    switch (s.frames.read(frame)) {
      case SharedFrames::Read::Frame:
        s.heard = true;
        if (s.good.load(std::memory_order_relaxed)) s.recovery.frame(s.clock->now());
        if (s.child.running()) s.set_trouble("");  // else it is the last frame of one that ended, and why
        return ReadStatus::Frame;
      case SharedFrames::Read::Torn: s.bad_frames.fetch_add(1, std::memory_order_relaxed); continue;
      case SharedFrames::Read::Nothing: break;
    }
    if (s.child.running() && s.frames.state() == CaptureState::Ended) return ReadStatus::EndOfStream;
    const auto left = until - s.clock->now();
    if (left <= 0ns) return ReadStatus::Timeout;
    s.wait(std::min<std::chrono::nanoseconds>(left, 50ms));
  }
}

}  // namespace armature
