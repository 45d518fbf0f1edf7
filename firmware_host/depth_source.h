#pragma once

#include <chrono>
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

/// Anything that depth frames come from: a sensor, a recording, a synthetic person.
/// Thread-safe: no (one reader). Realtime-safe: no.
class DepthSource {
 public:
  virtual ~DepthSource() = default;
  [[nodiscard]] virtual const SourceInfo& info() const noexcept = 0;

  /// Fills `frame` with the next frame, waiting for at most `timeout`. Failure means the source broke and will not
  /// recover by itself (a corrupt file, an unplugged device).
  [[nodiscard]] virtual Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) = 0;
};

struct OpenOptions {
  Pacing pacing = Pacing::Lossless;
  std::shared_ptr<Clock> clock = std::make_shared<SteadyClock>();  ///< host timestamps and pacing
};

/// Opens a source of this folder by its URI: `oni:FILE`, `fakenect:DIR`. An unknown scheme is an error that lists the
/// known ones. (tracker/synth adds `synth:NAME`.)
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_depth_source(std::string_view uri,
                                                                       const OpenOptions& options = {});

}  // namespace armature
