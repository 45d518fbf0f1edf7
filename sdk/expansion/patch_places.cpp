#include "sdk/expansion/patch_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <unordered_map>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kApart = 0.75;     // centres of candidates, of the radius
constexpr double kSamePlace = 0.5;  // the same of candidates of different sizes
constexpr std::size_t kSizes = 2;   // that are tried of one place

/// Numbered points in cells as wide as a reach, so that 27 of them hold what lies within it of a point.
class NearPoints {
 public:
  explicit NearPoints(double reach) : reach_(reach) {}

  void add(const Vector3d& point, std::size_t number) { cells_[cell_of(point)].push_back(number); }

  /// How many of the points in the cells about one are `counted`.
  template <class Counted>
  [[nodiscard]] std::size_t count_about(const Vector3d& point, Counted&& counted) const {
    std::size_t count = 0;
    const Cell middle = cell_of(point);
    for (int shift = 0; shift < 27; ++shift) {
      const auto found =
          cells_.find({middle[0] + shift % 3 - 1, middle[1] + shift / 3 % 3 - 1, middle[2] + shift / 9 - 1});
      if (found != cells_.end()) count += static_cast<std::size_t>(std::ranges::count_if(found->second, counted));
    }
    return count;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Hash {
    std::size_t operator()(const Cell& cell) const noexcept {
      std::uint64_t hash = 0;
      for (const std::int64_t at : cell) hash = (hash ^ static_cast<std::uint64_t>(at)) * 0x9E3779B97F4A7C15U;
      return hash ^ (hash >> 32U);
    }
  };

  [[nodiscard]] Cell cell_of(const Vector3d& point) const {
    const Vector3d at = (point / reach_).array().floor();
    return {static_cast<std::int64_t>(at.x()), static_cast<std::int64_t>(at.y()), static_cast<std::int64_t>(at.z())};
  }

  double reach_;
  std::unordered_map<Cell, std::vector<std::size_t>, Hash> cells_;
};

}  // namespace

std::vector<PatchPlace> maxima(const Surface& surface, std::span<const float> similarity, double radius, double scale) {
  const auto better = [&](VertexId a, VertexId b) {
    return similarity[a.index()] != similarity[b.index()] ? similarity[a.index()] > similarity[b.index()] : a < b;
  };
  std::vector<VertexId> tops;
  for (std::size_t i = 0; i < similarity.size(); ++i) {
    const VertexId vertex(i);
    if (similarity[i] > 0 && std::ranges::none_of(surface.adjacency.neighbours(vertex),
                                                  [&](VertexId other) { return better(other, vertex); }))
      tops.push_back(vertex);
  }
  std::ranges::sort(tops, better);
  std::vector<PatchPlace> places;
  const double apart = kApart * radius;
  NearPoints taken(apart);
  for (const VertexId top : tops) {
    const Vector3d& p = surface.mesh.position(top);
    const auto is_near = [&](std::size_t i) {
      return (surface.mesh.position(places[i].centre) - p).squaredNorm() < apart * apart;
    };
    if (taken.count_about(p, is_near) > 0) continue;
    taken.add(p, places.size());
    places.push_back({top, scale, similarity[top.index()]});
  }
  return places;
}

RankedPlaces ranked(const Surface& surface, std::span<const PatchPlace> places, double radius) {
  if (places.empty()) return {};
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::greater{}, [&](std::size_t i) { return places[i].similarity; });
  RankedPlaces result;
  const double same_place = kSamePlace * radius;
  NearPoints first(same_place * std::ranges::max(places, {}, &PatchPlace::scale).scale);
  for (const std::size_t i : order) {
    const Vector3d& p = surface.mesh.position(places[i].centre);
    const auto is_this_of_another_size = [&](std::size_t j) {
      return places[i].scale != places[j].scale && (surface.mesh.position(places[j].centre) - p).norm() <
                                                       same_place * std::min(places[i].scale, places[j].scale);
    };
    if (first.count_about(p, is_this_of_another_size) < kSizes) {
      first.add(p, i);
      result.first.push_back(i);
    } else {
      result.others.push_back(i);
    }
  }
  return result;
}

}  // namespace armature::sdk
