#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <armature/navproto/messages.h>

namespace armature::navproto {

/// Pinhole model: (x, y, z) projects to column centre_x + focal_x x/z and row centre_y + focal_y y/z; pixel centres lie
/// at integers.
struct FeedIntrinsics {
  int width = 0;           ///< in pixels
  int height = 0;          ///< in pixels
  double focal_x_px = 0;   ///< focal length along a row
  double focal_y_px = 0;   ///< focal length along a column
  double centre_x_px = 0;  ///< column of the principal point
  double centre_y_px = 0;  ///< row of the principal point

  friend bool operator==(const FeedIntrinsics&, const FeedIntrinsics&) = default;
};

/// One frame of the feed whose pixels somebody else owns.
struct FeedView {
  Header header{};                            ///< filled in by the publisher
  FrameTimes times{};                         ///< of this frame
  FeedIntrinsics intrinsics{};                ///< of this frame
  std::span<const std::uint16_t> depth_mm{};  ///< [height][width], row-major, millimetres along z, 0 = no return
  std::span<const std::uint8_t> user_mask{};  ///< [height][width], row-major, 0 = nobody, else a person's number
};

/// One frame of the feed that owns its pixels.
struct FeedMessage {
  Header header{};                        ///< filled in by the publisher
  FrameTimes times{};                     ///< of this frame
  FeedIntrinsics intrinsics{};            ///< of this frame
  std::vector<std::uint16_t> depth_mm{};  ///< as in FeedView
  std::vector<std::uint8_t> user_mask{};  ///< as in FeedView

  /// The same frame, its pixels still owned here.
  [[nodiscard]] FeedView view() const noexcept { return {header, times, intrinsics, depth_mm, user_mask}; }

  friend bool operator==(const FeedMessage&, const FeedMessage&) = default;
};

}  // namespace armature::navproto
