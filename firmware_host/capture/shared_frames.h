#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "firmware_host/depth_frame.h"
#include "firmware_host/error.h"

namespace armature {

/// How far the process that captures has come.
enum class CaptureState : std::uint32_t { Opening, Streaming, Waiting, Ended };
/// What its supervisor asks of it.
enum class CaptureCommand : std::uint32_t { None, RestartStream, ResetDevice, Reopen, Stop };

/// Frames in memory that two processes share: one writes, one reads the newest, neither waits. Each slot has a version
/// that is odd while it is being written; the reader copies and believes the copy only if the version did not change.
/// Whatever the writer's bytes, the reader returns a frame whose size is what it says, or none.
/// Thread-safe: one writer, one reader. Realtime-safe: all but create() and attach().
class SharedFrames {
 public:
  static constexpr int kMaxPixels = 1280 * 1024;

  /// New memory without a name; `descriptor()` is what to hand to the other process.
  [[nodiscard]] static Expected<SharedFrames> create();
  /// The other side's view; the descriptor is ours from here on. Fails where it holds anything else.
  [[nodiscard]] static Expected<SharedFrames> attach(int descriptor);
  ~SharedFrames();
  SharedFrames(SharedFrames&& other) noexcept;
  SharedFrames& operator=(SharedFrames&& other) noexcept;

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

  ///@{ The writer.
  /// False where the frame contradicts itself or is too large.
  bool write(const DepthFrame& frame, double frames_per_second) noexcept;
  void set_state(CaptureState state, const std::string& trouble) noexcept;
  void alive(std::chrono::nanoseconds now) noexcept;
  [[nodiscard]] CaptureCommand take_command() noexcept;
  /// What show() said last.
  [[nodiscard]] std::uint32_t shown() const noexcept;
  ///@}

  ///@{ The reader.
  enum class Read : std::uint8_t { Frame, Nothing, Torn };
  /// The newest frame that was not read before.
  [[nodiscard]] Read read(DepthFrame& frame);
  [[nodiscard]] CaptureState state() const noexcept;
  [[nodiscard]] std::string trouble() const;
  [[nodiscard]] double frames_per_second() const noexcept;
  /// As alive() was told; believe that it changes, not what it says.
  [[nodiscard]] std::chrono::nanoseconds last_alive() const noexcept;
  void command(CaptureCommand command) noexcept;
  /// Any thread.
  void show(std::uint32_t light) noexcept;
  /// Before another writer starts: as new.
  void clear() noexcept;
  ///@}

 private:
  struct Layout;
  SharedFrames(int descriptor, Layout* layout) noexcept : descriptor_(descriptor), layout_(layout) {}

  int descriptor_ = -1;
  Layout* layout_ = nullptr;
  std::uint64_t last_read_ = 0;
};

}  // namespace armature
