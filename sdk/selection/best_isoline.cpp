#include "sdk/selection/best_isoline.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>
#include <tbb/parallel_for.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// What a face adds to every isoline that crosses it.
struct Crossing {
  double gradient = 0;   ///< length of the field's
  double concavity = 0;  ///< in [-1, 1]: how much the surface bends upwards across the isoline
};

/// A face's corners with their values, ascending.
struct Ramp {
  std::array<double, 3> values;
  std::array<const Vector3d*, 3> points;

  /// How long the isoline is within the face.
  [[nodiscard]] double length(double isovalue) const {
    const bool low = isovalue < values[1];
    const std::size_t tip = low ? 0 : 2;
    const auto cross = [&](std::size_t to) {
      const double t = (isovalue - values[tip]) / (values[to] - values[tip]);
      return Vector3d(*points[tip] + t * (*points[to] - *points[tip]));
    };
    return (cross(1) - cross(low ? 2 : 0)).norm();
  }
};

Crossing crossing_of(const Surface& surface, FaceId face, std::span<const double> field, double scale) {
  const Mesh& mesh = surface.mesh;
  const Vector3d area = area_vector(mesh, face);
  const double twice = 2 * area.norm();
  if (!(twice > 0)) return {};
  const Vector3d normal = 2 * area / twice;
  std::array<Vector3d, 3> weight_gradients;
  Vector3d gradient = Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    weight_gradients[k] = normal.cross(mesh.corner(face, (k + 2) % 3) - mesh.corner(face, (k + 1) % 3)) / twice;
    gradient += field[mesh.triangle(face)[k].index()] * weight_gradients[k];
  }
  const double length = gradient.norm();
  if (!(length > 0) || !std::isfinite(length)) return {};
  const Vector3d across = gradient / length;
  double bend = 0;
  for (std::size_t k = 0; k < 3; ++k)
    bend += weight_gradients[k].dot(across) * surface.vertex_normals[mesh.triangle(face)[k].index()].dot(across);
  return {length, std::clamp(-bend * scale, -1.0, 1.0)};
}

}  // namespace

double best_isovalue(const Surface& surface, std::span<const double> field, const CutSearch& search) {
  struct Sum {
    double length = 0;
    double gradient = 0;
    double concavity = 0;
  };
  const auto count = static_cast<std::size_t>(search.isovalues);
  const double step = (search.upper - search.lower) / (search.isovalues + 1);
  const double per_step = 1 / step;
  // In blocks whose sums are added in order: the same on any number of threads.
  constexpr std::size_t kBlock = 1U << 14U;
  const std::size_t blocks = (search.faces.size() + kBlock - 1) / kBlock;
  std::vector<std::vector<Sum>> sums(blocks, std::vector<Sum>(count));
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t end = std::min(search.faces.size(), (block + 1) * kBlock);
    for (std::size_t i = block * kBlock; i < end; ++i) {
      const FaceId face = search.faces[i];
      const Triangle& corners = surface.mesh.triangle(face);
      const auto value = [&](std::size_t k) { return field[corners[k].index()]; };
      const auto [low, high] = std::minmax({value(0), value(1), value(2)});
      // The isolines in [low, high), as most faces have none.
      const auto below = [&](double v) {
        return static_cast<int>(std::clamp((v - search.lower) * per_step, 0.0, search.isovalues + 0.5));
      };
      const int from = below(low);
      const int to = below(high);
      if (from == to) continue;
      const Crossing crossing = crossing_of(surface, face, field, search.scale);
      if (!(crossing.gradient > 0)) continue;
      std::array<std::size_t, 3> order = {0, 1, 2};
      std::sort(order.begin(), order.end(), [&](std::size_t p, std::size_t q) { return value(p) < value(q); });
      Ramp ramp{};
      for (std::size_t k = 0; k < 3; ++k) {
        ramp.values[k] = value(order[k]);
        ramp.points[k] = &surface.mesh.position(corners[order[k]]);
      }
      for (int line = from + 1; line <= to; ++line) {
        const double length = ramp.length(search.lower + line * step);
        if (!std::isfinite(length)) continue;
        Sum& sum = sums[block][static_cast<std::size_t>(line) - 1];
        sum.length += length;
        sum.gradient += length * crossing.gradient;
        sum.concavity += length * crossing.gradient * crossing.concavity;
      }
    }
  });
  constexpr double kBeta = 0.5;
  constexpr double kPrior = 0.4;
  double best = 0.5 * (search.lower + search.upper);
  double best_score = -1;
  for (std::size_t line = 0; line < count; ++line) {
    Sum sum;
    for (const auto& block : sums) {
      sum.length += block[line].length;
      sum.gradient += block[line].gradient;
      sum.concavity += block[line].concavity;
    }
    if (!(sum.length > 0)) continue;
    const double isovalue = search.lower + static_cast<double>(line + 1) * step;
    const double off = 2 * isovalue - 1;
    const double score = (sum.gradient + kBeta * sum.concavity) / sum.length * (1 - kPrior * off * off);
    if (score > best_score) {
      best_score = score;
      best = isovalue;
    }
  }
  return best;
}

std::vector<FaceId> region_above(const Surface& surface, std::span<const double> field, double isovalue,
                                 std::span<const VertexId> seeds) {
  return region_about(surface, seeds, [&](FaceId face) {
    const auto& [a, b, c] = surface.mesh.triangle(face);
    return field[a.index()] + field[b.index()] + field[c.index()] > 3 * isovalue;
  });
}

std::vector<FaceId> region_about(const Surface& surface, std::span<const VertexId> seeds,
                                 const std::function<bool(FaceId)>& is_in) {
  // Every seed votes for the piece that it touches.
  std::vector<std::uint32_t> piece_of(surface.mesh.triangles.size(), 0);
  std::vector<std::vector<FaceId>> pieces;
  std::vector<std::size_t> votes;
  for (const VertexId seed : seeds) {
    for (const FaceId first : surface.adjacency.faces(seed)) {
      if (!is_in(first)) continue;
      if (piece_of[first.index()] == 0) {
        std::vector<FaceId> piece = {first};
        piece_of[first.index()] = static_cast<std::uint32_t>(pieces.size() + 1);
        for (std::size_t at = 0; at < piece.size(); ++at)
          for (const EdgeId edge : surface.adjacency.edges(piece[at]))
            for (const FaceId face : surface.adjacency.faces(edge))
              if (piece_of[face.index()] == 0 && is_in(face)) {
                piece_of[face.index()] = static_cast<std::uint32_t>(pieces.size() + 1);
                piece.push_back(face);
              }
        pieces.push_back(std::move(piece));
        votes.push_back(0);
      }
      ++votes[piece_of[first.index()] - 1];
    }
  }
  if (pieces.empty()) return {};
  const auto winner = static_cast<std::size_t>(std::max_element(votes.begin(), votes.end()) - votes.begin());
  std::vector<FaceId> region = std::move(pieces[winner]);
  std::sort(region.begin(), region.end());
  return region;
}

}  // namespace armature::sdk
