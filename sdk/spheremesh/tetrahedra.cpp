#include "sdk/spheremesh/tetrahedra.h"

#include <algorithm>

namespace armature::sdk {
namespace {

constexpr std::uint32_t kCube = 1U << 15;  // lattice places along a cube: each may be halved so often

}  // namespace

Tetrahedra::Tetrahedra(const Eigen::Vector3d& origin, double spacing, const std::array<int, 3>& counts)
    : origin_(origin), unit_(spacing / kCube) {
  // Kuhn's tetrahedra: paths along the axes from one corner of the cube to the opposite one.
  constexpr std::array<std::array<std::size_t, 3>, 6> kPaths{
      {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
  for (int z = 0; z < counts[2]; ++z)
    for (int y = 0; y < counts[1]; ++y)
      for (int x = 0; x < counts[0]; ++x)
        for (const auto& path : kPaths) {
          std::array<std::uint32_t, 3> place{static_cast<std::uint32_t>(x) * kCube,
                                             static_cast<std::uint32_t>(y) * kCube,
                                             static_cast<std::uint32_t>(z) * kCube};
          Tet tet;
          tet.corners[0] = corner_at(place);
          for (std::size_t k = 0; k < 3; ++k) {
            place[path[k]] += kCube;
            tet.corners[k + 1] = corner_at(place);
          }
          add(tet);
        }
}

Tetrahedra::CornerId Tetrahedra::corner_at(const std::array<std::uint32_t, 3>& place) {
  const std::uint64_t key = static_cast<std::uint64_t>(place[0]) | static_cast<std::uint64_t>(place[1]) << 21 |
                            static_cast<std::uint64_t>(place[2]) << 42;
  const auto [found, added] = by_place_.try_emplace(key, static_cast<CornerId>(corners_.size()));
  if (added) {
    places_.push_back(place);
    corners_.push_back(origin_ + unit_ * Eigen::Vector3d(place[0], place[1], place[2]));
    around_.emplace_back();
  }
  return found->second;
}

void Tetrahedra::add(const Tet& tet) {
  const auto id = static_cast<TetId>(tets_.size());
  tets_.push_back(tet);
  for (const CornerId corner : tet.corners) around_[corner].push_back(id);
}

void Tetrahedra::halve(TetId id) {
  if (!tets_[id].whole) return;
  const CornerId a = tets_[id].corners[0];
  const CornerId b = tets_[id].corners[tets_[id].mark];
  // Everyone around the edge must have it marked.
  for (bool settled = false; !settled;) {
    settled = true;
    for (const TetId other : around_[a]) {
      const Tet& t = tets_[other];
      if (std::find(t.corners.begin(), t.corners.end(), b) == t.corners.end()) continue;
      const CornerId from = t.corners[0];
      const CornerId to = t.corners[t.mark];
      if ((from == a && to == b) || (from == b && to == a)) continue;
      halve(other);
      settled = false;
      break;
    }
  }
  std::vector<TetId> ring;
  for (const TetId other : around_[a]) {
    const Tet& t = tets_[other];
    if (std::find(t.corners.begin(), t.corners.end(), b) != t.corners.end()) ring.push_back(other);
  }
  std::array<std::uint32_t, 3> place{};
  for (std::size_t axis = 0; axis < 3; ++axis) place[axis] = (places_[a][axis] + places_[b][axis]) / 2;
  const CornerId middle = corner_at(place);
  for (const TetId other : ring) split(other, middle);
}

void Tetrahedra::split(TetId id, CornerId middle) {
  const Tet tet = tets_[id];
  tets_[id].whole = false;
  for (const CornerId corner : tet.corners) {
    auto& list = around_[corner];
    list.erase(std::find(list.begin(), list.end(), id));
  }
  Tet first = tet;
  first.corners[tet.mark] = middle;
  Tet second = tet;
  for (std::size_t k = 0; k < tet.mark; ++k) second.corners[k] = tet.corners[k + 1];
  second.corners[tet.mark] = middle;
  for (Tet* half : {&first, &second}) {
    half->mark = tet.mark == 1 ? 3 : static_cast<std::uint8_t>(tet.mark - 1);
    half->whole = true;
    add(*half);
  }
}

}  // namespace armature::sdk
