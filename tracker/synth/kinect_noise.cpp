#include "tracker/synth/kinect_noise.h"

#include <algorithm>
#include <cmath>

#include "tracker/synth/random.h"

namespace armature {
namespace {

/// Depths of neighbours that differ by more belong to different surfaces, metres.
constexpr float kEdge = 0.05F;
/// Slope of a surface against the image plane (tangent of the angle) from where depth begins to drop out, and where
/// none is left.
constexpr float kGrazingFrom = 5;
constexpr float kGrazingTo = 12;
/// Share of the pixels on the far side of a depth edge that have none.
constexpr float kEdgeLost = 0.35F;
/// Share of the jittered pixels of the near side that show the far side.
constexpr float kRecedes = 0.35F;

float unit_of(std::uint64_t bits) {
  return static_cast<float>(bits >> 40) * 0x1p-24F;
}

/// To the nearest whole number, for values above -1. (std::lround is a call, and this runs for every pixel.)
int rounded(float value) {
  return static_cast<int>(value + 1.5F) - 1;
}

/// A value in [0, 1) that is constant over square blocks of the image.
float block_value(int u, int v, int block, std::uint64_t seed) {
  return unit_of(
      scrambled(seed ^ (static_cast<std::uint64_t>(v / block) << 20) ^ static_cast<std::uint64_t>(u / block)));
}

/// Noise before rounding, in disparity steps, so that rounding (uniform, 1/12) brings it to the axial sigma.
double sigma_in_steps(double z) {
  const double step = z * z / 348.0;
  const double total = axial_sigma(z) / step;
  return std::sqrt(std::max(total * total - 1.0 / 12, 0.05));
}

/// Where the pattern is not recognised: at grazing angles, on the far side of edges, in hair.
class Dropouts {
 public:
  Dropouts(const SurfaceImage& image, const SensorOptions& options, std::uint64_t seed, std::uint64_t hair_seed)
      : image_(image),
        hair_missing_(static_cast<float>(options.hair_missing)),
        focal_(static_cast<float>(image.intrinsics.focal_x_px)),
        seed_(seed),
        hair_seed_(hair_seed) {
    const float scale = static_cast<float>(image.intrinsics.width) / 640.0F;
    hair_block_ = std::max(1, rounded(5 * scale));
    edge_block_ = std::max(1, rounded(3 * scale));
  }

  /// Whether pixel (u, v), at which the surface of (seen_u, seen_v) is seen, has no depth.
  [[nodiscard]] bool lost(int u, int v, int seen_u, int seen_v) const {
    const int width = image_.intrinsics.width, height = image_.intrinsics.height;
    const auto row = static_cast<std::size_t>(width);
    const std::size_t at = static_cast<std::size_t>(seen_v) * row + static_cast<std::size_t>(seen_u);
    const float z = image_.depth_m[at];
    const float left = image_.depth_m[at - (seen_u > 0 ? 1 : 0)];
    const float right = image_.depth_m[at + (seen_u + 1 < width ? 1 : 0)];
    const float up = image_.depth_m[at - (seen_v > 0 ? row : 0)];
    const float down = image_.depth_m[at + (seen_v + 1 < height ? row : 0)];
    const float least = std::min({left, right, up, down});
    if (std::max({left, right, up, down}) - least > 0.02F * z) {
      // The smaller one-sided difference: the slope of the surface that this pixel lies on.
      const float du = std::min(std::abs(right - z), std::abs(left - z));
      const float dv = std::min(std::abs(down - z), std::abs(up - z));
      const float slope = std::sqrt(du * du + dv * dv) * focal_ / z;
      const float grazing = std::clamp((slope - kGrazingFrom) / (kGrazingTo - kGrazingFrom), 0.0F, 1.0F);
      const bool far_side =
          z - least > kEdge && (std::abs(right + left - 2 * z) > kEdge || std::abs(up + down - 2 * z) > kEdge);
      if (block_value(u, v, edge_block_, seed_ ^ 0xED6EULL) < std::max(grazing, far_side ? kEdgeLost : 0.0F)) {
        return true;
      }
    }
    if (image_.material[at] != static_cast<std::uint8_t>(Material::Hair)) return false;
    return 0.7F * block_value(u, v, hair_block_, hair_seed_) +
               0.3F * block_value(u, v, edge_block_, seed_ ^ 0x4A12ULL) <
           hair_missing_;
  }

 private:
  const SurfaceImage& image_;
  float hair_missing_;
  float focal_;
  std::uint64_t seed_;
  std::uint64_t hair_seed_;
  int hair_block_ = 1;
  int edge_block_ = 1;
};

/// Box filter of three in both directions, wrapping nothing: borders repeat.
void smooth(std::vector<float>& field, std::vector<float>& buffer, int width, int height) {
  const auto w = static_cast<std::size_t>(width);
  for (int v = 0; v < height; ++v) {
    const float* row = &field[static_cast<std::size_t>(v) * w];
    float* out = &buffer[static_cast<std::size_t>(v) * w];
    out[0] = 2 * row[0] + row[1];
    for (int u = 1; u + 1 < width; ++u) out[u] = row[u - 1] + row[u] + row[u + 1];
    out[width - 1] = row[width - 2] + 2 * row[width - 1];
  }
  for (int v = 0; v < height; ++v) {
    const float* above = &buffer[static_cast<std::size_t>(std::max(v - 1, 0)) * w];
    const float* here = &buffer[static_cast<std::size_t>(v) * w];
    const float* below = &buffer[static_cast<std::size_t>(std::min(v + 1, height - 1)) * w];
    float* out = &field[static_cast<std::size_t>(v) * w];
    for (int u = 0; u < width; ++u) out[u] = (above[u] + here[u] + below[u]) * (1.0F / 3);
  }
}

}  // namespace

double axial_sigma(double z_m) noexcept {
  return 0.0012 + 0.0019 * (z_m - 0.4) * (z_m - 0.4);
}

void KinectSensor::make_fields(int width, int height, std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  for (auto* field : {&axial_, &jitter_u_, &jitter_v_, &blur_}) field->resize(count);
  // Uniform in +-sqrt(3): variance 1; the sum of nine over three keeps it and is close to normal.
  constexpr float kScale = 3.4641016F * 0x1p-21F;
  constexpr std::uint64_t kMask = (1U << 21) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t bits = scrambled(seed + i * 0x9E3779B97F4A7C15ULL);
    axial_[i] = static_cast<float>(bits & kMask) * kScale - 1.7320508F;
    jitter_u_[i] = static_cast<float>((bits >> 21) & kMask) * kScale - 1.7320508F;
    jitter_v_[i] = static_cast<float>((bits >> 42) & kMask) * kScale - 1.7320508F;
  }
  for (auto* field : {&axial_, &jitter_u_, &jitter_v_}) smooth(*field, blur_, width, height);
}

void KinectSensor::cast_shadows(const SurfaceImage& image, const SensorOptions& options) {
  const Intrinsics& k = image.intrinsics;
  const auto width = static_cast<std::size_t>(k.width);
  shadowed_.assign(image.depth_m.size(), 0);
  if (options.projector_m <= 0) return;
  const auto shift = static_cast<float>(k.focal_x_px * options.projector_m);
  const auto nearest = static_cast<float>(options.nearest_m), farthest = static_cast<float>(options.farthest_m);
  const int margin = static_cast<int>(shift / nearest) + 2;
  columns_.resize(width);
  lit_.resize(width + static_cast<std::size_t>(margin));
  for (int v = 0; v < k.height; ++v) {
    const float* depth = &image.depth_m[static_cast<std::size_t>(v) * width];
    std::fill(lit_.begin(), lit_.end(), SurfaceImage::kNothing);
    // The projector sees column u at depth z in its column u - shift / z.
    for (int u = 0; u < k.width; ++u) {
      const float z = std::clamp(depth[u], nearest, farthest);
      columns_[static_cast<std::size_t>(u)] = std::max(static_cast<float>(u + margin) - shift / z, 0.0F);
    }
    for (std::size_t u = 0; u < width; ++u) {
      const auto c = static_cast<std::size_t>(columns_[u]);
      for (std::size_t i = c; i <= c + 1 && i < lit_.size(); ++i) lit_[i] = std::min(lit_[i], depth[u]);
    }
    for (std::size_t u = 0; u < width; ++u) {
      const auto c = static_cast<std::size_t>(columns_[u] + 0.5F);
      shadowed_[static_cast<std::size_t>(v) * width + u] =
          c < lit_.size() && lit_[c] < depth[u] - 0.06F - 0.02F * depth[u] ? 1 : 0;
    }
  }
}

void KinectSensor::sense(const SurfaceImage& image, const SensorOptions& options, std::uint64_t seed,
                         std::uint64_t hair_seed, SensedImage& out) {
  const Intrinsics& k = image.intrinsics;
  const auto width = static_cast<std::size_t>(k.width);
  const std::size_t count = image.depth_m.size();
  out.depth_mm.assign(count, 0);
  out.source.resize(count);
  if (options.strength <= 0) {
    for (std::size_t i = 0; i < count; ++i) {
      out.source[i] = static_cast<std::uint32_t>(i);
      const auto z = static_cast<double>(image.depth_m[i]);
      if (z < options.farthest_m) out.depth_mm[i] = static_cast<std::uint16_t>(std::lround(1000 * z));
    }
    return;
  }
  make_fields(k.width, k.height, seed);
  cast_shadows(image, options);

  const float scale = static_cast<float>(k.width) / 640.0F;
  const float jitter = static_cast<float>(options.strength) * std::max(0.45F, 0.8F * scale);
  const Dropouts dropouts(image, options, seed, hair_seed);
  // The noise depends on the distance alone: one value for every 5 cm.
  std::array<float, 256> sigma{};
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    sigma[i] = static_cast<float>(options.strength * sigma_in_steps(std::max(0.4, 0.05 * static_cast<double>(i))));
  }

  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const std::size_t pixel = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
      int seen_u = std::clamp(rounded(static_cast<float>(u) + jitter * jitter_u_[pixel]), 0, k.width - 1);
      int seen_v = std::clamp(rounded(static_cast<float>(v) + jitter * jitter_v_[pixel]), 0, k.height - 1);
      std::size_t source = static_cast<std::size_t>(seen_v) * width + static_cast<std::size_t>(seen_u);
      const float farther = image.depth_m[source] - image.depth_m[pixel];
      // Only where surfaces end does it matter which pixel is looked at. The sensor matches windows of its pattern:
      // what is near spreads over what is far more often than it recedes.
      if (std::abs(farther) < kEdge || (farther > 0 && block_value(u, v, 1, seed ^ 0xFA77ULL) > kRecedes)) {
        source = pixel;
        seen_u = u;
        seen_v = v;
      }
      out.source[pixel] = static_cast<std::uint32_t>(source);

      const float z = image.depth_m[source];
      if (z < static_cast<float>(options.nearest_m) || z > static_cast<float>(options.farthest_m)) continue;
      if (shadowed_[source] != 0 || dropouts.lost(u, v, seen_u, seen_v)) continue;
      const auto bin = std::min<std::size_t>(static_cast<std::size_t>(z * 20), 255);
      const double steps = static_cast<double>(sigma[bin] * axial_[pixel]);
      const int disparity = static_cast<int>(disparity_eighths(static_cast<double>(z)) + steps + 0.5);
      if (disparity < 1) continue;
      out.depth_mm[pixel] = static_cast<std::uint16_t>(std::min(65534.0, 348000.0 / disparity + 0.5));
    }
  }
}

}  // namespace armature
