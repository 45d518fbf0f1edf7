#pragma once

#include <chrono>

#include <armature/navproto/messages.h>

namespace armature::navproto {

/// Where a camera stands on the ground and where it looks. World frame: x forward and y to the left of a camera with
/// heading 0, z up, right-handed; heading counter-clockwise seen from above.
struct CameraPose {
  double x_m = 0;          ///< forward of where heading 0 looks
  double y_m = 0;          ///< to the left of it
  double heading_rad = 0;  ///< not wrapped: a full turn to the left adds 2 pi
};

/// A camera that walks: the primitives Move() and Rotate() of section 3.4.3.
class NavCamera {
 public:
  /// Stands at the origin and looks along x.
  NavCamera() = default;
  /// Stands and looks as told.
  explicit NavCamera(const CameraPose& pose) : pose_(pose) {}

  /// Along the view; negative = backwards.
  void move(double distance_m) noexcept;

  /// About up, positive = to the left.
  void rotate(double angle_rad) noexcept;

  /// Moves and rotates at once for a time with a constant velocity: exactly the arc that it describes, so that the
  /// frame rate does not change the path. Ignores what is not finite, and times that are not positive.
  void advance(const Velocity& velocity, std::chrono::duration<double> time) noexcept;

  /// Where it stands and looks now.
  [[nodiscard]] const CameraPose& pose() const noexcept { return pose_; }

 private:
  CameraPose pose_;
};

}  // namespace armature::navproto
