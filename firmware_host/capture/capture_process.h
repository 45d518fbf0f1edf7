#pragma once

#include <memory>
#include <string_view>

#include <sys/types.h>

#include "firmware_host/depth_source.h"

namespace armature {

/// A source that is read by a process of its own (`lib/armature/armature-capture`), which hands frames over in shared
/// memory, newest wins. A device library that crashes or hangs takes nobody with it: read() says Timeout, health() says
/// why, and Recovery decides when the stream is restarted, the device reset or reopened, the process killed and started
/// again, also while frames come of which judge() says that they are no good. It never gives up, so read() never fails.
/// A recording's end is passed on; one of which half a second is called no good is started again with its process.
class CaptureProcess final : public DepthSource {
 public:
  /// Fails only where the program is missing. With OpenOptions::wait_for_device, also where no frame comes within it.
  [[nodiscard]] static Expected<std::unique_ptr<CaptureProcess>> open(std::string_view uri, const OpenOptions& options);
  ~CaptureProcess() override;

  /// Of the first frame where open() waited for one, else empty.
  [[nodiscard]] const SourceInfo& info() const noexcept override;
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override;
  [[nodiscard]] SourceHealth health() const override;
  /// Any thread.
  void show(StatusLight light) override;
  /// Any thread.
  void judge(bool good) noexcept override;

  /// The running process; -1 where there is none at the moment. For tests, which kill it. Any thread.
  [[nodiscard]] pid_t process() const noexcept;

 private:
  struct State;
  explicit CaptureProcess(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Where a capture process finds the shared memory and the event that wakes its reader: low, whatever may be open.
inline constexpr int kFramesDescriptor = 3;
inline constexpr int kWakeDescriptor = 4;
/// What it ends with where its words or its memory are not what it expects.
inline constexpr int kCaptureNotUnderstood = 2;

/// What `armature-capture PARENT URI` does: opens `uri` in this process, writes its frames to the shared memory behind
/// `frames_descriptor`, wakes the reader through `wake_descriptor`, and starts over whenever the source fails. Returns
/// when the process `parent` is not, or no longer, its parent (0), or the memory is not what it should be
/// (kCaptureNotUnderstood).
int run_capture(std::string_view uri, pid_t parent, int frames_descriptor, int wake_descriptor);

}  // namespace armature
