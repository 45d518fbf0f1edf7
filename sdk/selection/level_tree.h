#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// A connected region of a surface where a field is above a level.
struct LevelNode {
  static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
  double level = 0;
  double girth = 0;     ///< length of its boundary
  double flux = 0;      ///< of the field's gradient through it
  double area = 0;      ///< of its vertices
  double along = 0;     ///< how far its boundary lies from its tip: the level's way down over the mean gradient
  VertexId tip = {};    ///< where the field is highest
  FaceId through = {};  ///< one that its boundary crosses
  std::uint32_t parent = kNone;      ///< the region at the next lower level that holds it
  std::uint32_t main_child = kNone;  ///< of those at the next higher level that it holds, the largest
};

/// All regions above some levels of a field: how its isolines nest (a merge tree, at the levels alone).
class LevelTree {
 public:
  /// Of a field by VertexId. `levels` fall.
  LevelTree(const Surface& surface, std::span<const double> field, std::vector<double> levels);

  /// By level, highest first.
  [[nodiscard]] const std::vector<LevelNode>& nodes() const noexcept { return nodes_; }
  /// How long the boundary is `way` farther from the tip than that of a node (nearer, if negative), along the chain of
  /// main children or of parents; 0 beyond the tip, that of the last beyond the root.
  [[nodiscard]] double girth_at(std::uint32_t node, double way) const;
  /// Whether one node's region holds the other's.
  [[nodiscard]] bool nested(std::uint32_t a, std::uint32_t b) const;

 private:
  void number();

  std::vector<LevelNode> nodes_;
  std::vector<std::uint32_t> entered_;  // by node, in a walk that enters a region before what it holds
  std::vector<std::uint32_t> held_;     // by node, how many regions it holds, itself included
};

/// Levels of a field that fall: evenly over its values and evenly over the surface, so that long thin parts and wide
/// flat ones both have many.
[[nodiscard]] std::vector<double> spread_levels(const Surface& surface, std::span<const double> field);

}  // namespace armature::sdk
