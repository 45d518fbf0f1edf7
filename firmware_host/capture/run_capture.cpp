#include <csignal>
#include <string>
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
  Capturing(std::string_view uri, pid_t parent, SharedFrames frames, int wake)
      : uri_(uri), frames_(std::move(frames)), wake_(wake), parent_(parent) {}

  void run() {
    while (::getppid() == parent_) {
      frames_.alive(clock_.now());
      frames_.set_state(CaptureState::Opening, "");
      auto source = open_in_this_process(uri_, {.pacing = Pacing::RealTime});
      frames_.alive(clock_.now());
      if (!source) {
        if (wait(source.error().message)) break;
        continue;
      }
      // Any other was meant for the stream before this one.
      if (frames_.take_command() == CaptureCommand::Stop) break;
      frames_.set_state(CaptureState::Streaming, "");
      if (stream(**source)) break;
    }
  }

 private:
  /// Says what is wrong and lets a moment pass; true: it is over for good.
  bool wait(const std::string& trouble) {
    frames_.set_state(CaptureState::Waiting, trouble);
    std::this_thread::sleep_for(kLookAgain);
    return frames_.take_command() == CaptureCommand::Stop;
  }
  /// Until the source fails or has to be opened anew; true: it is over for good.
  bool stream(DepthSource& source) {
    DepthFrame frame;
    std::uint32_t shown = 0;
    bool asked_to_stop = false;
    while (!asked_to_stop && ::getppid() == parent_) {
      frames_.alive(clock_.now());
      const auto status = source.read(frame, kPatience);
      if (!status) return wait(status.error().message);
      if (*status == ReadStatus::Frame) {
        if (!frames_.write(frame, source.info().frames_per_second)) return wait(refused(frame));
        wake_reader();
      }
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

  [[nodiscard]] std::string refused(const DepthFrame& frame) const {
    return uri_ + ": an image of " + std::to_string(frame.intrinsics.width) + " x " +
           std::to_string(frame.intrinsics.height) + ", " + std::to_string(frame.depth_mm.size()) +
           " pixels: expected as many as its sides say, and no more than " + std::to_string(SharedFrames::kMaxPixels);
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

int run_capture(std::string_view uri, pid_t parent, int frames_descriptor, int wake_descriptor) {
  // When our parent is gone, or the thread of it that started us, there is a second to turn the light off and go. Who
  // is gone before this line sends no signal: she is told by her number.
  ::signal(SIGALRM, SIG_DFL);
  ::signal(SIGUSR1, [](int) { ::alarm(1); });
  ::prctl(PR_SET_PDEATHSIG, SIGUSR1);
  ::signal(SIGPIPE, SIG_IGN);
  // Both are for our parent, which ends us once the sensor's light is off.
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGTERM, SIG_IGN);
  auto frames = SharedFrames::attach(frames_descriptor);
  if (!frames) return kCaptureNotUnderstood;
  Capturing(uri, parent, std::move(*frames), wake_descriptor).run();
  return 0;
}

}  // namespace armature
