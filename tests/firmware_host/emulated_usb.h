#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <umockdev.h>

namespace armature::test {

/// Whether this program runs under umockdev-wrapper, which emulation needs.
[[nodiscard]] inline bool emulation() {
  return umockdev_in_mock_environment() != 0;
}

/// USB devices that umockdev shows to this process and its children.
class EmulatedBus {
 public:
  EmulatedBus() : testbed_(umockdev_testbed_new()) {}
  ~EmulatedBus() { g_object_unref(testbed_); }
  EmulatedBus(const EmulatedBus&) = delete;
  EmulatedBus& operator=(const EmulatedBus&) = delete;

  [[nodiscard]] UMockdevTestbed* testbed() const noexcept { return testbed_; }

 private:
  UMockdevTestbed* testbed_;
};

/// A Kinect v1 (model 1414): the camera with its 11-bit depth stream over isochronous transfers, and the motor board.
/// What it sees is the raw value that `raw_of(frame)` says, all over the image. Answers on umockdev's own thread.
class EmulatedKinect {
 public:
  /// On ports 1-1 (the camera) and 1-2, or, as real ones are, on a hub of its own: 1-`hub`.1 and 1-`hub`.2.
  explicit EmulatedKinect(EmulatedBus& bus, int hub = 0);
  ~EmulatedKinect();
  EmulatedKinect(const EmulatedKinect&) = delete;
  EmulatedKinect& operator=(const EmulatedKinect&) = delete;

  void plug_in();
  /// Gone from the bus; whatever is under way fails with "no such device".
  void unplug();
  /// Its own power supply is out: the motor board alone, which USB feeds, stays on the bus.
  void unplug_power();
  /// Stops sending without going away.
  void stall(bool on);
  /// The motor board answers nothing.
  void hang_motor(bool on);

  /// What the LED and the motor were last told.
  [[nodiscard]] int light() const;
  [[nodiscard]] int tilt_half_degrees() const;
  /// Control requests to the motor board so far.
  [[nodiscard]] int motor_requests() const;
  /// How often the camera was reset.
  [[nodiscard]] int resets() const;
  /// Frames sent so far.
  [[nodiscard]] int frames() const;

  /// The raw value that a frame shows.
  [[nodiscard]] static std::uint16_t raw_of(int frame) noexcept {
    return static_cast<std::uint16_t>(600 + frame % 200);
  }

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace armature::test
