#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

#include <semaphore.h>

#include "firmware_host/depth_frame.h"

namespace armature {

/// Hands the newest frame from one capturing thread to one tracking thread. Three frames go round: one is filled, one
/// waits, one is read, so nothing is copied and neither side waits for the other. A frame that is overtaken while it
/// waits is counted as dropped.
///
///     capture: source.read(latest.slot(), ...); latest.publish();
///     tracker: while (const DepthFrame* frame = latest.take(100ms)) track(frame->view());
class LatestFrame {
 public:
  LatestFrame();
  ~LatestFrame();
  LatestFrame(const LatestFrame&) = delete;
  LatestFrame& operator=(const LatestFrame&) = delete;

  /// The frame to fill; another one after each publish(). Producer only. Realtime-safe: yes.
  [[nodiscard]] DepthFrame& slot() noexcept { return frames_[back_]; }
  /// Makes the filled frame the newest. Producer only. Realtime-safe: yes (no lock; at most one futex wake).
  void publish() noexcept;
  /// No frame will follow: take() no longer waits. Producer only. Realtime-safe: yes.
  void close() noexcept;

  /// The newest frame that was not taken yet, waiting for it for at most `timeout`; nullptr when none came, or none
  /// will. It stays valid, and unchanged, until the next call. Consumer only. Realtime-safe: with a timeout of zero.
  [[nodiscard]] const DepthFrame* take(std::chrono::nanoseconds timeout) noexcept;
  /// Whether the producer has closed and the last frame was taken. Consumer only. Realtime-safe: yes.
  [[nodiscard]] bool finished() const noexcept;

  /// Frames that were overtaken before anybody took them. Any thread. Realtime-safe: yes.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  static constexpr unsigned kIndex = 3;  // which frame waits
  static constexpr unsigned kFresh = 4;  // nobody took it yet

  std::array<DepthFrame, 3> frames_;
  unsigned back_ = 0;                // the producer's
  unsigned front_ = 1;               // the consumer's
  std::atomic<unsigned> middle_{2};  // kIndex and kFresh
  std::atomic<bool> closed_{false};
  std::atomic<std::uint64_t> dropped_{0};
  sem_t fresh_;  // one token for each time the waiting frame turned fresh, and one for the end
};

}  // namespace armature
