#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <armature/navproto/messages.h>

namespace armature::navproto {

/// Pinhole model: (x, y, z) projects to column centre_x + focal_x x/z and row centre_y + focal_y y/z; pixel centres lie
/// at integers.
struct FeedIntrinsics {
  int width = 0;
  int height = 0;
  double focal_x_px = 0;
  double focal_y_px = 0;
  double centre_x_px = 0;
  double centre_y_px = 0;

  friend bool operator==(const FeedIntrinsics&, const FeedIntrinsics&) = default;
};

/// One frame of the feed whose pixels somebody else owns.
struct FeedView {
  Header header{};
  FrameTimes times{};
  FeedIntrinsics intrinsics{};
  std::span<const std::uint16_t> depth_mm{};  ///< [height][width], row-major, millimetres along z, 0 = no return
  std::span<const std::uint8_t> user_mask{};  ///< [height][width], row-major, 0 = nobody, else a person's number
};

/// One frame of the feed that owns its pixels.
struct FeedMessage {
  Header header{};
  FrameTimes times{};
  FeedIntrinsics intrinsics{};
  std::vector<std::uint16_t> depth_mm{};  ///< as in FeedView
  std::vector<std::uint8_t> user_mask{};

  [[nodiscard]] FeedView view() const noexcept { return {header, times, intrinsics, depth_mm, user_mask}; }

  friend bool operator==(const FeedMessage&, const FeedMessage&) = default;
};

}  // namespace armature::navproto
