#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace armature::sdk {

/// The faces of a mesh that changes, by place: tells what a new face would run through.
class Crossings {
 public:
  using Index = std::uint32_t;
  using Face = std::array<Index, 3>;  ///< its corners
  /// Where corner k is.
  using Positions = std::vector<Eigen::Vector3d>;

  Crossings(const std::vector<Face>& faces, const Positions& positions);
  ~Crossings();

  void insert(Index face, const Face& corners, const Positions& positions);
  void erase(Index face, const Face& corners, const Positions& positions);

  /// Whether a face with these corners, the first of which would be at `first`, runs through one of the faces, except
  /// for those among `but`, which are sorted.
  [[nodiscard]] bool any(const Face& corners, const Eigen::Vector3d& first, const std::vector<Face>& faces,
                         const Positions& positions, std::span<const Index> but) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace armature::sdk
