#include <csignal>
#include <optional>
#include <thread>

#include <sys/prctl.h>
#include <unistd.h>

#include "firmware_host/capture/capture_process.h"
#include "firmware_host/capture/shared_frames.h"

namespace armature {
namespace {

using namespace std::chrono_literals;

/// How often a device that is not there is looked for.
constexpr auto kLookAgain = 300ms;
/// How long a command may wait.
constexpr auto kPatience = 100ms;

class Capturing {
 public:
  Capturing(std::string_view uri, SharedFrames frames, int wake)
      : uri_(uri), frames_(std::move(frames)), wake_(wake), parent_(::getppid()) {}

  void run() {
    while (::getppid() == parent_) {
      frames_.alive(clock_.now());
      frames_.set_state(CaptureState::Opening, "");
      auto source = open_in_this_process(uri_, {.pacing = Pacing::RealTime});
      frames_.alive(clock_.now());
      if (!source) {
        frames_.set_state(CaptureState::Waiting, source.error().message);
        std::this_thread::sleep_for(kLookAgain);
        if (frames_.take_command() == CaptureCommand::Stop) break;
        continue;
      }
      // Any other was meant for the stream before this one.
      if (frames_.take_command() == CaptureCommand::Stop) break;
      frames_.set_state(CaptureState::Streaming, "");
      if (stream(**source)) break;
    }
  }

 private:
  /// Until the source fails or has to be opened anew; true: it is over for good.
  bool stream(DepthSource& source) {
    DepthFrame frame;
    std::uint32_t shown = 0;
    bool asked_to_stop = false;
    while (!asked_to_stop && ::getppid() == parent_) {
      frames_.alive(clock_.now());
      const auto status = source.read(frame, kPatience);
      if (!status) {
        frames_.set_state(CaptureState::Waiting, status.error().message);
        std::this_thread::sleep_for(kLookAgain);
        return frames_.take_command() == CaptureCommand::Stop;
      }
      if (*status == ReadStatus::Frame && frames_.write(frame, source.info().frames_per_second)) wake_reader();
      if (*status == ReadStatus::EndOfStream) {
        frames_.set_state(CaptureState::Ended, "");
        wake_reader();
        while (::getppid() == parent_ && frames_.take_command() != CaptureCommand::Stop)
          std::this_thread::sleep_for(kPatience);
        return true;
      }
      if (const std::uint32_t light = frames_.shown(); light != shown) {
        shown = light;
        if (light <= static_cast<std::uint32_t>(StatusLight::Trouble)) source.show(static_cast<StatusLight>(light));
      }
      switch (frames_.take_command()) {
        case CaptureCommand::None: break;
        case CaptureCommand::RestartStream:
          if (!source.recover(RecoverBy::RestartingStream)) return false;
          break;
        case CaptureCommand::ResetDevice: (void)source.recover(RecoverBy::ResettingDevice); return false;
        case CaptureCommand::Reopen: return false;
        case CaptureCommand::Stop: asked_to_stop = true; break;
      }
    }
    if (shown != 0) source.show(StatusLight::Off);
    return true;
  }

  void wake_reader() const {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one);
  }

  std::string uri_;
  SharedFrames frames_;
  int wake_;
  pid_t parent_;
  SteadyClock clock_;
};

}  // namespace

int run_capture(std::string_view uri, int frames_descriptor, int wake_descriptor) {
  // When our parent is gone, or the thread of it that started us, there is a second to turn the light off and go.
  ::signal(SIGUSR1, [](int) { ::alarm(1); });
  ::prctl(PR_SET_PDEATHSIG, SIGUSR1);
  ::signal(SIGPIPE, SIG_IGN);
  // Both are for our parent, which ends us once the sensor's light is off.
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGTERM, SIG_IGN);
  auto frames = SharedFrames::attach(frames_descriptor);
  if (!frames) return 2;
  Capturing(uri, std::move(*frames), wake_descriptor).run();
  return 0;
}

}  // namespace armature
