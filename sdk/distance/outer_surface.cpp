#include <algorithm>
#include <cmath>
#include <utility>

#include <armature/sdk/distance/outer_surface.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "sdk/distance/cavities.h"
#include "sdk/distance/creases.h"
#include "sdk/distance/sphere_mesh_tree_state.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kLeafSize = 4;

double squared_distance(const OuterCrease& segment, const Vector3d& point) noexcept {
  const Vector3d side = segment.b - segment.a;
  const Vector3d v = point - segment.a;
  const double length2 = side.squaredNorm();
  const double along = length2 > 0 ? std::clamp(v.dot(side) / length2, 0.0, 1.0) : 0;
  return (v - along * side).squaredNorm();
}

}  // namespace

struct OuterSurface::State {
  SphereMeshTree tree;
  const SpherePieces& shape;  // of the tree, as are the other two
  const std::vector<Piece>& pieces;
  const Bvh& piece_bvh;
  std::vector<Patch> patches;
  double diagonal;
  double depth;  // what a covered point must lie deeper than
  Cavities cavities;
  UnitFrame frame;
  CreaseOptions tracing;
  bool traces_when_asked;
  std::vector<bool> held;            // spheres, by others, where creases are traced when asked
  std::vector<OuterCrease> creases;  // in the order of their leaves
  Bvh crease_bvh;

  /// Of no use where `task` was stopped meanwhile.
  State(const SphereMesh& sphere_mesh, const OuterSurfaceOptions& options, const Task& task)
      : tree(sphere_mesh),
        shape(tree.state_->shape),
        pieces(tree.state_->pieces),
        piece_bvh(tree.state_->bvh),
        patches(patches_of(shape)),
        diagonal((shape.upper - shape.lower).norm()),
        depth(4e-8 * diagonal),
        cavities(tree, options.cavity_grid, task),
        frame(tree.state_->frame),
        tracing{.resolution = options.resolution * diagonal, .chord = options.tolerance * diagonal},
        traces_when_asked(options.creases_when_asked) {
    if (traces_when_asked) {
      held = held_spheres(shape);
    } else {
      index_creases(visible_creases(task));
    }
  }

  /// Whether a point of a patch, with its outward normal, lies on the outer surface.
  [[nodiscard]] bool outer(const Vector3d& point, const Vector3d& normal) const {
    if (tree.inside(point, depth)) return false;
    return !cavities.faces(tree, point, normal);
  }

  std::vector<OuterCrease> visible_creases(const Task& task) const {
    constexpr std::size_t kAtOnce = 256;  // between two reports
    std::vector<std::vector<OuterCrease>> found(patches.size());
    for (std::size_t first = 0; first < patches.size() && !task.stopped(); first += kAtOnce) {
      task.report("finding creases", static_cast<double>(first) / static_cast<double>(patches.size()));
      tbb::parallel_for(first, std::min(first + kAtOnce, patches.size()), [&](std::size_t k) {
        if (task.stopped()) return;
        std::vector<OuterCrease> all;
        find_creases(shape, near(patches[k]), patches[k], tracing, all);
        VoidMemory memory;
        for (const OuterCrease& segment : all) add_visible(segment, memory, found[k]);
      });
    }
    std::vector<OuterCrease> visible;
    for (const auto& part : found) visible.insert(visible.end(), part.begin(), part.end());
    return visible;
  }

  /// The pieces whose boxes meet the patch's, in the order of `shape.all()`.
  [[nodiscard]] std::vector<Piece> near(const Patch& patch) const {
    Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
    Vector3d upper = -lower;
    for (const SphereId id : patch.spheres) {
      if (!id.valid()) continue;
      lower = lower.cwiseMin((shape.sphere(id).centre.array() - shape.sphere(id).radius).matrix());
      upper = upper.cwiseMax((shape.sphere(id).centre.array() + shape.sphere(id).radius).matrix());
    }
    const UnitBox box = unit_box(frame, lower, upper);
    std::vector<Piece> close;
    piece_bvh.descend(
        0, [&](const Bvh::Node& node) { return misses(node, box); },
        [&](std::size_t first, std::size_t count) {
          for (std::size_t k = first; k < first + count; ++k) {
            const UnitBox other = shape.box_of(frame, pieces[k]);
            if ((other.lower <= box.upper).all() && (other.upper >= box.lower).all()) close.push_back(pieces[k]);
          }
          return 0.0F;
        });
    std::ranges::sort(close, {}, [](Piece piece) { return std::pair(piece.kind, piece.index); });
    return close;
  }

  /// What side of a wall a crease lies on holds for the segments that continue it.
  struct VoidMemory {
    Vector3d end = Vector3d::Constant(std::numeric_limits<double>::infinity());
    int uses = 0;
    bool in_void = false;
  };

  /// Keeps what of a crease nothing covers.
  void add_visible(const OuterCrease& segment, VoidMemory& memory, std::vector<OuterCrease>& visible) const {
    Vector3d a = segment.a;
    Vector3d b = segment.b;
    const bool a_inside = tree.inside(a, depth);
    const bool b_inside = tree.inside(b, depth);
    if (a_inside && b_inside) return;
    if (a_inside || b_inside) {
      Vector3d seen = a_inside ? b : a;
      Vector3d hidden = a_inside ? a : b;
      for (int step = 0; step < 24; ++step) {
        const Vector3d middle = (seen + hidden) / 2;
        (tree.inside(middle, 2 * tracing.chord) ? hidden : seen) = middle;
      }
      (a_inside ? a : b) = seen;
    }
    constexpr int kMostUses = 32;
    if (a != memory.end || ++memory.uses > kMostUses)
      memory = {b, 0, cavities.faces(tree, (a + b) / 2, tree.nearest((a + b) / 2).normal)};
    memory.end = b;
    if (memory.in_void) return;
    visible.push_back({a, b});
  }

  void index_creases(const std::vector<OuterCrease>& visible) {
    std::vector<UnitBox> boxes;
    boxes.reserve(visible.size());
    for (const OuterCrease& s : visible) boxes.push_back(unit_box(frame, s.a.cwiseMin(s.b), s.a.cwiseMax(s.b)));
    crease_bvh = Bvh(boxes, kLeafSize);
    creases.reserve(visible.size());
    for (const std::uint32_t k : crease_bvh.order()) creases.push_back(visible[k]);
  }

  /// The least distance that was found so far.
  struct Least {
    const Eigen::Vector3f place;  // in the unit frame
    const double to_unit;
    double distance = std::numeric_limits<double>::infinity();

    [[nodiscard]] float limit() const noexcept {
      const double there = distance * to_unit;
      return static_cast<float>(there * there) * (1 + Bvh::kSlack);
    }
  };
  [[nodiscard]] double distance_within(const Vector3d& point) const;
  void look_at_creases(const Vector3d& point, Least& least) const noexcept;
  void look_at_pieces(const Vector3d& point, Least& least) const;
  void trace_creases(const Vector3d& point, Least& least) const;
};

double OuterSurface::State::distance_within(const Vector3d& point) const {
  Least least{frame.to_unit(point), frame.scale};
  if (!traces_when_asked) {
    look_at_creases(point, least);
    look_at_pieces(point, least);
  } else {
    look_at_pieces(point, least);
    if (least.distance > std::abs(tree.signed_distance(point))) trace_creases(point, least);
  }
  return least.distance;
}

void OuterSurface::State::look_at_creases(const Vector3d& point, Least& least) const noexcept {
  crease_bvh.descend(
      least.limit(), [&](const Bvh::Node& node) { return squared_distances(node, least.place); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k)
          least.distance = std::min(least.distance, std::sqrt(squared_distance(creases[k], point)));
        return least.limit();
      });
}

void OuterSurface::State::look_at_pieces(const Vector3d& point, Least& least) const {
  const auto offer = [&](const Vector3d& normal, double distance) {
    if (distance < least.distance && outer(point + distance * normal, normal)) least.distance = distance;
  };
  piece_bvh.descend(
      least.limit(), [&](const Bvh::Node& node) { return squared_distances(node, least.place); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k) {
          const Piece piece = pieces[k];
          if (piece.kind == Piece::Kind::Facet) {
            // A ball may reach a facet from anywhere below its plane.
            const FacetGauge& facet = shape.facets[piece.index];
            for (const double sign : {1.0, -1.0}) {
              const Vector3d normal = facet.normal(sign);
              const double distance = facet.radius_a - normal.dot(point - facet.a);
              if (distance < 0 || distance >= least.distance || !facet.holds_foot(point, normal, distance)) continue;
              offer(normal, distance);
            }
          } else {
            const PieceDistance d = distance_to(shape, piece, point);
            const EdgeGauge& edge = shape.edges[piece.index];
            if (d.distance <= 0) {
              // A ball that touches a sphere or cone from inside lies between its middle and its surface.
              if (-d.distance < least.distance) offer(normal_at(shape, d, point), -d.distance);
            } else if (edge.radius_a == 0 && edge.radius_b == 0 && d.distance < least.distance) {
              // A line without thickness has no patch, and facets that meet in it no crease.
              offer(-normal_at(shape, d, point), d.distance);
            }
          }
        }
        return least.limit();
      });
}

/// The creases that come nearer than the least so far, patch by patch from the nearest on.
void OuterSurface::State::trace_creases(const Vector3d& point, Least& least) const {
  std::vector<std::uint32_t> known;  // spheres that were looked at: each is on several edges
  const auto trace = [&](const Patch& patch) {
    if (patch.kind == Patch::Kind::Sphere) {
      if (std::ranges::find(known, patch.index) != known.end()) return;
      known.push_back(patch.index);
    }
    CreaseOptions nearby = tracing;
    nearby.place = point;
    nearby.within = least.distance;
    std::vector<OuterCrease> all;
    find_creases(shape, near(patch), patch, nearby, all);
    VoidMemory memory;
    std::vector<OuterCrease> visible;
    for (const OuterCrease& segment : all) {
      if (!(std::sqrt(squared_distance(segment, point)) < least.distance)) continue;
      visible.clear();
      add_visible(segment, memory, visible);
      for (const OuterCrease& seen : visible)
        least.distance = std::min(least.distance, std::sqrt(squared_distance(seen, point)));
    }
  };
  piece_bvh.descend(
      least.limit(), [&](const Bvh::Node& node) { return squared_distances(node, least.place); },
      [&](std::size_t first, std::size_t count) {
        for (std::size_t k = first; k < first + count; ++k)
          for (const Patch& patch : patches_of(shape, pieces[k], held)) trace(patch);
        return least.limit();
      });
}

OuterSurface::OuterSurface(const SphereMesh& shape, const OuterSurfaceOptions& options)
    : state_(std::make_unique<const State>(shape, options, Task())) {}
OuterSurface::OuterSurface(std::unique_ptr<const State> state) : state_(std::move(state)) {}

Expected<OuterSurface> OuterSurface::build(const SphereMesh& shape, const OuterSurfaceOptions& options,
                                           const Task& task) {
  auto state = std::make_unique<const State>(shape, options, task);
  if (task.stopped()) return cancelled();
  return OuterSurface(std::move(state));
}

OuterSurface::~OuterSurface() = default;
OuterSurface::OuterSurface(OuterSurface&&) noexcept = default;
OuterSurface& OuterSurface::operator=(OuterSurface&&) noexcept = default;

double OuterSurface::signed_distance(const Vector3d& point) const {
  const State& s = *state_;
  const double distance = s.tree.signed_distance(point);
  if (distance >= 0 && !s.cavities.holds(s.tree, point)) return distance;
  return -s.distance_within(point);
}

std::vector<OuterSample> OuterSurface::sample(std::size_t count) const {
  const State& s = *state_;
  std::vector<double> area_before{0};
  for (const Patch& patch : s.patches) area_before.push_back(area_before.back() + area_of(s.shape, patch));
  const double total = area_before.back();
  std::vector<OuterSample> samples;
  if (!(total > 0) || count == 0) return samples;

  // Candidates on all patches, of which those that nothing covers are kept. How many that will be is tried first.
  const auto draw = [&](double candidates) {
    struct Span {
      std::size_t first, end;
    };
    std::vector<Span> spans(s.patches.size());
    for (std::size_t k = 0; k < spans.size(); ++k)
      spans[k] = {static_cast<std::size_t>(candidates * (area_before[k] / total)),
                  static_cast<std::size_t>(candidates * (area_before[k + 1] / total))};
    std::vector<std::vector<OuterSample>> parts(s.patches.size());
    tbb::parallel_for(std::size_t{0}, spans.size(), [&](std::size_t k) {
      const Patch& patch = s.patches[k];
      for (std::size_t i = spans[k].first; i < spans[k].end; ++i) {
        // The R2 sequence (Roberts 2018): each stretch of it fills the square evenly.
        const double n = static_cast<double>(i);
        const double u = std::fmod(0.5 + n * 0.7548776662466927, 1.0);
        const double v = std::fmod(0.5 + n * 0.5698402909980532, 1.0);
        const Vector3d parameter = spread(s.shape, patch, u, v);
        const PatchPoint x = at(s.shape, patch, parameter);
        if (s.outer(x.point, x.normal))
          parts[k].push_back({x.point, x.normal, patch.spheres, weights_at(s.shape, patch, parameter)});
      }
    });
    std::vector<OuterSample> kept;
    for (const auto& part : parts) kept.insert(kept.end(), part.begin(), part.end());
    return kept;
  };
  const double trial = static_cast<double>(std::max<std::size_t>(count / 8, 4096));
  samples = draw(trial);
  if (samples.size() >= count) return samples;
  const double share = std::max(static_cast<double>(samples.size()) / trial, 1e-3);
  return draw(static_cast<double>(count) / share);
}

const std::vector<OuterCrease>& OuterSurface::creases() const noexcept {
  return state_->creases;
}

bool OuterSurface::has_cavities() const noexcept {
  return state_->cavities.any();
}

const SphereMeshTree& OuterSurface::tree() const noexcept {
  return state_->tree;
}

}  // namespace armature::sdk
