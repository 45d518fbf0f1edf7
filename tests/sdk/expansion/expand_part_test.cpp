#include <algorithm>
#include <map>
#include <optional>
#include <string>

#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/selection/part_cut.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "sdk/expansion/ring_cut.h"
#include "tests/sdk/selection/limbs.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using limbs::Creature;
using limbs::Limb;

/// The first limb's copies: turned, smaller, bent, mirrored; then a longer one and two that are otherwise.
Creature copies(double noise = 0, std::uint64_t seed = 7) {
  std::vector<Limb> all;
  const Limb limb{.width_rad = 0.35, .length = 5, .bulge = 0.3};
  const auto add = [&](const Vector3d& towards, const auto& change) {
    Limb next = limb;
    next.towards = towards.normalized();
    change(next);
    all.push_back(next);
  };
  add({0, 0, 1}, [](Limb&) {});
  add({1, 0, 0.3}, [](Limb& l) { l.turn_rad = 2; });
  add({0, 1, 0.2}, [](Limb& l) { l.turn_rad = 4, l.width_rad = 0.25; });
  add({-1, 0, 0}, [](Limb& l) { l.bend_rad = 1; });
  add({0, -1, 0}, [](Limb& l) { l.mirrored = true, l.turn_rad = 1; });
  add({0, 0, -1}, [](Limb& l) { l.length = 9; });
  add({1, 1, -1}, [](Limb& l) { l.length = 1, l.bulge = 0; });
  add({-1, -1, -1}, [](Limb& l) { l.length = 2, l.bulge = 0; });
  return limbs::creature(all, 0.05, noise, seed);
}
constexpr int kCopies = 4;

struct Expanded {
  Expanded(const Creature& of, double along)
      : creature(of), surface(creature.mesh), model(PartModel::build(surface).value()) {
    PartCut cut(model);
    const auto points = project_stroke(surface, creature.stroke(0, along), "stroke 0").value();
    for (const SurfacePoint& point : points) cut.add_point(point);
    reference = cut.faces().value();
    expansion = expand_part(model, reference).value();
  }

  /// The reference carried to another limb, point by point.
  [[nodiscard]] std::vector<FaceId> carried(int limb) const {
    std::vector<FaceId> faces;
    for (std::size_t f = 0; f < creature.mesh.triangles.size(); ++f) {
      Vector3d there = Vector3d::Zero();
      bool on = true;
      for (const VertexId v : creature.mesh.triangles[f]) {
        on &= creature.limb_of[v.index()] == limb;
        if (on) there += limbs::place(creature.limbs[0], creature.places[v.index()]) / 3;
      }
      if (on && std::binary_search(reference.begin(), reference.end(), surface.tree.closest(there).face))
        faces.emplace_back(f);
    }
    return faces;
  }
  /// The limb that a match covers best, and how well.
  [[nodiscard]] std::pair<int, double> found(const Match& match) const {
    std::pair<int, double> best = {-1, 0};
    for (int limb = 0; limb < static_cast<int>(creature.limbs.size()); ++limb) {
      const double overlap = limbs::overlap(creature.mesh, match.faces, carried(limb));
      if (overlap > best.second) best = {limb, overlap};
    }
    return best;
  }

  Creature creature;
  Surface surface;
  PartModel model;
  std::vector<FaceId> reference;
  Expansion expansion;
};

TEST(ExpandPart, FindsAllCopiesFirstAndCutsThemWhereTheReferenceIs) {
  for (const double along : {0.1, 0.3}) {
    const Expanded expanded(copies(), along);
    ASSERT_GE(expanded.expansion.size(), kCopies);
    std::map<int, double> overlaps;
    for (const Match& match : expanded.expansion.first(kCopies)) {
      const auto [limb, overlap] = expanded.found(match);
      overlaps[limb] = overlap;
      EXPECT_GT(match.score, 0.9);
      EXPECT_FALSE(match.reason.empty());
    }
    for (int limb = 1; limb <= kCopies; ++limb) EXPECT_GT(overlaps[limb], 0.95) << limb << " at " << along;
  }
}

TEST(ExpandPart, FindsThemInNoise) {
  const Expanded expanded(copies(0.002), 0.3);
  ASSERT_GE(expanded.expansion.size(), kCopies);
  std::map<int, double> overlaps;
  for (const Match& match : expanded.expansion.first(kCopies + 1)) {
    const auto [limb, overlap] = expanded.found(match);
    overlaps[limb] = overlap;
  }
  for (int limb = 1; limb <= kCopies; ++limb) EXPECT_GT(overlaps[limb], 0.9) << limb;
}

TEST(ExpandPart, MapsMatchesOntoTheReferenceAndSaysWhichAreMirrored) {
  const Expanded expanded(copies(), 0.3);
  for (const Match& match : expanded.expansion.first(kCopies)) {
    const auto [limb, overlap] = expanded.found(match);
    if (limb == 3) continue;  // bent: no similarity maps it
    EXPECT_EQ(match.mirrored, limb == 4) << match.reason;
    const Eigen::Matrix3d linear = match.reference_from_match.topLeftCorner<3, 3>();
    EXPECT_EQ(linear.determinant() < 0, match.mirrored);
    EXPECT_EQ(match.reason.find("mirrored") != std::string::npos, match.mirrored);
    const double radius = std::sin(expanded.creature.limbs[0].width_rad);
    double worst = 0;
    for (const FaceId face : match.faces)
      for (const VertexId v : expanded.creature.mesh.triangle(face)) {
        const Vector3d there =
            (match.reference_from_match * expanded.creature.mesh.position(v).homogeneous()).head<3>();
        worst = std::max(
            worst, (there - limbs::place(expanded.creature.limbs[0], expanded.creature.places[v.index()])).norm());
      }
    EXPECT_LT(worst, 0.1 * radius) << "limb " << limb;
  }
}

TEST(ExpandPart, TellsHandednessInNoise) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Expanded expanded(copies(0.001, seed), 0.3);
    for (const Match& match : expanded.expansion.first(kCopies)) {
      const int limb = expanded.found(match).first;
      if (limb == 3) continue;  // bent
      EXPECT_EQ(match.mirrored, limb == 4) << match.reason;
    }
  }
}

TEST(ExpandPart, CutsALongerLimbAtItsRoot) {
  // Figure 5.11 c of the thesis: an isoline of the reference's value would end elsewhere.
  const Expanded expanded(copies(), 0.1);
  const auto root = expanded.creature.beyond(5, 0.1 * 5 / 9);
  double best = 0;
  for (const Match& match : expanded.expansion.first(8))
    best = std::max(best, limbs::overlap(expanded.creature.mesh, match.faces, root));
  EXPECT_GT(best, 0.95);
  const Eigen::VectorXd& phi = expanded.model.conformal_factor();
  const auto mean_at_cut = [&](int limb, double along) {
    double sum = 0;
    int count = 0;
    for (std::size_t v = 0; v < expanded.creature.places.size(); ++v) {
      if (expanded.creature.limb_of[v] != limb || std::abs(expanded.creature.places[v].along - along) > 0.01) continue;
      sum += phi[static_cast<Eigen::Index>(v)];
      ++count;
    }
    return sum / count;
  };
  // What the thesis would do: the place along the long limb where the factor is that of the reference's cut.
  const double value = mean_at_cut(0, 0.1);
  double along = 0;
  while (mean_at_cut(5, along) < value) along += 0.01;
  EXPECT_LT(limbs::overlap(expanded.creature.mesh, expanded.creature.beyond(5, along), root), 0.95);
}

TEST(ExpandPart, FindsPartsAlthoughATunnelJoinsTwoOfThem) {
  // Figure 5.11 a-b of the thesis: there the tunnel changes the factor so that none of these are found.
  struct Case {
    double tunnel, cut;  // along the limbs
    double joined;       // the least overlap of limbs that it joins
  };
  for (const auto& [tunnel, cut, joined] : {Case{0.3, 0.3, 0.95}, Case{0.5, 0.1, 0.8}, Case{0.7, 0.1, 0.4}}) {
    Creature creature = copies();
    limbs::join_by_tunnel(creature, 1, 2, tunnel);
    const Expanded expanded(creature, cut);
    ASSERT_GE(expanded.expansion.size(), kCopies);
    std::map<int, double> overlaps;
    for (const Match& match : expanded.expansion.first(6)) {
      const auto [limb, overlap] = expanded.found(match);
      overlaps[limb] = overlap;
      if (limb == 3 || limb == 4) {
        EXPECT_GT(match.score, 0.98) << limb << " at " << tunnel;
      }
    }
    for (const int limb : {3, 4}) EXPECT_GT(overlaps[limb], 0.95) << limb << " at " << tunnel;
    for (const int limb : {1, 2}) EXPECT_GT(overlaps[limb], joined) << limb << " at " << tunnel;
  }
}

TEST(ExpandPart, FindsThePartsOfAnotherSurface) {
  const Expanded expanded(copies(), 0.3);
  const Limb& limb = expanded.creature.limbs[0];
  Limb turned = limb;
  turned.towards = {0.6, 0, 0.8};
  turned.turn_rad = 1;
  Limb small = limb;
  small.towards = {-0.8, 0.6, 0};
  small.width_rad = 0.25;
  small.mirrored = true;
  const Creature other = limbs::creature({turned, small, {.towards = {0, 0, -1}, .length = 2}}, 0.05);
  const Surface surface(other.mesh);
  const auto model = PartModel::build(surface).value();
  const auto expansion = expand_part(model, expanded.model, expanded.reference);
  ASSERT_TRUE(expansion);
  EXPECT_EQ(expansion->reference(), expanded.reference);
  ASSERT_GE(expansion->size(), 2U);
  std::map<int, double> overlaps;
  for (const Match& match : expansion->first(2)) {
    EXPECT_GT(match.score, 0.9);
    for (int i = 0; i < 2; ++i) {
      // A face belongs to the match if it lies on the reference when it is laid onto it.
      std::vector<FaceId> wanted;
      for (const FaceId face : other.beyond(i, 0)) {
        Vector3d there = Vector3d::Zero();
        for (const VertexId v : other.mesh.triangle(face)) there += limbs::place(limb, other.places[v.index()]) / 3;
        if (std::ranges::binary_search(expanded.reference, expanded.surface.tree.closest(there).face))
          wanted.push_back(face);
      }
      overlaps[i] = std::max(overlaps[i], limbs::overlap(other.mesh, match.faces, wanted));
    }
  }
  for (int i = 0; i < 2; ++i) EXPECT_GT(overlaps[i], 0.95) << i;
}

TEST(ExpandPart, LeavesRoomForWhatIsNotAlikeAfterTheCopies) {
  const Expanded expanded(copies(), 0.1);
  const auto matches = expanded.expansion.first(expanded.expansion.size());
  EXPECT_GT(matches[kCopies - 1].score, matches[kCopies].score + 0.05);
  for (const Match& match : matches) {
    std::vector<FaceId> shared;
    std::set_intersection(match.faces.begin(), match.faces.end(), expanded.reference.begin(), expanded.reference.end(),
                          std::back_inserter(shared));
    EXPECT_LT(shared.size(), 0.05 * static_cast<double>(match.faces.size()));
    EXPECT_TRUE(std::is_sorted(match.faces.begin(), match.faces.end()));
  }
}

TEST(ExpandPart, IsTheSameOnAnyNumberOfThreads) {
  std::vector<std::vector<FaceId>> found;
  for (const std::size_t threads : {1U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Expanded expanded(copies(), 0.3);
    std::vector<FaceId> all;
    for (const Match& match : expanded.expansion.first(8))
      all.insert(all.end(), match.faces.begin(), match.faces.end());
    found.push_back(std::move(all));
  }
  EXPECT_EQ(found[0], found[1]);
}

TEST(ExpandPart, HasNoMatchesWhereNothingProtrudes) {
  const Mesh sphere = surfaces::icosphere(3);
  const Surface surface(sphere);
  const auto model = PartModel::build(surface).value();
  std::vector<FaceId> cap;
  for (std::size_t f = 0; f < sphere.triangles.size(); ++f)
    if (sphere.corner(FaceId(f), 0).z() > 0.5) cap.emplace_back(f);
  const auto expansion = expand_part(model, cap);
  ASSERT_TRUE(expansion);
  EXPECT_EQ(expansion->reference(), cap);
  const auto none = expand_part(model, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message, "no part to compare with: it has no faces");
}

TEST(ExpandPart, StopsOnRequest) {
  const Mesh sphere = surfaces::icosphere(3);
  const Surface surface(sphere);
  const auto model = PartModel::build(surface).value();
  std::stop_source source;
  source.request_stop();
  const std::vector<FaceId> part = {FaceId(0)};
  const auto stopped = expand_part(model, part, {}, {.stop = source.get_token()});
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().kind, ErrorKind::Cancelled);
}

TEST(RingCut, HasTheFieldOfTheWholeSurfaceBetweenItsRings) {
  const Creature creature = copies();
  const Surface surface(creature.mesh);
  const auto model = PartModel::build(surface).value();
  const Eigen::VectorXd& phi = model.conformal_factor();
  const std::span<const double> field(phi.data(), static_cast<std::size_t>(phi.size()));
  const LevelTree tree(surface, field, spread_levels(surface, field));
  RingCut cutter(model);
  // A node halfway down some limb.
  const auto node =
      std::find_if(tree.nodes().begin(), tree.nodes().end(), [](const LevelNode& n) { return n.area > 0.5; });
  ASSERT_NE(node, tree.nodes().end());
  const Ring ring = cutter.ring_around(*node, 2 * model.offset(node->through));
  const Eigen::VectorXd local = cutter.field(ring);

  SparseFactor factor = model.factor();
  constexpr double kWeight = 1e6;
  std::vector<SparseFactor::Entry> b;
  for (const VertexId v : ring.inside) b.push_back({v, kWeight});
  for (const VertexId v : ring.inside) factor.add_to_diagonal(v, kWeight);
  for (const VertexId v : ring.outside) factor.add_to_diagonal(v, kWeight);
  const Eigen::VectorXd global = factor.solve(b);
  for (std::size_t i = 0; i < ring.near.size(); ++i)
    EXPECT_NEAR(local[static_cast<Eigen::Index>(i)], global[static_cast<Eigen::Index>(ring.near[i].index())], 1e-4);
}

}  // namespace
}  // namespace armature::sdk
