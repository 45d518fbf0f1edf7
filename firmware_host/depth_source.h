#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "firmware_host/clock.h"
#include "firmware_host/depth_frame.h"
#include "firmware_host/error.h"

namespace armature {

enum class ReadStatus : std::uint8_t {
  Frame,        ///< the frame was filled
  Timeout,      ///< nothing came in time; the source is still alive
  EndOfStream,  ///< a recording is over; further reads say so again
};

/// How a source that could be read faster than it was recorded hands out its frames.
enum class Pacing : std::uint8_t {
  Lossless,  ///< every frame, in order, as fast as the reader asks
  RealTime,  ///< at the recorded pace (by the injected clock); every frame is still handed out by read()
};

struct SourceInfo {
  std::string uri;
  Intrinsics intrinsics;
  double frames_per_second = 30;  ///< nominal
  bool live = false;              ///< a device: cannot be read losslessly, has no end
  long frame_count = -1;          ///< -1 where unknown
};

/// How a live source fares.
struct SourceHealth {
  std::string trouble{};         ///< one line: why no frames come; empty where they do
  std::uint64_t restarts = 0;    ///< of the process that reads the device
  std::uint64_t bad_frames = 0;  ///< that were torn on their way
  double frames_per_second = 0;  ///< of the device that is open now; 0: as info() says
};

/// What may bring a silent device back, from gentle to hard.
enum class RecoverBy : std::uint8_t { RestartingStream, ResettingDevice };

/// What a sensor with a light of its own shows.
enum class StatusLight : std::uint8_t { Off, Ready, Calibrating, Engaged, Trouble };

/// Anything that depth frames come from: a sensor, a recording, a synthetic person.
/// Thread-safe: no (one reader). Realtime-safe: no.
class DepthSource {
 public:
  virtual ~DepthSource() = default;
  [[nodiscard]] virtual const SourceInfo& info() const noexcept = 0;

  /// Fills `frame` with the next frame, waiting for at most `timeout`. Failure means the source broke and will not
  /// recover by itself (a corrupt file, an unplugged device).
  [[nodiscard]] virtual Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) = 0;

  /// Thread-safe: yes.
  [[nodiscard]] virtual SourceHealth health() const { return {}; }

  /// Shows the state of whoever reads it, where the sensor can; soon, and without holding up frames. Thread-safe: yes,
  /// but not while read() runs elsewhere, unless the source says so.
  virtual void show(StatusLight) {}

  /// Hears from whoever reads it whether the frames are any good, if she can tell; until then they are. A source that
  /// brings a silent device back by itself takes bad frames for silence. Thread-safe: yes. Realtime-safe: yes.
  virtual void judge(bool /*good*/) noexcept {}

  /// Tries to bring a silent device back; a failure means that it has to be opened anew.
  [[nodiscard]] virtual Expected<void> recover(RecoverBy) { return fail("nothing to recover"); }
};

struct OpenOptions {
  Pacing pacing = Pacing::Lossless;
  std::shared_ptr<Clock> clock = std::make_shared<SteadyClock>();  ///< host timestamps and pacing
  /// How long to wait for a device's first frame; zero: it is opened in any case, and looked for while it is read.
  std::chrono::milliseconds wait_for_device{5000};
};

/// Opens a source of this folder by its URI: `oni:FILE`, `fakenect:DIR`, and the devices `openni2:`, `openni2:URI`,
/// `freenect:N`, `freenect:PORT`, `v4l2:/dev/videoN`, which a process of its own reads (capture/); `process:URI` does
/// the same with any of them. An unknown scheme is an error that lists the known ones. (tracker/synth adds
/// `synth:NAME`.)
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_depth_source(std::string_view uri,
                                                                       const OpenOptions& options = {});
/// The same without a process of its own: a device library that crashes takes the caller with it.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_in_this_process(std::string_view uri,
                                                                          const OpenOptions& options = {});
/// Whether the URI names a device rather than a recording.
[[nodiscard]] bool names_device(std::string_view uri) noexcept;

}  // namespace armature
