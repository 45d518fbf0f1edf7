#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/mesh/measures.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "sdk/expansion/part_registration.h"
#include "sdk/expansion/region_shares.h"
#include "sdk/expansion/ring_cut.h"
#include "sdk/selection/flood.h"
#include "sdk/selection/level_tree.h"

namespace armature::sdk {
namespace {

using Eigen::Index;

/// The node of the tree that is most like the part: among those with its tip, the one of the next area.
std::optional<std::uint32_t> node_of(const PartModel& model, const LevelTree& tree, std::span<const FaceId> part) {
  const Mesh& mesh = model.surface().mesh;
  const Eigen::VectorXd& phi = model.conformal_factor();
  VertexId tip = mesh.triangle(part.front())[0];
  double area = 0;
  for (const FaceId face : part) {
    area += area_vector(mesh, face).norm();
    for (const VertexId v : mesh.triangle(face))
      if (phi[static_cast<Index>(v.index())] > phi[static_cast<Index>(tip.index())]) tip = v;
  }
  std::optional<std::uint32_t> best;
  double best_ratio = 0;
  for (std::uint32_t n = 0; n < tree.nodes().size(); ++n) {
    const LevelNode& node = tree.nodes()[n];
    if (node.tip != tip) continue;
    const double ratio = std::min(node.area / area, area / node.area);
    if (ratio <= best_ratio) continue;
    best = n;
    best_ratio = ratio;
  }
  constexpr double kLeastRatio = 0.5;
  return best_ratio > kLeastRatio ? best : std::nullopt;
}

/// A node of a tree.
struct NodeOf {
  const LevelTree& tree;
  std::uint32_t number;
  [[nodiscard]] const LevelNode& operator*() const { return tree.nodes()[number]; }
};

/// How unlike a node's girth runs to the reference's, which may be another tree's, as their sizes and the distances
/// from the cut are measured in girths: mean |log| over the way towards the tip, and a little on the other side.
class GirthProfile {
 public:
  GirthProfile(const LevelTree& tree, NodeOf reference) : tree_(tree), reference_(*reference) {
    for (int i = 0; i < kSteps; ++i) {
      ways_[static_cast<std::size_t>(i)] = (kFrom + (kTo - kFrom) * i / (kSteps - 1)) * radius(reference_);
      girths_[static_cast<std::size_t>(i)] =
          reference.tree.girth_at(reference.number, ways_[static_cast<std::size_t>(i)]);
    }
  }

  [[nodiscard]] double scale(std::uint32_t node) const { return tree_.nodes()[node].girth / reference_.girth; }

  [[nodiscard]] double unlikeness(std::uint32_t node) const {
    const double s = scale(node);
    double sum = 0;
    for (std::size_t i = 0; i < ways_.size(); ++i) sum += unlike(tree_.girth_at(node, s * ways_[i]) / s, girths_[i]);
    constexpr double kLength = 0.1;  // so much does the distance to the tip matter
    constexpr double kScale = 0.1;   // and the size: what tapers is like itself at every size
    return sum / kSteps + kLength * unlike(tree_.nodes()[node].along / s, reference_.along) + kScale * unlike(s, 1);
  }

 private:
  static constexpr int kSteps = 24;
  static constexpr double kFrom = -3;  // in radii, towards the tip
  static constexpr double kTo = 2;

  static double radius(const LevelNode& node) { return node.girth / (2 * std::numbers::pi); }
  static double unlike(double a, double b) {
    if (!(a > 0) || !(b > 0)) return a > 0 || b > 0 ? 1 : 0;
    return std::min(1.0, std::abs(std::log(a / b)));
  }

  const LevelTree& tree_;
  const LevelNode& reference_;
  std::array<double, kSteps> ways_{};
  std::array<double, kSteps> girths_{};
};

/// The nodes whose girth runs most like the reference's, no two of which share a region.
std::vector<std::uint32_t> likely_nodes(const LevelTree& tree, NodeOf reference, const ExpandPartOptions& options) {
  const GirthProfile profile(tree, reference);
  const LevelNode& wanted = *reference;
  std::vector<double> unlikeness(tree.nodes().size(), -1);
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(unlikeness.size()), [&](std::uint32_t n) {
    const double s = profile.scale(n);
    if (!(s <= options.largest_scale) || !(s >= 1 / options.largest_scale)) return;
    // What does not reach out at all is a spot on the body.
    constexpr double kLeastLength = 0.25;
    if (tree.nodes()[n].along < kLeastLength * s * wanted.along) return;
    if (&tree == &reference.tree && tree.nested(n, reference.number)) return;
    unlikeness[n] = profile.unlikeness(n);
  });
  std::vector<std::pair<double, std::uint32_t>> costs;
  for (std::uint32_t n = 0; n < unlikeness.size(); ++n)
    if (unlikeness[n] >= 0) costs.emplace_back(unlikeness[n], n);
  std::sort(costs.begin(), costs.end());
  std::vector<std::uint32_t> chosen;
  for (const auto& [cost, n] : costs) {
    if (chosen.size() >= options.most_matches) break;
    if (std::none_of(chosen.begin(), chosen.end(),
                     [&, node = n](std::uint32_t other) { return tree.nested(node, other); }))
      chosen.push_back(n);
  }
  return chosen;
}

/// How a part is described: three spreads of its area, a third of the mass each, over the conformal factor above its
/// value at the cut, over the distance from the cut, and over the girth there; the last two by the cut's radius. The
/// units are the reference's.
class PartDescriptor {
 public:
  PartDescriptor(const PartModel& of, const LevelNode& reference)
      : height_(kOver * (of.conformal_factor()[static_cast<Index>(reference.tip.index())] - reference.level)),
        length_(kOver * reference.along / reference.girth) {}

  [[nodiscard]] Histogram describe(const PartModel& model, std::uint32_t node, std::span<const FaceId> part) const {
    Histogram factor(kBins, 0);
    Histogram distance(kBins, 0);
    Histogram girth(kBins, 0);
    const Mesh& mesh = model.surface().mesh;
    const Eigen::VectorXd& phi = model.conformal_factor();
    const auto& nodes = model.level_tree().nodes();
    const LevelNode& own = nodes[node];
    for (const FaceId face : part) {
      double mean = 0;
      for (const VertexId v : mesh.triangle(face)) mean += phi[static_cast<Index>(v.index())] / 3;
      add(factor, (mean - own.level) / height_, area_vector(mesh, face).norm());
    }
    for (std::uint32_t n = node; n != LevelNode::kNone; n = nodes[n].main_child) {
      const LevelNode& at = nodes[n];
      const double beyond = at.main_child == LevelNode::kNone ? 0 : nodes[at.main_child].area;
      add(distance, (own.along - at.along) / own.girth / length_, at.area - beyond);
      add(girth, 0.5 * at.girth / own.girth, at.area - beyond);
    }
    Histogram all;
    for (Histogram* part_of : {&factor, &distance, &girth}) {
      normalise(*part_of);
      all.insert(all.end(), part_of->begin(), part_of->end());
    }
    normalise(all);
    return all;
  }

 private:
  static constexpr std::size_t kBins = 16;
  static constexpr double kOver = 1.5;

  /// Between the middles of the two nearest bins.
  static void add(Histogram& histogram, double at, double mass) {
    const double place = std::clamp(at * kBins - 0.5, 0.0, kBins - 1.0);
    const auto low = std::min(static_cast<std::size_t>(place), kBins - 2);
    const double high_share = place - static_cast<double>(low);
    histogram[low] += static_cast<float>((1 - high_share) * mass);
    histogram[low + 1] += static_cast<float>(high_share * mass);
  }

  double height_;
  double length_;
};

constexpr double kReach = 1;            // of the rings about a virtual stroke, in offsets
constexpr double kCarryReach = 0.25;    // how far from there a copy's cut may lie, in girths
constexpr double kCopy = 0.02;          // how closely a copy fits, in roots of the area
constexpr double kCopyAboutCut = 0.02;  // how closely another one does about the cut, in girths
constexpr std::size_t kSamples = 120;   // points that are laid onto the reference

/// About `count` of the middles of faces, evenly in their order.
std::vector<Eigen::Vector3d> middles(const Mesh& mesh, std::span<const FaceId> faces, std::size_t count) {
  std::vector<Eigen::Vector3d> points;
  const std::size_t step = std::max<std::size_t>(1, faces.size() / count);
  for (std::size_t i = step / 2; i < faces.size(); i += step)
    points.emplace_back((mesh.corner(faces[i], 0) + mesh.corner(faces[i], 1) + mesh.corner(faces[i], 2)) / 3);
  return points;
}

/// About `count` of the places of vertices, evenly in their order.
std::vector<Eigen::Vector3d> some_of(const Mesh& mesh, std::span<const VertexId> vertices, std::size_t count) {
  std::vector<Eigen::Vector3d> points;
  const std::size_t step = std::max<std::size_t>(1, vertices.size() / count);
  for (std::size_t i = step / 2; i < vertices.size(); i += step) points.push_back(mesh.position(vertices[i]));
  return points;
}

std::string in_percent(double share) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%.0f %%", 100 * share);
  return text.data();
}

/// A candidate's way from a node to a part.
struct Solved {
  std::vector<FaceId> faces = {};
  PartFit laid = {};
  Histogram histogram = {};
  bool copy = false;  ///< of the reference, moved, scaled or mirrored
};

}  // namespace

Expected<Expansion> expand_part(const PartModel& model, std::span<const FaceId> part, const ExpandPartOptions& options,
                                const Task& task) {
  return expand_part(model, model, part, options, task);
}

Expected<Expansion> expand_part(const PartModel& model, const PartModel& of, std::span<const FaceId> part,
                                const ExpandPartOptions& options, const Task& task) {
  if (part.empty()) return fail("no part to compare with: it has no faces");
  const Surface& surface = model.surface();
  const Mesh& mesh = surface.mesh;
  const LevelTree& tree = model.level_tree();
  if (task.stopped()) return cancelled();
  std::vector<FaceId> reference(part.begin(), part.end());
  const FaceId place = &of == &model ? part[part.size() / 2] : FaceId(0);  // of what is said about the reference
  const auto reference_node = node_of(of, of.level_tree(), part);
  if (!reference_node)
    return Expansion(std::move(reference), {},
                     {{&of == &model ? part[part.size() / 2] : FaceId(0),
                       "nothing is compared: the part is not a protrusion around one tip"}});

  const std::vector<std::uint32_t> nodes = likely_nodes(tree, {of.level_tree(), *reference_node}, options);
  if (nodes.empty())
    return Expansion(
        std::move(reference), {},
        {{place, "nothing is compared: no other protrusion is a quarter as long for its width, and between " +
                     in_percent(1 / options.largest_scale) + " and " + in_percent(options.largest_scale) +
                     " as wide as the part"}});
  const RegionShares shares(of.surface(), part);
  RingCut around_reference(of);
  const LevelNode& reference_root = of.level_tree().nodes()[*reference_node];
  const PartRegistration onto_reference(
      of.surface(), part, around_reference.ring_around(reference_root, kCarryReach * reference_root.girth).near);
  const PartDescriptor descriptor(of, reference_root);
  const Histogram wanted = descriptor.describe(of, *reference_node, part);

  task.report("parts", 0);
  std::vector<Solved> solved(nodes.size());
  tbb::enumerable_thread_specific<RingCut> cutters([&] { return RingCut(model); });
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    if (task.stopped()) return;
    RingCut& cutter = cutters.local();
    const LevelNode& node = tree.nodes()[nodes[i]];
    Solved& result = solved[i];
    result.faces = cutter.cut(node, cutter.ring_around(node, kReach * model.offset(node.through)));
    if (result.faces.empty()) return;
    const PartFrame frame = frame_of(surface, result.faces);
    const PartFrame& wanted_frame = onto_reference.frame();
    const double girth_scale = reference_root.girth / node.girth;
    result.laid = onto_reference.lay(frame, girth_scale, middles(mesh, result.faces, kSamples));
    // What is like the reference as a whole, or else about the cut, ends where the reference does.
    const Ring ring = cutter.ring_around(node, std::max(kReach * model.offset(node.through), kCarryReach * node.girth));
    result.copy = result.laid.residual < kCopy * wanted_frame.size;
    const auto about_cut = some_of(mesh, ring.near, kSamples);
    PartFit carry = result.copy ? onto_reference.refine(result.laid, about_cut)
                                : onto_reference.lay(frame, girth_scale, about_cut);
    if (result.copy) {
      // All of a copy is a better witness than the cut's surroundings, unless these say clearly otherwise: it is bent.
      constexpr double kClearly = 0.6;
      PartFit whole = result.laid;
      whole.residual = onto_reference.residual(whole.reference_from_part, about_cut);
      if (carry.residual > kClearly * whole.residual) carry = whole;
    }
    if (carry.residual < kCopyAboutCut * reference_root.girth) {
      const std::vector<FaceId> band = cutter.band(ring);
      std::vector<bool> is_in;
      SurfacePoint on;
      for (const FaceId face : band) {
        const Eigen::Vector4d p = carry.reference_from_part * middle(mesh, face).homogeneous();
        on = of.surface().tree.closest(p.head<3>(), {.hint = on.face});
        is_in.push_back(shares.at(on) > 0.5);
      }
      std::vector<FaceId> carried = cutter.within(node, ring, band, is_in);
      if (!carried.empty()) result.faces = std::move(carried);
    }
    result.histogram = descriptor.describe(model, nodes[i], result.faces);
  });
  if (task.stopped()) return cancelled();

  std::vector<Candidate> candidates;
  std::vector<Rejected> rejected;
  std::vector<bool> taken(mesh.triangles.size(), false);
  if (&of == &model)
    for (const FaceId face : part) taken[face.index()] = true;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Solved& result = solved[i];
    const LevelNode& node = tree.nodes()[nodes[i]];
    const auto reject = [&](std::string why) { rejected.push_back({node.through, std::move(why)}); };
    if (result.faces.empty()) {
      reject("no cut: the part is too small for the mesh");
      continue;
    }
    const auto shared = static_cast<double>(
        std::count_if(result.faces.begin(), result.faces.end(), [&](FaceId face) { return taken[face.index()]; }));
    constexpr double kMostShared = 0.05;
    if (shared > kMostShared * static_cast<double>(result.faces.size())) {
      reject("overlaps the reference or a part that is more like it");
      continue;
    }
    const double likeness = 1 - chi_square(result.histogram, wanted);
    constexpr double kLeastLikeness = 0.3;
    if (likeness < kLeastLikeness) {
      reject("its area spreads otherwise from cut to tip: " + in_percent(likeness) + " alike");
      continue;
    }
    for (const FaceId face : result.faces) taken[face.index()] = true;
    Match match{.faces = std::move(result.faces),
                .score = likeness,
                .reference_from_match = result.laid.reference_from_part,
                .mirrored = result.laid.mirrored};
    match.reason = result.copy ? "a copy" : "area spreads " + in_percent(likeness) + " alike from cut to tip";
    if (match.mirrored) match.reason += ", mirrored";
    const double scale = 1 / std::cbrt(std::abs(match.reference_from_match.topLeftCorner<3, 3>().determinant()));
    constexpr double kSameSize = 0.05;
    if (std::abs(scale - 1) > kSameSize) match.reason += ", " + in_percent(scale) + " of the reference's size";
    candidates.push_back({std::move(match), std::move(result.histogram)});
  }
  return Expansion(std::move(reference), std::move(candidates), std::move(rejected));
}

}  // namespace armature::sdk
