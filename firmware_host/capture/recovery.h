#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace armature {

/// How far the process that reads the sensor has come.
enum class Reader : std::uint8_t {
  Gone,
  Opening,    ///< in the device library, which may take its time
  Waiting,    ///< no device that opens; it looks for one
  Streaming,  ///< frames come, or should
};

/// What to try next with a sensor that is silent, and when: gentle first, harder later, never giving up. Frames that
/// are no good are silence.
///
///     silence    0.5 s         1.2 s        2.2 s    3.5 s             and then every 3.5 s
///     step       restart the   reset the    reopen   restart the       restart the process; of every eighth
///                stream        USB device   it       process           process all steps are tried again
///
/// Silence is counted while a stream is open: from the last good frame, or from when the device was opened since. A
/// step that opens it anew starts the count again, so that the next comes its whole time of the table after that.
/// These pauses do not grow: who pulls the plug of a sensor that sends nothing and puts it back, unnoticed by the
/// library, has frames within 5 s however long it was silent.
///
/// A process that opens a device is left alone. One that finds none that opens is restarted after 10 s, then after 20,
/// 40, 60 and every 60 s, for a library that has lost its way. One that hangs() is killed, whatever it was at.
///
/// A pure function of the times it is told. Thread-safe: no. Realtime-safe: yes.
class Recovery {
 public:
  using Time = std::chrono::nanoseconds;
  enum class Step : std::uint8_t { None, RestartStream, ResetDevice, Reopen, RestartProcess };

  /// A good frame came: all is well again.
  void frame(Time now) noexcept {
    silent_since_ = now;
    tried_ = 0;
    starts_ = 0;
    waits_ = 0;
    hung_opening_ = 0;
  }
  /// The process is gone; what it was at if it was killed because it hangs(). It is started again after a pause that
  /// doubles from 100 ms to 2 s while no frame comes.
  void process_ended(Time now, Reader hung_at = Reader::Gone) noexcept {
    if (hung_at == Reader::Opening) ++hung_opening_;
    tried_ = kProcess;
    due_ = std::max(now + pause(), last_start_ + pause());
  }
  void process_started(Time now) noexcept {
    silent_since_ = now;
    waiting_since_ = now;
    last_start_ = now;
    ++starts_;
    if (tried_ < kProcess || starts_ % kAnew == 0) tried_ = 0;
    due_ = now + kPatience;
  }

  /// Whether a process that has not come round its loop for so long hangs in the device library. To open a device takes
  /// longer than to read from it: 3 s, then 6 and 12 while it is killed for that, for a device that is slower than we
  /// think.
  [[nodiscard]] bool hangs(Time unheard_of, Reader reader) const noexcept {
    using namespace std::chrono_literals;
    if (reader != Reader::Opening) return unheard_of > 2s;
    return unheard_of > 3s * (1 << std::min(hung_opening_, 2));
  }

  /// What is due now; each step once.
  [[nodiscard]] Step step(Time now, Reader reader) noexcept {
    using namespace std::chrono_literals;
    if (reader == Reader::Gone) return now >= due_ ? Step::RestartProcess : Step::None;
    if (reader != Reader::Streaming) {
      silent_since_ = now;
      if (reader == Reader::Waiting) hung_opening_ = 0;
      const Time patience = std::min<Time>(10s * (1 << std::min(waits_, 3)), 60s);
      if (reader == Reader::Opening || now - waiting_since_ < patience) return Step::None;
      ++waits_;
      tried_ = starts_ = 0;  // it came back from the library: what was in vain before says nothing of the next open
      return Step::RestartProcess;
    }
    waiting_since_ = now;
    const Time silent = now - silent_since_;
    if (tried_ == 0 && silent > 500ms) return next(Step::RestartStream);
    if (tried_ == 1 && silent > 1200ms) return next(Step::ResetDevice);
    if (tried_ == 2 && silent > 2200ms) return next(Step::Reopen);
    return tried_ >= 3 && silent > kPatience ? restart() : Step::None;
  }

 private:
  static constexpr int kProcess = 4;  // steps
  static constexpr int kAnew = 8;     // processes
  static constexpr Time kPatience{std::chrono::milliseconds(3500)};
  [[nodiscard]] Time pause() const noexcept {
    const int doublings = std::min(starts_, 5);
    return std::min<Time>(std::chrono::milliseconds(100) * (1 << doublings), std::chrono::seconds(2));
  }
  Step next(Step step) noexcept {
    ++tried_;
    return step;
  }
  Step restart() noexcept {
    tried_ = kProcess;
    return Step::RestartProcess;
  }

  Time silent_since_{0}, waiting_since_{0}, due_{0}, last_start_{0};
  int tried_ = 0;         // steps since the last frame, or since it began anew
  int starts_ = 0;        // of the process, since the last frame
  int waits_ = 0;         // in vain, since the last frame
  int hung_opening_ = 0;  // processes killed in the midst of opening, since a frame, or one that found no device
};

}  // namespace armature
