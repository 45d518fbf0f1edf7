#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/hierarchy/build.h>
#include <gtest/gtest.h>

#include "tests/sdk/deformation/tubes.h"
#include "tests/sdk/hierarchy/shapes.h"

namespace armature::sdk {
namespace {

struct Rig {
  explicit Rig(Mesh of, HierarchyOptions options = {})
      : mesh(std::move(of)),
        hierarchy(build_hierarchy(mesh, options).value().hierarchy),
        diffusion(HeatDiffusion::of(mesh).value()) {}
  [[nodiscard]] SkinWeights at(std::size_t spheres) const {
    return SphereWeights(diffusion, hierarchy).of(hierarchy.nodes_of_level(spheres));
  }
  Mesh mesh;
  Hierarchy hierarchy;
  HeatDiffusion diffusion;
};

/// The largest amount by which weights leave [0, 1] or their sum leaves 1.
double worst_defect(const SkinWeights& skin) {
  std::vector<double> sum(skin.totals.size(), 0.0);
  double worst = 0;
  for (std::size_t s = 0; s < skin.columns.size(); ++s) {
    const auto weights = skin.of_sphere(s);
    for (std::size_t v = 0; v < weights.size(); ++v) {
      worst = std::max({worst, -weights[v], weights[v] - 1});
      sum[v] += weights[v];
    }
  }
  for (const double all : sum) worst = std::max(worst, std::abs(all - 1));
  return worst;
}

TEST(HeatDiffusion, KeepsSumsAndBounds) {
  const Mesh mesh = surfaces::torus(3, 1, 60, 30, 0.3);
  const HeatDiffusion diffusion = HeatDiffusion::of(mesh).value();
  const auto n = static_cast<Eigen::Index>(mesh.positions.size());
  Eigen::MatrixXd heat(n, 2);
  for (Eigen::Index v = 0; v < n; ++v) heat(v, 0) = v % 7 < 3 ? 1 : 0;
  heat.col(1) = Eigen::VectorXd::Ones(n) - heat.col(0);
  diffusion.diffuse(heat);
  EXPECT_LT((heat.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
  EXPECT_GE(heat.minCoeff(), 0);
}

TEST(HeatDiffusion, FallsByTheReachAlongATube) {
  // From a half of a long thin tube heat enters the other as exp(-d / reach) / 2.
  const Mesh mesh = tubes::tube(20, 0.2, 0, 16, 800);
  const double reach = 0.03;
  const HeatDiffusion diffusion = HeatDiffusion::of(mesh, {.reach = reach}).value();
  Eigen::MatrixXd heat(static_cast<Eigen::Index>(mesh.positions.size()), 1);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    heat(static_cast<Eigen::Index>(v), 0) = std::clamp(0.5 - 1e9 * mesh.positions[v].x(), 0.0, 1.0);
  diffusion.diffuse(heat);
  const double length = reach * bounding_box_diagonal(mesh);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const double d = mesh.positions[v].x();
    if (d > 0 && d < 3 * length) {
      EXPECT_NEAR(heat(static_cast<Eigen::Index>(v), 0), std::exp(-d / length) / 2, 0.005);
    }
  }
}

TEST(HeatDiffusion, IsTheSameAtSomeVerticesAloneAsEverywhere) {
  const Mesh mesh = surfaces::torus(3, 1, 60, 30, 0.3);
  const HeatDiffusion diffusion = HeatDiffusion::of(mesh).value();
  std::vector<VertexId> sources;
  std::vector<VertexId> wanted;
  Eigen::MatrixXd heat = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(mesh.positions.size()), 1);
  for (std::size_t v = 0; v < 40; ++v) {
    sources.emplace_back(v);
    heat(static_cast<Eigen::Index>(v), 0) = 1;
    wanted.emplace_back(3 * v + 1);
  }
  diffusion.diffuse(heat);
  std::vector<double> at(wanted.size());
  diffusion.diffuse(sources, wanted, at);
  for (std::size_t i = 0; i < wanted.size(); ++i)
    EXPECT_NEAR(at[i], heat(static_cast<Eigen::Index>(wanted[i].index()), 0), 1e-14);
}

TEST(HeatDiffusion, RefusesAReachThatIsNoPositiveNumber) {
  for (const double reach : {0.0, -1.0, std::nan(""), HUGE_VAL}) {
    const auto refused = HeatDiffusion::of(surfaces::cube(), {.reach = reach});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "reach: expected a positive number");
  }
}

TEST(SphereWeights, SumToOneAndStayInBoundsAtEveryLevel) {
  const Rig rig(tubes::tube(8, 1, 0.05));
  for (const std::size_t spheres : {1, 2, 7, 40, 300}) EXPECT_LT(worst_defect(rig.at(spheres)), 1e-12) << spheres;
  EXPECT_LT(worst_defect(rig.at(rig.mesh.positions.size())), 1e-12);
}

TEST(SphereWeights, AreTheSameWhicheverLevelsWereVisitedBefore) {
  const Rig rig(tubes::tube(8, 1, 0.05));
  SphereWeights walked(rig.diffusion, rig.hierarchy);
  for (const std::size_t spheres : {60, 3, 25, 12}) (void)walked.of(rig.hierarchy.nodes_of_level(spheres));
  const SkinWeights there = walked.of(rig.hierarchy.nodes_of_level(12));
  const SkinWeights straight = rig.at(12);
  for (std::size_t s = 0; s < 12; ++s) EXPECT_EQ(there.of_sphere(s), straight.of_sphere(s));
}

TEST(SphereWeights, OfASphereAreTheSumOfItsChildrens) {
  // Up to the cut, which is taken off either.
  const Rig rig(tubes::tube(8, 1, 0.05));
  const std::size_t spheres = 10;
  const NodeId parent(2 * rig.hierarchy.leaf_count() - spheres - 1);
  const auto [a, b] = rig.hierarchy.children(parent);
  SphereWeights weights(rig.diffusion, rig.hierarchy);
  const std::vector<NodeId> nodes = {parent, a, b};
  const SkinWeights skin = weights.of(nodes);
  const auto sum_of = [&](std::size_t s) {
    std::vector<double> all(rig.mesh.positions.size(), 0.0);
    const WeightColumn& column = *skin.columns[s];
    for (std::size_t i = 0; i < column.vertices.size(); ++i)
      all[column.vertices[i].index()] = static_cast<double>(column.weights[i]);
    return all;
  };
  const auto of_parent = sum_of(0);
  const auto of_a = sum_of(1);
  const auto of_b = sum_of(2);
  for (std::size_t v = 0; v < of_parent.size(); ++v)
    EXPECT_NEAR(of_parent[v], of_a[v] + of_b[v], static_cast<double>(SphereWeights::kCut) + 1e-6);
}

TEST(SphereWeights, AreLocal) {
  const Rig rig(tubes::tube(8, 1, 0.05, 32, 160));
  const SkinWeights skin = rig.at(8);
  std::size_t entries = 0;
  for (const auto& column : skin.columns) entries += column->vertices.size();
  EXPECT_LT(static_cast<double>(entries) / static_cast<double>(rig.mesh.positions.size()), 3.5);
}

/// A hierarchy of a mesh in two halves of as many vertices, joined last: each is split into a half and a half again,
/// and the second is joined as the first.
Hierarchy in_halves(const Mesh& mesh, const std::vector<std::uint32_t>& first,
                    const std::vector<std::uint32_t>& second) {
  Hierarchy::Parts parts;
  for (const Eigen::Vector3d& p : mesh.positions)
    parts.leaves.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    parts.children.push_back({a, b});
    parts.spheres.push_back({0, 0, 0, 1});
    return static_cast<std::uint32_t>(mesh.positions.size() + parts.children.size() - 1);
  };
  const auto both = [&](auto&& self, std::size_t begin, std::size_t end) -> std::array<std::uint32_t, 2> {
    if (end - begin == 1) return {first[begin], second[begin]};
    const std::size_t middle = (begin + end) / 2;
    const auto left = self(self, begin, middle);
    const auto right = self(self, middle, end);
    const std::uint32_t of_first = join(left[0], right[0]);
    return {of_first, join(left[1], right[1])};
  };
  const auto [a, b] = both(both, 0, first.size());
  join(a, b);
  parts.lasting.assign(parts.children.size() + 1, 0);
  return Hierarchy::assemble(std::move(parts)).value();
}

TEST(SphereWeights, OfSymmetricClustersAreSymmetric) {
  // Half a turn about z takes the mesh to itself, its triangles too; no vertex lies on the middle.
  constexpr int kAround = 32;
  constexpr int kAlong = 81;
  const Mesh mesh = tubes::tube(6, 1, 0.05, kAround, kAlong);
  const auto turned = [&](std::size_t v) -> std::size_t {
    if (v == 0 || v + 1 == mesh.positions.size()) return mesh.positions.size() - 1 - v;
    const std::size_t ring = (v - 1) / kAround;
    const std::size_t place = (v - 1) % kAround;
    return 1 + (kAlong - 2 - ring) * kAround + (kAround / 2 + kAround - place) % kAround;
  };
  std::vector<std::uint32_t> left;
  std::vector<std::uint32_t> right;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Eigen::Vector3d& p = mesh.positions[v];
    ASSERT_LT((mesh.positions[turned(v)] - Eigen::Vector3d(-p.x(), -p.y(), p.z())).norm(), 1e-12);
    if (p.x() > 0) continue;
    left.push_back(static_cast<std::uint32_t>(v));
    right.push_back(static_cast<std::uint32_t>(turned(v)));
  }
  const Hierarchy hierarchy = in_halves(mesh, left, right);
  const HeatDiffusion diffusion = HeatDiffusion::of(mesh).value();
  SphereWeights weights(diffusion, hierarchy);
  for (const std::size_t spheres : {2, 4, 8}) {
    const auto nodes = hierarchy.nodes_of_level(spheres);
    const SkinWeights skin = weights.of(nodes);
    double most = 0;
    for (std::size_t s = 0; s < spheres / 2; ++s) {
      const auto here = skin.of_sphere(s);
      const auto there = skin.of_sphere(s + spheres / 2);
      for (std::size_t v = 0; v < here.size(); ++v) {
        EXPECT_NEAR(here[v], there[turned(v)], 1e-6) << spheres << ' ' << s;
        most = std::max(most, std::min(here[v], 1 - here[v]));
      }
    }
    EXPECT_GT(most, 0.3) << "they blend";
  }
}

TEST(SphereWeights, OfAStrayComponentAreThoseOfTheSphereThatStandsForIt) {
  const Rig rig(
      surfaces::together(tubes::tube(6, 1, 0.05), surfaces::moved(surfaces::icosphere(1, 0.05), {2, 1.3, 0})));
  const std::size_t first = rig.mesh.positions.size() - surfaces::icosphere(1).positions.size();
  const SkinWeights skin = rig.at(4);
  EXPECT_LT(worst_defect(skin), 1e-12);
  for (std::size_t s = 0; s < 4; ++s) {
    const auto weights = skin.of_sphere(s);
    // One sphere has all of it; alone it would be refused by methods that need to see a bone.
    for (std::size_t v = first; v < rig.mesh.positions.size(); ++v) EXPECT_NEAR(weights[v], weights[first], 1e-6);
    EXPECT_TRUE(weights[first] < 1e-6 || weights[first] > 1 - 1e-6);
  }
}

TEST(SphereWeights, TakeAnyMesh) {
  Mesh open = surfaces::torus(3, 1);
  open.triangles.resize(open.triangles.size() / 2);
  Mesh loose = surfaces::icosphere(2);
  loose.positions.emplace_back(5, 5, 5);
  for (const Mesh& mesh : {soup(200), open, loose, two_balls(2), surfaces::inside_out(surfaces::icosphere(2))}) {
    const Rig rig(mesh);
    for (const std::size_t spheres : {std::size_t{1}, std::size_t{5}, mesh.positions.size()})
      EXPECT_LT(worst_defect(rig.at(spheres)), 1e-9);
  }
}

TEST(SphereWeights, WorkOnAHierarchyThatEndsEarly) {
  const Rig rig(two_balls(3), {.stop_at = 9});
  ASSERT_EQ(rig.hierarchy.min_spheres(), 9U);
  EXPECT_LT(worst_defect(rig.at(9)), 1e-12);
  EXPECT_LT(worst_defect(rig.at(20)), 1e-12);
}

TEST(ClosestPrimitiveWeights, SumToOneAndBlendAlongEdges) {
  const Rig rig(tubes::tube(8, 1, 0.03));
  const SkinWeights skin = closest_primitive_weights(rig.diffusion, rig.hierarchy, rig.mesh, 2);
  EXPECT_LT(worst_defect(skin), 1e-12);
  const auto level = rig.hierarchy.level(2).value();
  const double a = level.spheres[0].centre.x();
  const double b = level.spheres[1].centre.x();
  const auto of_b = skin.of_sphere(1);
  for (std::size_t v = 0; v < rig.mesh.positions.size(); ++v) {
    const double along = (rig.mesh.positions[v].x() - a) / (b - a);
    if (along > 0.2 && along < 0.8) {
      EXPECT_NEAR(of_b[v], along, 0.05);
    }
  }
}

}  // namespace
}  // namespace armature::sdk
