#include "tools/commands/bench/tracker_load.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace armature::tools {
namespace {

using namespace std::chrono_literals;

constexpr int kCrowd = 64;
constexpr std::uintmax_t kBegunBytes = 10'000;  // more than a recording's head

}  // namespace

Expected<std::unique_ptr<TrackerLoad>> TrackerLoad::start(Load load, const std::string& endpoint,
                                                          const std::filesystem::path& folder) {
  std::unique_ptr<TrackerLoad> started(new TrackerLoad);
  if (load == Load::Recording || load == Load::Both) {
    auto feed = FeedThread::start(endpoint, std::nullopt);
    if (!feed) return tl::unexpected(feed.error());
    started->feed_ = std::move(*feed);
    started->recording_ = folder / (std::string(kLoadNames[static_cast<std::size_t>(load)]) + ".oni");
    std::array<std::string, 4> words = {"armature", "record", "feed:" + endpoint, started->recording_.string()};
    std::array<char*, 5> arguments = {words[0].data(), words[1].data(), words[2].data(), words[3].data(), nullptr};
    posix_spawn_file_actions_t quietly;
    posix_spawn_file_actions_init(&quietly);
    posix_spawn_file_actions_addopen(&quietly, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addopen(&quietly, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const int error =
        ::posix_spawn(&started->recorder_, "/proc/self/exe", &quietly, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&quietly);
    if (error != 0) return fail(std::string("the recorder does not start: ") + std::strerror(error));
  }
  if (load == Load::Flood || load == Load::Both) {
    for (int i = 0; i < kCrowd; ++i) started->crowd_.push_back(std::make_unique<navproto::NavSubscriber>(endpoint));
    started->restless_ = std::jthread([endpoint](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        const navproto::NavSubscriber comes_and_goes(endpoint);
        std::this_thread::sleep_for(10ms);
      }
    });
  }
  return started;
}

TrackerLoad::~TrackerLoad() {
  if (recorder_ <= 0) return;
  ::kill(recorder_, SIGKILL);
  ::waitpid(recorder_, nullptr, 0);
}

void TrackerLoad::offer(DepthView frame, std::span<const std::uint8_t> user_of_pixel) noexcept {
  if (feed_) feed_->offer(frame, user_of_pixel);
}

Expected<bool> TrackerLoad::under_way() const {
  if (recorder_ <= 0) return true;
  siginfo_t ended{};
  if (::waitid(P_PID, static_cast<id_t>(recorder_), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 && ended.si_pid != 0)
    return fail(std::string("the recorder beside ") +
                (ended.si_code == CLD_EXITED ? "ended with " : "died of signal ") + std::to_string(ended.si_status) +
                " while it was to record " + recording_.string() +
                "; `armature record feed:ENDPOINT FILE.oni` beside a daemon says why");
  std::error_code none_yet;
  const auto bytes = std::filesystem::file_size(recording_, none_yet);
  return !none_yet && bytes > kBegunBytes;
}

}  // namespace armature::tools
