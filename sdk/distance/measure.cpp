#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <armature/sdk/distance/measure.h>
#include <armature/sdk/distance/mesh_tree.h>
#include <armature/sdk/distance/outer_surface.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

/// The largest and the mean of many distances.
struct Distances {
  double largest = 0;
  double sum = 0;
  std::size_t count = 0;

  void add(const Distances& other) noexcept {
    largest = std::max(largest, other.largest);
    sum += other.sum;
    count += other.count;
  }
  [[nodiscard]] double mean() const noexcept { return count > 0 ? sum / static_cast<double>(count) : 0; }
};

/// Distances of all points, added up in blocks so that threads do not change the sum. Nothing if asked to stop.
template <class Distance>
std::optional<Distances> distances(std::span<const Vector3d> points, Distance&& distance, const Task& task,
                                   std::string_view stage) {
  constexpr std::size_t kBlock = 1024;
  constexpr std::size_t kBlocksAtOnce = 32;
  const std::size_t blocks = (points.size() + kBlock - 1) / kBlock;
  std::vector<Distances> found(blocks);
  for (std::size_t first = 0; first < blocks; first += kBlocksAtOnce) {
    if (task.stopped()) return std::nullopt;
    task.report(stage, static_cast<double>(first) / static_cast<double>(blocks));
    tbb::parallel_for(first, std::min(first + kBlocksAtOnce, blocks), [&](std::size_t block) {
      const auto part = points.subspan(block * kBlock, std::min(kBlock, points.size() - block * kBlock));
      found[block] = distance(part);
    });
  }
  Distances all;
  for (const Distances& part : found) all.add(part);
  return all;
}

/// Distances to a mesh; each search begins with the face that the last one found.
auto to_mesh(const MeshTree& tree) {
  return [&tree](std::span<const Vector3d> points) {
    Distances result;
    FaceId last;
    for (const Vector3d& point : points) {
      const SurfacePoint nearest = tree.closest(point, {.hint = last});
      last = nearest.face;
      result.add({nearest.distance, nearest.distance, 1});
    }
    return result;
  };
}

/// Distances that do not depend on the points before.
template <class Distance>
auto at_each(Distance distance) {
  return [distance](std::span<const Vector3d> points) {
    Distances result;
    for (const Vector3d& point : points) {
      const double at = distance(point);
      result.add({at, at, 1});
    }
    return result;
  };
}

std::vector<Vector3d> corners_of_faces(const Mesh& mesh) {
  std::vector<bool> used(mesh.positions.size(), false);
  for (const Triangle& triangle : mesh.triangles)
    for (const VertexId v : triangle) used[v.index()] = true;
  std::vector<Vector3d> corners;
  for (std::size_t k = 0; k < used.size(); ++k)
    if (used[k]) corners.push_back(mesh.positions[k]);
  return corners;
}

/// What is measured with on one side: points that the mean is over, and more that only the largest is over.
struct Probes {
  std::vector<Vector3d> even;
  std::vector<Vector3d> extreme;
};

Probes probes_of(const Mesh& mesh, std::size_t samples) {
  return {sample_surface(mesh, samples), corners_of_faces(mesh)};
}

Probes probes_of(const OuterSurface& surface, std::size_t samples) {
  Probes probes;
  for (const OuterSample& s : surface.sample(samples)) probes.even.push_back(s.point);
  // Creases come as far more points than samples are needed on curves.
  const std::vector<OuterCrease>& creases = surface.creases();
  const std::size_t step = std::max<std::size_t>(1, creases.size() / std::max<std::size_t>(1, samples / 8));
  for (std::size_t k = 0; k < creases.size(); k += step) probes.extreme.push_back(creases[k].a);
  return probes;
}

/// The three errors, given how to measure towards either side, and from the extremes of the input.
template <class ToApproximation, class FromExtremes, class ToInput>
Expected<ApproximationErrors> compare(const Probes& input, const Probes& approximation, double diagonal,
                                      ToApproximation&& to_approximation, FromExtremes&& from_extremes,
                                      ToInput&& to_input, const Task& task) {
  const auto there = distances(input.even, to_approximation, task, "measuring input to approximation");
  if (!there) return cancelled();
  const auto there_extreme = distances(input.extreme, from_extremes, task, "measuring vertices");
  if (!there_extreme) return cancelled();
  const auto back = distances(approximation.even, to_input, task, "measuring approximation to input");
  if (!back) return cancelled();
  const auto back_extreme = distances(approximation.extreme, to_input, task, "measuring creases");
  if (!back_extreme) return cancelled();
  const double percent = 100 / diagonal;
  return ApproximationErrors{
      .hausdorff = percent * std::max({there->largest, there_extreme->largest, back->largest, back_extreme->largest}),
      .mean_input_to_approximation = percent * there->mean(),
      .mean_approximation_to_input = percent * back->mean()};
}

Expected<double> diagonal_of_input(const Mesh& input) {
  if (input.triangles.empty()) return fail("the input has no faces: expected a triangle mesh");
  const double diagonal = bounding_box_diagonal(input);
  if (!(diagonal > 0)) return fail("the input has no size: all of its vertices lie at one point");
  return diagonal;
}

/// `take(face, point)` is called with every sample, face by face; false if the mesh has no area.
template <class Take>
bool for_samples(const Mesh& mesh, std::size_t count, Take&& take) {
  const std::vector<double> areas = face_areas(mesh);
  double total = 0;
  for (const double area : areas) total += area;
  if (!(total > 0)) return false;
  double before = 0;
  for (std::size_t f = 0; f < areas.size(); ++f) {
    const auto share = [&](double area) {
      return static_cast<std::size_t>(static_cast<double>(count) * (area / total));
    };
    const std::size_t first = share(before);
    before += areas[f];
    const std::size_t end = share(before);
    for (std::size_t i = first; i < end; ++i) {
      // The R2 sequence (Roberts 2018), folded into the triangle: any stretch of it is spread evenly.
      double u = std::fmod(0.5 + static_cast<double>(i) * 0.7548776662466927, 1.0);
      double v = std::fmod(0.5 + static_cast<double>(i) * 0.5698402909980532, 1.0);
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      take(FaceId(f), Vector3d((1 - u - v) * mesh.corner(FaceId(f), 0) + u * mesh.corner(FaceId(f), 1) +
                               v * mesh.corner(FaceId(f), 2)));
    }
  }
  return true;
}

}  // namespace

std::vector<Vector3d> sample_surface(const Mesh& mesh, std::size_t count) {
  std::vector<Vector3d> points;
  points.reserve(count + 1);
  if (!for_samples(mesh, count, [&](FaceId, const Vector3d& point) { points.push_back(point); }))
    return corners_of_faces(mesh);
  return points;
}

PointSet sample_points(const Mesh& mesh, std::size_t count) {
  PointSet points;
  if (for_samples(mesh, count, [&](FaceId face, const Vector3d& point) {
        points.positions.push_back(point);
        points.normals.push_back(area_vector(mesh, face).normalized());
      }))
    return points;
  points.positions = corners_of_faces(mesh);
  points.normals.assign(points.positions.size(), Vector3d::Zero());
  return points;
}

Expected<ApproximationErrors> measure(const Mesh& input, const SphereMesh& approximation, const MeasureOptions& options,
                                      const Task& task) {
  const auto diagonal = diagonal_of_input(input);
  if (!diagonal) return tl::unexpected(diagonal.error());
  if (approximation.spheres.empty()) return fail("the approximation has no spheres: expected one at least");
  std::optional<Expected<OuterSurface>> built;
  std::optional<MeshTree> tree;
  tbb::parallel_invoke([&] { built = OuterSurface::build(approximation, {.creases_when_asked = options.quick}, task); },
                       [&] { tree.emplace(input); });
  if (!*built) return tl::unexpected(built->error());
  const OuterSurface& surface = **built;
  const auto exactly = at_each([&](const Vector3d& point) { return std::abs(surface.signed_distance(point)); });
  // The nearest piece's surface may lie within.
  const auto at_least = at_each([&](const Vector3d& point) { return std::abs(surface.tree().signed_distance(point)); });
  const auto from = [&](auto&& from_extremes) {
    return compare(probes_of(input, options.samples), probes_of(surface, options.samples), *diagonal, exactly,
                   from_extremes, to_mesh(*tree), task);
  };
  return options.quick ? from(at_least) : from(exactly);
}

Expected<ApproximationErrors> measure(const Mesh& input, const Mesh& approximation, const MeasureOptions& options,
                                      const Task& task) {
  const auto diagonal = diagonal_of_input(input);
  if (!diagonal) return tl::unexpected(diagonal.error());
  if (approximation.triangles.empty()) return fail("the approximation has no faces: expected a triangle mesh");
  const MeshTree input_tree(input);
  const MeshTree tree(approximation);
  return compare(probes_of(input, options.samples), probes_of(approximation, options.samples), *diagonal, to_mesh(tree),
                 to_mesh(tree), to_mesh(input_tree), task);
}

}  // namespace armature::sdk
