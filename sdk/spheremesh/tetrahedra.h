#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Core>

namespace armature::sdk {

/// Space as tetrahedra that meet face to face, halved where asked (Maubach 1995): a cube lattice in six tetrahedra a
/// cube, each of which is halved across its marked edge together with all others around that edge.
class Tetrahedra {
 public:
  using CornerId = std::uint32_t;
  using TetId = std::uint32_t;
  struct Tet {
    std::array<CornerId, 4> corners;  ///< the marked edge runs from corner 0 to corner `mark`
    std::uint8_t mark = 3;
    bool whole = true;  ///< not halved
  };

  /// A lattice of `counts` cubes of size `spacing` that begins at `origin`.
  Tetrahedra(const Eigen::Vector3d& origin, double spacing, const std::array<int, 3>& counts);

  [[nodiscard]] const std::vector<Tet>& tets() const noexcept { return tets_; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& corners() const noexcept { return corners_; }
  [[nodiscard]] const Eigen::Vector3d& corner(CornerId id) const noexcept { return corners_[id]; }

  /// The whole tetrahedra at a corner.
  [[nodiscard]] const std::vector<TetId>& around(CornerId id) const noexcept { return around_[id]; }

  /// Halves a whole tetrahedron, and whatever must be halved so that faces still meet. New ones are appended.
  void halve(TetId tet);

 private:
  CornerId corner_at(const std::array<std::uint32_t, 3>& place);
  void add(const Tet& tet);
  void split(TetId tet, CornerId middle);

  Eigen::Vector3d origin_;
  double unit_;
  std::vector<std::array<std::uint32_t, 3>> places_;
  std::vector<Eigen::Vector3d> corners_;
  std::unordered_map<std::uint64_t, CornerId> by_place_;
  std::vector<Tet> tets_;
  std::vector<std::vector<TetId>> around_;  // whole tetrahedra at each corner
};

}  // namespace armature::sdk
