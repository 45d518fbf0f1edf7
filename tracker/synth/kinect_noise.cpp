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

/// Box filter of three in both directions, wrapping nothing: borders repeat.
void smooth(std::vector<float>& field, std::vector<float>& buffer, int width, int height) {
  const auto w = static_cast<std::size_t>(width);
  for (int v = 0; v < height; ++v) {
    const float* row = &field[static_cast<std::size_t>(v) * w];
    float* out = &buffer[static_cast<std::size_t>(v) * w];
    for (int u = 0; u < width; ++u) out[u] = row[std::max(u - 1, 0)] + row[u] + row[std::min(u + 1, width - 1)];
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
  const auto farthest = static_cast<float>(options.farthest_m);
  const int margin = static_cast<int>(shift / static_cast<float>(options.nearest_m)) + 2;
  lit_.resize(width + static_cast<std::size_t>(margin));
  for (int v = 0; v < k.height; ++v) {
    const float* depth = &image.depth_m[static_cast<std::size_t>(v) * width];
    std::fill(lit_.begin(), lit_.end(), SurfaceImage::kNothing);
    // The projector sees column u at depth z in its column u - shift / z.
    const auto column = [&](int u) {
      const float z = std::clamp(depth[u], static_cast<float>(options.nearest_m), farthest);
      return static_cast<float>(u + margin) - shift / z;
    };
    for (int u = 0; u < k.width; ++u) {
      const float at = column(u);
      const auto c = static_cast<std::size_t>(std::max(at, 0.0F));
      for (std::size_t i = c; i <= c + 1 && i < lit_.size(); ++i) lit_[i] = std::min(lit_[i], depth[u]);
    }
    for (int u = 0; u < k.width; ++u) {
      const auto c = static_cast<std::size_t>(std::max(column(u) + 0.5F, 0.0F));
      if (c < lit_.size() && lit_[c] < depth[u] - 0.06F - 0.02F * depth[u]) {
        shadowed_[static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u)] = 1;
      }
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
  const int hair_block = std::max(1, static_cast<int>(std::lround(5 * scale)));
  const int edge_block = std::max(1, static_cast<int>(std::lround(3 * scale)));
  // The noise depends on the distance alone: one value for every 5 cm.
  std::array<float, 256> sigma{};
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    sigma[i] = static_cast<float>(options.strength * sigma_in_steps(std::max(0.4, 0.05 * static_cast<double>(i))));
  }

  for (int v = 0; v < k.height; ++v) {
    for (int u = 0; u < k.width; ++u) {
      const std::size_t pixel = static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
      // Only where surfaces end does it matter which pixel is looked at.
      const int ju =
          std::clamp(static_cast<int>(std::lround(static_cast<float>(u) + jitter * jitter_u_[pixel])), 0, k.width - 1);
      const int jv =
          std::clamp(static_cast<int>(std::lround(static_cast<float>(v) + jitter * jitter_v_[pixel])), 0, k.height - 1);
      std::size_t source = static_cast<std::size_t>(jv) * width + static_cast<std::size_t>(ju);
      const float farther = image.depth_m[source] - image.depth_m[pixel];
      if (std::abs(farther) < kEdge) source = pixel;
      // The sensor matches windows of the pattern: what is near spreads over what is far more often than it recedes.
      if (farther >= kEdge && block_value(u, v, 1, seed ^ 0xFA77ULL) > kRecedes) source = pixel;
      out.source[pixel] = static_cast<std::uint32_t>(source);

      const float z = image.depth_m[source];
      if (z < static_cast<float>(options.nearest_m) || z > static_cast<float>(options.farthest_m)) continue;
      if (shadowed_[source] != 0) continue;

      const auto at = [&](int du, int dv) {
        const int su = std::clamp(static_cast<int>(source % width) + du, 0, k.width - 1);
        const int sv = std::clamp(static_cast<int>(source / width) + dv, 0, k.height - 1);
        return image.depth_m[static_cast<std::size_t>(sv) * width + static_cast<std::size_t>(su)];
      };
      const float left = at(-1, 0), right = at(1, 0), up = at(0, -1), down = at(0, 1);
      const float jump = std::max({left, right, up, down}) - std::min({left, right, up, down});
      if (jump > 0.02F * z) {
        // The smaller one-sided difference: the slope of the surface that this pixel lies on.
        const float du = std::min(std::abs(right - z), std::abs(left - z));
        const float dv = std::min(std::abs(down - z), std::abs(up - z));
        const float slope = std::sqrt(du * du + dv * dv) * static_cast<float>(k.focal_x_px) / z;
        const float lost = std::clamp((slope - kGrazingFrom) / (kGrazingTo - kGrazingFrom), 0.0F, 1.0F);
        const bool far_side = z - std::min({left, right, up, down}) > kEdge &&
                              (std::abs(right + left - 2 * z) > kEdge || std::abs(up + down - 2 * z) > kEdge);
        if (block_value(u, v, edge_block, seed ^ 0xED6EULL) < std::max(lost, far_side ? kEdgeLost : 0.0F)) continue;
      }
      if (image.material[source] == static_cast<std::uint8_t>(Material::Hair)) {
        const float missing =
            0.7F * block_value(u, v, hair_block, hair_seed) + 0.3F * block_value(u, v, edge_block, seed ^ 0x4A12ULL);
        if (missing < static_cast<float>(options.hair_missing)) continue;
      }

      const double steps =
          static_cast<double>(sigma[std::min<std::size_t>(static_cast<std::size_t>(z * 20), 255)] * axial_[pixel]);
      const double disparity = std::nearbyint(disparity_eighths(static_cast<double>(z)) + steps);
      if (disparity < 1) continue;
      out.depth_mm[pixel] = static_cast<std::uint16_t>(std::min(65535.0, std::nearbyint(348000.0 / disparity)));
    }
  }
}

}  // namespace armature
