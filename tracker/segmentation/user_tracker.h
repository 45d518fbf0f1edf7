#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tracker/segmentation/components.h"
#include "tracker/segmentation/depth_grid.h"
#include "tracker/segmentation/segmenter.h"

namespace armature {

/// Somebody who is followed from frame to frame.
struct Track {
  std::uint8_t id = 0;  ///< 0 = this place is free
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();
  Eigen::Vector3f velocity = Eigen::Vector3f::Zero();  ///< metres a frame
  Eigen::Vector3f birthplace = Eigen::Vector3f::Zero();
  int age = 0;     ///< frames since birth
  int missed = 0;  ///< frames since last seen
  bool has_moved = false;

  [[nodiscard]] bool seen() const noexcept { return id != 0 && missed == 0; }
};

/// Which components are people, and which of them is who. Deterministic. Realtime-safe: update() yes.
class UserTracker {
 public:
  static constexpr std::size_t kMaxUsers = 6;

  UserTracker(const SegmentationOptions& options, int cells);

  /// `floor` as in Segmentation.
  void update(const DepthGrid& grid, const ComponentFinder& components,
              const std::optional<FloorPlane>& floor) noexcept;

  [[nodiscard]] std::span<const Track> tracks() const noexcept { return tracks_; }
  /// [height][width], 0 = nobody, else 1 + index into tracks().
  [[nodiscard]] std::span<const std::uint8_t> owners() const noexcept { return owners_; }
  /// Whether a cell of the next frame still shows the surface of a user of the last one.
  [[nodiscard]] bool still_user(std::size_t cell, float depth) const noexcept;
  /// [height][width], not 0 = belongs to what was dismissed as furniture in this frame.
  [[nodiscard]] std::span<const std::uint8_t> dismissed() const noexcept { return dismissed_; }

 private:
  static constexpr std::size_t kMaxComponents = ComponentFinder::kMaxComponents;
  static constexpr std::uint8_t kNobody = 0;
  static constexpr std::uint8_t kShared = 255;  ///< a component in which several users have met

  [[nodiscard]] bool in_zone(const Component& c, float margin) const noexcept;
  void count_overlaps(const DepthGrid& grid, std::span<const std::uint8_t> labels) noexcept;
  void keep(std::span<const Component> found) noexcept;
  void admit(const DepthGrid& grid, const ComponentFinder& components, const std::optional<FloorPlane>& floor) noexcept;
  void welcome(std::size_t place, const Eigen::Vector3f& centre) noexcept;
  [[nodiscard]] bool admit_pair(const DepthGrid& grid, const ComponentFinder& components, std::size_t c) noexcept;
  void remember_birth(const DepthGrid& grid) noexcept;
  void attach(const DepthGrid& grid, const ComponentFinder& components,
              const std::optional<FloorPlane>& floor) noexcept;
  void share(const DepthGrid& grid, std::span<const std::uint8_t> labels) noexcept;
  void move(const DepthGrid& grid) noexcept;
  void dismiss_furniture() noexcept;
  [[nodiscard]] std::size_t place_for(const Eigen::Vector3f& centre) noexcept;

  SegmentationOptions options_;
  std::array<Track, kMaxUsers> tracks_{};
  std::uint8_t last_id_ = 0;
  std::vector<std::uint8_t> owners_;
  std::vector<std::uint8_t> dismissed_;
  std::vector<std::uint8_t> previous_owners_;
  std::vector<float> previous_depth_;
  std::vector<std::uint8_t> owners_at_birth_;  ///< what each user looked like when she was first seen
  std::vector<float> depth_at_birth_;
  std::vector<int> queue_;
  std::array<std::uint8_t, kMaxComponents> owner_of_{};               ///< per component: kNobody, 1 + track, or kShared
  std::array<std::array<int, kMaxUsers>, kMaxComponents> overlap_{};  ///< cells that were a user's a frame ago
  std::array<int, kMaxUsers> previous_cells_{};
  std::array<bool, kMaxUsers> taken_{};  ///< by place: has a component in this frame
};

}  // namespace armature
