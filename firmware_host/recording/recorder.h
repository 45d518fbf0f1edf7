#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string_view>

#include "firmware_host/depth_frame.h"
#include "firmware_host/depth_source.h"
#include "firmware_host/error.h"
#include "firmware_host/recording/sidecar.h"

namespace armature {

/// Writes an OpenNI2 recording and its side-car through openni::Recorder, on a device of our own driver. Replay gives
/// back the same pixels, and the time stamps rebased to zero, in whole microseconds.
///
/// Both files come into being when finish() succeeds; until then, and for good where it is never called, there is only
/// a temporary file. OpenNI2's recorder keeps a core busy while it exists: not for the daemon's process.
/// Thread-safe: no. Realtime-safe: no.
class Recorder {
 public:
  /// `path` should end in `.oni`. An existing recording is replaced, by finish().
  /// `in_place`: under its own name from the beginning, so that what a killed process leaves replays up to its last
  /// complete frame; an unfinished recording then stays where append() or finish() fails. Fails where `path` exists.
  [[nodiscard]] static Expected<Recorder> create(std::filesystem::path path, const RecordingFacts& facts,
                                                 bool in_place = false);

  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) noexcept;
  ~Recorder();

  /// Fails when the frame has another resolution, goes back in time, or holds what the format cannot: a depth of 65535,
  /// or more than 32768 different depths. Waits while the disk is slower than the caller.
  [[nodiscard]] Expected<void> append(const DepthView& frame);

  /// Completes the recording, reads it back record by record and moves it to its name.
  [[nodiscard]] Expected<void> finish();

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Frames until the first of: the end of the source, `max_frames`, `max_duration` of the frames' own time, `stop`
/// saying so; then the recording is kept only when `keep_when_stopped`. `progress` hears the number of frames so far.
struct WriteRecordingOptions {
  std::optional<std::uint64_t> max_frames = {};
  std::optional<std::chrono::nanoseconds> max_duration = {};
  std::stop_token stop = {};
  bool keep_when_stopped = true;
  std::function<void(std::uint64_t frames)> progress = {};
  bool in_place = false;  ///< as Recorder::create() has it
  /// Hears of what is worth a line and stops nothing.
  std::function<void(std::string_view line)> remark = {};
};

/// Records `source` at `path`; the number of frames. A source without a single frame is an error, and nothing is left.
/// Where the clock of a live source begins anew (a sensor that was opened again counts from zero) or jumps, the
/// recorded time goes on by the host's.
[[nodiscard]] Expected<std::uint64_t> write_recording(const std::filesystem::path& path, DepthSource& source,
                                                      const WriteRecordingOptions& options = {});

}  // namespace armature
