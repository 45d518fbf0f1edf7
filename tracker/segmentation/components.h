#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tracker/segmentation/depth_grid.h"

namespace armature {

/// A connected piece of the scene: cells that a walk over one surface can reach. Metres, camera frame.
struct Component {
  int cells = 0;
  int foreground_cells = 0;  ///< of these, cells that the background model says were not there before
  float area = 0;            ///< square metres, seen face on
  Eigen::Vector3f centre = Eigen::Vector3f::Zero();  ///< mean of its cells
  float left = 0, right = 0;                         ///< extent along the camera's x
  float near = 0, far = 0;                           ///< extent along z
  float lowest = 0, highest = 0;                     ///< extent along `up`, relative to the camera
  bool cut_above = false;                            ///< touches the image's upper edge
  bool cut_below = false;
  bool cut_aside = false;
  float hidden_below = 0;  ///< metres of its lower side below which something nearer is seen

  [[nodiscard]] float height() const noexcept { return highest - lowest; }
  [[nodiscard]] float width() const noexcept { return right - left; }
};

/// Where two components touch in the image, however far apart they are in depth.
struct Contact {
  int cells = 0;
  float smallest_step = 1e9F;  ///< metres along z
};

/// Splits a frame into components. Deterministic. Realtime-safe: find() yes.
class ComponentFinder {
 public:
  static constexpr std::size_t kMaxComponents = 63;  ///< the largest are kept

  explicit ComponentFinder(int cells);

  /// `kind` is [cells]: 0 = not to be looked at, 1 = of unknown standing, 2 = known not to be background.
  void find(const DepthGrid& grid, std::span<const std::uint8_t> kind, const Eigen::Vector3f& up) noexcept;

  [[nodiscard]] std::span<const Component> components() const noexcept { return {found_.data(), count_}; }
  /// [height][width], 0 = none, else 1 + index into components().
  [[nodiscard]] std::span<const std::uint8_t> labels() const noexcept { return labels_; }
  [[nodiscard]] const Contact& contact(std::size_t a, std::size_t b) const noexcept {
    return contacts_[a * kMaxComponents + b];
  }

 private:
  /// A cell between a near and a far surface (a flying pixel) hangs on to the near one.
  enum class Edge : std::uint8_t { None, FarLeft, FarRight };

  [[nodiscard]] static Edge edge(const DepthGrid& grid, int x, int cell) noexcept;
  [[nodiscard]] int root(int cell) noexcept;
  void join(int a, int b) noexcept;
  void link(const DepthGrid& grid, std::span<const std::uint8_t> kind) noexcept;
  void rank(const DepthGrid& grid, std::span<const std::uint8_t> kind) noexcept;
  void measure(const DepthGrid& grid, std::span<const std::uint8_t> kind, const Eigen::Vector3f& up) noexcept;
  void touch(const DepthGrid& grid) noexcept;
  void look_below(const DepthGrid& grid) noexcept;

  struct Size {
    int root;
    int cells;
  };
  // By cell; only those of cells that are looked at are of this frame.
  std::vector<Edge> edges_;
  std::vector<int> parent_;
  std::vector<int> cells_of_root_;
  std::vector<std::uint8_t> label_of_root_;
  std::vector<Size> sizes_;
  std::vector<std::uint8_t> labels_;
  std::array<Component, kMaxComponents> found_{};
  std::array<Contact, kMaxComponents * kMaxComponents> contacts_{};
  std::size_t count_ = 0;
};

}  // namespace armature
