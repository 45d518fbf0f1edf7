#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_host/error.h"

// What libusb does itself, beside the device libraries: who is plugged in, hot-plug, and the Kinect v1's motor, LED and
// accelerometer.

struct libusb_context;

namespace armature {

/// A depth sensor on the USB bus.
struct UsbSensor {
  std::string name;    ///< "Kinect v1"
  std::string uri;     ///< what armatured opens it by; empty where a kernel driver serves it (v4l2:)
  std::string serial;  ///< empty where it has none or may not be asked
  std::uint16_t vendor = 0, product = 0;
  int bus = 0, address = 0;
  std::string port;       ///< "1-2.3", as the kernel names it
  double speed_mbit = 0;  ///< 0 = unknown
  std::string problem;    ///< empty, or why it cannot be opened by this user
};

/// The sensors that are plugged in, in the order of bus and port. Fails where libusb cannot be initialised.
[[nodiscard]] Expected<std::vector<UsbSensor>> list_usb_sensors();

/// The name of a sensor with these numbers; null where it is not one.
[[nodiscard]] const char* sensor_name(std::uint16_t vendor, std::uint16_t product) noexcept;

/// The camera of a Kinect v1 or Kinect for Windows.
struct KinectCamera {
  std::string port;  ///< "1-2.3", as the kernel names it: its own for as long as it stays plugged in
  int listed = 0;    ///< how many others come before it in libusb's list of this context: what libfreenect counts
  friend bool operator==(const KinectCamera&, const KinectCamera&) = default;
};
/// Those that are plugged in, in the order of bus and port: the one order in which `freenect:N` counts them.
[[nodiscard]] std::vector<KinectCamera> kinect_cameras(libusb_context* context);
/// The one that `which` names: "0", "1"... by that order, or its port. Fails where there is none.
[[nodiscard]] Expected<KinectCamera> find_kinect(const std::vector<KinectCamera>& cameras, std::string_view which);

///@{
/// Resets what is plugged in at a port, or the camera that `which` names, as unplugging it would. It has to be opened
/// anew. Fails where nothing is there or this user may not.
[[nodiscard]] Expected<void> reset_usb_device(std::string_view port);
[[nodiscard]] Expected<void> reset_kinect_camera(std::string_view which);
///@}
/// The port of the device that OpenNI2 names so, `VENDOR/PRODUCT@BUS/ADDRESS`; empty where it names none.
[[nodiscard]] std::string usb_port_of_openni2(std::string_view uri);

/// Tells of sensors that are plugged in or out. Thread-safe: no.
class UsbWatch {
 public:
  using Heard = std::function<void(bool plugged_in, std::uint16_t vendor, std::uint16_t product)>;
  /// `heard` is called from within wait(), also for each sensor that is there from the beginning.
  [[nodiscard]] static Expected<std::unique_ptr<UsbWatch>> start(Heard heard);
  ~UsbWatch();
  UsbWatch(const UsbWatch&) = delete;
  UsbWatch& operator=(const UsbWatch&) = delete;

  /// Waits for something to happen for at most `timeout`.
  void wait(std::chrono::milliseconds timeout);

 private:
  struct State;
  explicit UsbWatch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The colours of a Kinect v1's LED, as its motor understands them.
enum class KinectLight : std::uint8_t {
  Off = 0,
  Green = 1,
  Red = 2,
  Yellow = 3,
  BlinkingGreen = 4,
  BlinkingRedYellow = 6
};

/// What the accelerometer and the motor of a Kinect v1 say.
struct KinectPosture {
  std::array<double, 3>
      up_m_s2{};        ///< gravity's reaction; camera frame (x right, y down, z forward): at rest, level: (0, -9.8, 0)
  double tilt_deg = 0;  ///< of the motor against its foot, positive = looks up
  bool moving = false;
};
/// The ten bytes that the motor answers with.
[[nodiscard]] KinectPosture parse_kinect_posture(const std::array<std::uint8_t, 10>& answer) noexcept;

/// The motor board of a Kinect v1: a USB device beside its camera. Thread-safe: no.
class KinectMotor {
 public:
  /// Beside the camera that `which` names, on the same hub. Where there are not two Kinects on the bus, so that it can
  /// be nobody else's, also elsewhere, and without its camera, as when that has no power.
  [[nodiscard]] static Expected<std::unique_ptr<KinectMotor>> open(std::string_view which);
  ~KinectMotor();
  KinectMotor(const KinectMotor&) = delete;
  KinectMotor& operator=(const KinectMotor&) = delete;

  [[nodiscard]] Expected<void> light(KinectLight light);
  /// Degrees against the foot, -30 to 30, positive = looks up.
  [[nodiscard]] Expected<void> tilt(double degrees);
  [[nodiscard]] Expected<KinectPosture> posture();

 private:
  struct State;
  explicit KinectMotor(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace armature
