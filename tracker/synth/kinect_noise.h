#pragma once

#include <cstdint>
#include <vector>

#include "tracker/synth/render.h"

namespace armature {

/// How a Kinect v1 sees what an ideal camera sees.
struct SensorOptions {
  double strength = 1;  ///< scales axial noise and jitter; 0: an ideal camera that still reports whole millimetres
  double hair_missing = 0.22;  ///< share of the hair that reflects too little
  double projector_m = 0.075;  ///< the projector is this far to the camera's right: what it cannot light has no depth
  double nearest_m = 0.45;
  double farthest_m = 8;
};

/// Axial noise of a Kinect v1 at distance z, metres, quantisation included (Nguyen, Izadi, Lovell 2012, at up to 60
/// degrees of incidence).
[[nodiscard]] double axial_sigma(double z_m) noexcept;
/// The disparity of distance z in eighths of a pixel at 640 columns, the unit in which the sensor quantises.
[[nodiscard]] constexpr double disparity_eighths(double z_m) noexcept {
  return 348.0 / z_m;
}

/// The measured image. Arrays [height][width].
struct SensedImage {
  std::vector<std::uint16_t> depth_mm;  ///< 0 = no return
  std::vector<std::uint32_t> source;    ///< the pixel of the ideal image that was seen here (edges jitter)
};

/// Turns ideal depth into measured depth: ragged edges, axial noise correlated over three pixels, disparity rounded to
/// eighths of a pixel, the projector's shadow, drop-outs at edges, at grazing angles and in hair. Holds the buffers it
/// needs. The result depends on the image and the seed only.
class KinectSensor {
 public:
  /// `hair_seed` decides which strands are missing; keep it for one person so that they stay missing.
  void sense(const SurfaceImage& image, const SensorOptions& options, std::uint64_t seed, std::uint64_t hair_seed,
             SensedImage& out);

 private:
  void make_fields(int width, int height, std::uint64_t seed);
  void cast_shadows(const SurfaceImage& image, const SensorOptions& options);

  std::vector<float> axial_, jitter_u_, jitter_v_, blur_;  ///< unit variance
  std::vector<float> lit_;                                 ///< a row of the projector's depth buffer
  std::vector<float> columns_;                             ///< where the projector sees the pixels of a row
  std::vector<std::uint8_t> shadowed_;
};

}  // namespace armature
