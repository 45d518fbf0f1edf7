#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "firmware_host/depth_source.h"

namespace armature {

/// What files of bare pixels do not say themselves.
struct ImportOptions {
  Intrinsics intrinsics;  ///< for images width and height may be 0: taken from the first one
  double frames_per_second = 30;
};

/// The nominal intrinsics of a Kinect v1 at this resolution: 285.63 px at a width of 320, centre (width/2, height/2).
[[nodiscard]] Intrinsics nominal_intrinsics(int width, int height) noexcept;

/// Frames one after the other, [height][width] uint16 little-endian millimetres, 0 = no return; a name that ends in
/// `.zst` is decompressed on the way. A file that ends within a frame, or is truncated or corrupt, fails there.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_raw_depth(const std::filesystem::path& path,
                                                                    const ImportOptions& options);

/// 16-bit grey PNG images of one size, millimetres, in the order given.
[[nodiscard]] Expected<std::unique_ptr<DepthSource>> open_png_depth(std::vector<std::filesystem::path> images,
                                                                    const ImportOptions& options);

/// The `.png` files of a folder, in the order of their names.
[[nodiscard]] Expected<std::vector<std::filesystem::path>> list_png_images(const std::filesystem::path& folder);

}  // namespace armature
