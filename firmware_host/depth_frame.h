#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <vector>

namespace armature {

/// The pinhole model of a depth camera. A point (x, y, z) of the camera frame (metres; x right, y down, z forward;
/// right-handed) projects to column u = centre_x + focal_x x/z and row v = centre_y + focal_y y/z; pixel (u, v) of the
/// image has its centre at the integer (u, v).
struct Intrinsics {
  int width = 0;
  int height = 0;
  double focal_x_px = 0;
  double focal_y_px = 0;
  double centre_x_px = 0;
  double centre_y_px = 0;

  friend bool operator==(const Intrinsics&, const Intrinsics&) = default;
};

/// Whose clock a timestamp was read from. Times of different clocks are not comparable.
enum class ClockId : std::uint8_t {
  Device,         ///< the sensor's own, since it was opened
  Recording,      ///< the sensor's, rebased to zero at the start of a recording
  Synthetic,      ///< computed: frame number over frame rate
  HostMonotonic,  ///< Clock::now() of this process
};

struct Timestamp {
  std::chrono::nanoseconds time{0};
  ClockId clock = ClockId::HostMonotonic;

  friend bool operator==(const Timestamp&, const Timestamp&) = default;
};

/// A frame that somebody else owns. Cheap to copy; valid as long as its owner keeps the frame.
struct DepthView {
  std::span<const std::uint16_t> depth_mm;  ///< [height][width], row-major, millimetres along z, 0 = no return
  Intrinsics intrinsics;
  std::uint64_t sequence = 0;  ///< counts up by one a frame at the source; a gap is a frame lost on the way
  Timestamp sensor;            ///< when the sensor measured the frame
  Timestamp host;              ///< when the host received it

  [[nodiscard]] int width() const noexcept { return intrinsics.width; }
  [[nodiscard]] int height() const noexcept { return intrinsics.height; }
  [[nodiscard]] std::uint16_t at(int u, int v) const noexcept {
    return depth_mm[static_cast<std::size_t>(v) * static_cast<std::size_t>(intrinsics.width) +
                    static_cast<std::size_t>(u)];
  }
};

/// A frame that owns its pixels. Reused from frame to frame: a source resizes it only when the resolution changes.
struct DepthFrame {
  std::vector<std::uint16_t> depth_mm;  ///< [height][width], row-major, millimetres along z, 0 = no return
  Intrinsics intrinsics;
  std::uint64_t sequence = 0;
  Timestamp sensor;
  Timestamp host;

  [[nodiscard]] DepthView view() const noexcept { return {depth_mm, intrinsics, sequence, sensor, host}; }
};

/// The largest sides an image may have; whatever asks for more is refused as corrupt.
inline constexpr int kMaxImageSide = 4096;

}  // namespace armature
