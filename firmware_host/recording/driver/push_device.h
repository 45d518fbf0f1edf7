#pragma once

#include <cstdint>

namespace armature {

/// The contract between the recorder and the OpenNI2 driver that stands in for a sensor while frames are recorded. A
/// device opens by a URI made by kPushUriFormat: a number that makes it unlike every other, width, height, frames per
/// second, horizontal and vertical field of view (radians, as %a prints them).
inline constexpr char kPushUriFormat[] = "armature-push:%u:%dx%d@%d:%la:%la";

/// VideoStream::invoke(kPushFrameCommand) with a PushedFrame sends one image through the stream, on the caller's
/// thread.
inline constexpr int kPushFrameCommand = 0x41524D31;

/// VideoStream::invoke(kSynchronizeCommand) with any int returns once no recorder is in the middle of a step.
inline constexpr int kSynchronizeCommand = 0x41524D32;

/// A property that recorders do not know and hence do not store; see kSynchronizeCommand.
inline constexpr int kSynchronizeProperty = 0x41524D33;

struct PushedFrame {
  const std::uint16_t* depth_mm;  ///< [height][width]
  int bytes;
  int index;  ///< from 1
  std::uint64_t timestamp_us;
};

}  // namespace armature
