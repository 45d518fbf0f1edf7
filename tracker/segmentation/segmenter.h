#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "firmware_host/depth_frame.h"

namespace armature {

/// normal . p + offset = 0, the normal a unit vector pointing up, camera frame, metres.
struct FloorPlane {
  Eigen::Vector3f normal = -Eigen::Vector3f::UnitY();
  float offset = 0;
};

/// Somebody seen in a frame. Ids start at 1 and stay with a person for as long as she can be followed.
struct User {
  std::uint8_t id = 0;
  int pixel_count = 0;
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< mean of the visible surface, camera frame, metres
  int left = 0, top = 0, right = 0, bottom = 0;      ///< bounding box in pixels, right and bottom exclusive
};

struct Segmentation {
  std::span<const std::uint8_t> user_of_pixel;  ///< [height][width], 0 = nobody, else User::id
  std::span<const User> users;                  ///< largest first
  std::optional<FloorPlane> floor;
  Eigen::Vector3f up = -Eigen::Vector3f::UnitY();  ///< floor normal, or the camera's own up where no floor is seen
};

struct StoredBackground;

struct SegmentationOptions {
  float near_m = 0.5F;  ///< the active zone: what is nearer or farther is ignored
  float far_m = 4.5F;
  float half_width_m = 2.0F;  ///< half the active zone's width about the optical axis
  /// The empty site, if it is known; passed over for images of another size. What has changed since is learned anew.
  std::shared_ptr<const StoredBackground> background = nullptr;
};

/// Depth frame -> floor, background and users. Owns all its memory; learns the background as frames come.
/// Deterministic. Thread-safe: no. Realtime-safe: process() yes, after the first frame of a resolution.
class Segmenter {
 public:
  explicit Segmenter(const SegmentationOptions& options);
  ~Segmenter();
  Segmenter(Segmenter&&) noexcept;
  Segmenter& operator=(Segmenter&&) noexcept;

  /// Forgets background, floor and users, and takes memory for images of this size.
  void reset(const Intrinsics& intrinsics);

  /// The result is valid until the next call.
  [[nodiscard]] const Segmentation& process(DepthView frame) noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace armature
