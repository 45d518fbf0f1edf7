#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tracker/segmentation/depth_grid.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

/// A plane as depth cameras see it: inverse depth = a ray_x + b ray_y + c, in 1/m. Linear in the image, with noise that
/// is the same everywhere (disparity).
struct ImagePlane {
  float a = 0;
  float b = 0;
  float c = 0;

  [[nodiscard]] float inverse_depth(float ray_x, float ray_y) const noexcept { return a * ray_x + b * ray_y + c; }
};

/// The same plane in space, its normal on the camera's side.
[[nodiscard]] FloorPlane in_space(const ImagePlane& plane) noexcept;

/// Finds the floor and the large upright planes (walls, cupboards, doors) of a room, by RANSAC (Fischler and Bolles
/// 1981) with a fixed seed and least squares, and follows the floor over time.
/// Deterministic. Realtime-safe: update() yes.
class PlaneFinder {
 public:
  explicit PlaneFinder(int max_cells);

  /// Cells with a non-zero entry in `users` ([cells]) are nobody's floor or wall.
  void update(const DepthGrid& grid, std::span<const std::uint8_t> users) noexcept;

  [[nodiscard]] const std::optional<ImagePlane>& floor() const noexcept { return floor_; }
  [[nodiscard]] std::span<const ImagePlane> walls() const noexcept { return {walls_.data(), wall_count_}; }

 private:
  struct Sample {
    float ray_x, ray_y, inverse_depth, area;
    bool floor_like;  ///< its surroundings slope like a floor
  };
  struct Support {
    float inliers = 0;
    float below = 0;
  };
  static constexpr std::size_t kMaxWalls = 4;

  void collect(const DepthGrid& grid, std::span<const std::uint8_t> users) noexcept;
  [[nodiscard]] std::uint32_t random(std::uint32_t below) noexcept;
  [[nodiscard]] std::optional<ImagePlane> through_random_samples(std::span<const std::uint16_t> from) noexcept;
  [[nodiscard]] std::optional<ImagePlane> refined(ImagePlane plane, std::span<const std::uint16_t> from,
                                                  float tolerance) const noexcept;
  [[nodiscard]] Support floor_support(const ImagePlane& plane) const noexcept;
  [[nodiscard]] bool is_floor(const ImagePlane& plane) const noexcept;
  void find_floor() noexcept;
  void follow_floor() noexcept;
  void find_walls() noexcept;

  std::vector<Sample> samples_;
  std::vector<std::uint16_t> floor_like_;  ///< indices into samples_
  std::vector<std::uint16_t> remaining_;   ///< indices into samples_ that no plane has explained yet
  std::optional<ImagePlane> floor_;
  std::array<ImagePlane, kMaxWalls> walls_{};
  std::size_t wall_count_ = 0;
  std::uint32_t random_state_ = 1;
  int frame_ = 0;
  int floor_age_ = 0;     ///< measurements over which the floor has been averaged
  int floor_unseen_ = 0;  ///< measurements since one last supported it
};

}  // namespace armature
