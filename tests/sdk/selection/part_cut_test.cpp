#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/part_cut.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/sdk/selection/limbs.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;
using limbs::Creature;

/// Limbs of one shape: straight, bent, and a long one.
Creature three_limbs(double noise = 0) {
  const limbs::Limb limb{.width_rad = 0.4, .length = 5, .bulge = 0.3};
  limbs::Limb bent = limb;
  bent.towards = Vector3d(1, 0.3, 0).normalized();
  bent.bend_rad = 1.2;
  limbs::Limb lengthy = limb;
  lengthy.towards = Vector3d(-1, 0.3, 0).normalized();
  lengthy.length = 9;
  return limbs::creature({limb, bent, lengthy}, 0.06, noise);
}

struct Loaded {
  explicit Loaded(Mesh of) : mesh(std::move(of)), surface(mesh), model(PartModel::build(surface).value()) {}
  Mesh mesh;
  Surface surface;
  PartModel model;
};

void draw(PartCut& cut, const Surface& surface, const std::vector<Vector3d>& stroke) {
  const auto points = project_stroke(surface, stroke, "stroke 0").value();
  cut.begin_stroke();
  for (const SurfacePoint& point : points) cut.add_point(point);
}

std::vector<FaceId> part_of(const Loaded& loaded, const std::vector<Vector3d>& stroke) {
  PartCut cut(loaded.model);
  draw(cut, loaded.surface, stroke);
  return cut.faces().value();
}

/// Whether faces hang together by edges.
bool connected(const Surface& surface, const std::vector<FaceId>& faces) {
  std::vector<FaceId> found = {faces.front()};
  std::vector<bool> left(surface.mesh.triangles.size(), false);
  for (const FaceId face : faces) left[face.index()] = true;
  left[faces.front().index()] = false;
  for (std::size_t at = 0; at < found.size(); ++at)
    for (const EdgeId edge : surface.adjacency.edges(found[at]))
      for (const FaceId face : surface.adjacency.faces(edge))
        if (left[face.index()]) {
          left[face.index()] = false;
          found.push_back(face);
        }
  return found.size() == faces.size();
}

TEST(ConformalFactor, IsZeroOnASphereAndHighestAtTheTipsOfLimbs) {
  const Loaded sphere(surfaces::icosphere(4));
  EXPECT_LT(sphere.model.conformal_factor().cwiseAbs().maxCoeff(), 0.02);
  const Creature creature = three_limbs();
  const Loaded loaded(creature.mesh);
  const Eigen::VectorXd& phi = loaded.model.conformal_factor();
  Eigen::Index highest = 0;
  phi.maxCoeff(&highest);
  EXPECT_GT(creature.places[static_cast<std::size_t>(highest)].along, 0.95);
  EXPECT_NEAR(phi.dot(loaded.model.laplacian().mass) / surface_area(loaded.mesh), 0, 1e-9);
}

TEST(ConformalFactor, DoesNotChangeWithScaleTurnOrPlace) {
  const Creature creature = three_limbs();
  const Loaded loaded(creature.mesh);
  Mesh moved = creature.mesh;
  for (Vector3d& p : moved.positions)
    p = 40 * (Eigen::AngleAxisd(1, Vector3d(1, 2, 3).normalized()) * p) + Vector3d(5, 6, 7);
  const Loaded other(moved);
  EXPECT_LT((loaded.model.conformal_factor() - other.model.conformal_factor()).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(PartCut, FollowsAStrokeAcrossOneSideOfALimb) {
  const Creature creature = three_limbs();
  const Loaded loaded(creature.mesh);
  for (int limb = 0; limb < 3; ++limb)
    for (const double along : {0.1, 0.3, 0.5}) {
      const auto faces = part_of(loaded, creature.stroke(limb, along));
      EXPECT_GT(limbs::overlap(loaded.mesh, faces, creature.beyond(limb, along)), 0.95) << limb << " at " << along;
      EXPECT_TRUE(connected(loaded.surface, faces));
    }
}

TEST(PartCut, TakesTheSideThatProtrudesHoweverTheStrokeIsDrawnAndSwapsIt) {
  const Creature creature = three_limbs();
  const Loaded loaded(creature.mesh);
  auto stroke = creature.stroke(0, 0.3);
  const auto one_way = part_of(loaded, stroke);
  std::reverse(stroke.begin(), stroke.end());
  const auto other_way = part_of(loaded, stroke);
  EXPECT_GT(limbs::overlap(loaded.mesh, one_way, other_way), 0.99);

  PartCut cut(loaded.model);
  draw(cut, loaded.surface, stroke);
  const auto part = cut.faces().value();
  cut.swap_sides();
  const auto rest = cut.faces().value();
  EXPECT_TRUE(connected(loaded.surface, rest));
  std::vector<FaceId> both;
  std::set_union(part.begin(), part.end(), rest.begin(), rest.end(), std::back_inserter(both));
  EXPECT_EQ(part.size() + rest.size(), both.size());
  EXPECT_GT(static_cast<double>(both.size()), 0.999 * static_cast<double>(loaded.mesh.triangles.size()));
  cut.swap_sides();
  EXPECT_EQ(cut.faces().value(), part);
}

TEST(PartCut, CutsAlongTheConformalFactorAtALonePoint) {
  const Creature creature = three_limbs();
  const Loaded loaded(creature.mesh);
  const auto faces = part_of(loaded, {limbs::place(creature.limbs[0], {0.3, 0.5})});
  EXPECT_GT(limbs::overlap(loaded.mesh, faces, creature.beyond(0, 0.3)), 0.95);
}

TEST(PartCut, TakesADentOrAFlatAndNotAllAroundIt) {
  Mesh dent = surfaces::icosphere(5);
  Mesh flat = dent;
  for (Vector3d& p : dent.positions) p *= 1 - 0.1 * std::exp(-std::pow(std::acos(p.z()) / 0.4, 2));
  for (Vector3d& p : flat.positions) p *= std::min(1.0, 0.9 / std::max(0.1, p.z()));
  for (const Mesh& mesh : {dent, flat}) {
    const Loaded loaded(mesh);
    std::vector<Vector3d> stroke;
    for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
      stroke.emplace_back(std::sin(0.35) * std::cos(turn), std::sin(0.35) * std::sin(turn), std::cos(0.35));
      if (stroke.size() == 2 || stroke.size() == 3) continue;  // which say too little of where it goes
      const auto faces = part_of(loaded, stroke);
      double area = 0;
      for (const FaceId face : faces) area += area_vector(mesh, face).norm();
      EXPECT_LT(area, 0.12 * surface_area(mesh)) << stroke.size();
      EXPECT_TRUE(connected(loaded.surface, faces));
    }
    const FaceId middle = loaded.surface.tree.closest({0, 0, 0.9}).face;
    EXPECT_TRUE(std::ranges::binary_search(part_of(loaded, stroke), middle));
  }
}

TEST(PartCut, LeavesOutSmallNoise) {
  const Creature creature = three_limbs(0.002);
  const Loaded loaded(creature.mesh);
  for (int limb = 0; limb < 3; ++limb) {
    const auto faces = part_of(loaded, creature.stroke(limb, 0.3));
    EXPECT_GT(limbs::overlap(loaded.mesh, faces, creature.beyond(limb, 0.3)), 0.9) << limb;
  }
}

TEST(PartCut, KeepsItsFieldBetweenZeroAndOneOnEveryComponent) {
  const Creature creature = three_limbs();
  const std::size_t own = creature.mesh.positions.size();
  const Loaded loaded(surfaces::together(creature.mesh, surfaces::moved(surfaces::icosphere(2), {5, 5, 5})));
  PartCut cut(loaded.model);
  draw(cut, loaded.surface, creature.stroke(0, 0.3));
  const Eigen::VectorXd& field = cut.field();
  EXPECT_GE(field.minCoeff(), 0);
  EXPECT_LE(field.maxCoeff(), 1);
  EXPECT_EQ(field.tail(field.size() - static_cast<Eigen::Index>(own)).cwiseAbs().maxCoeff(), 0);
}

TEST(PartCut, TakesPointsBack) {
  const Creature creature = three_limbs();
  const Loaded loaded(creature.mesh);
  const auto points = project_stroke(loaded.surface, creature.stroke(1, 0.3), "stroke 0").value();
  PartCut cut(loaded.model);
  std::vector<std::vector<FaceId>> steps;
  for (const SurfacePoint& point : points) {
    cut.add_point(point);
    steps.push_back(cut.faces().value());
  }
  for (std::size_t i = steps.size(); i-- > 1;) {
    EXPECT_TRUE(cut.undo_point());
    EXPECT_GT(limbs::overlap(loaded.mesh, cut.faces().value(), steps[i - 1]), 0.999) << i;
  }
  EXPECT_TRUE(cut.undo_point());
  EXPECT_FALSE(cut.undo_point());
  EXPECT_FALSE(cut.faces());
  for (const SurfacePoint& point : points) cut.add_point(point);
  EXPECT_EQ(cut.faces().value(), steps.back());
}

TEST(PartCut, IsRefinedByMoreStrokes) {
  const Creature creature = three_limbs();
  const Loaded loaded(creature.mesh);
  PartCut cut(loaded.model);
  draw(cut, loaded.surface, creature.stroke(2, 0.3, -0.6, 0.6));
  // The other side, drawn the other way round.
  draw(cut, loaded.surface, creature.stroke(2, 0.3, 3.9, 2.4));
  EXPECT_GT(limbs::overlap(loaded.mesh, cut.faces().value(), creature.beyond(2, 0.3)), 0.97);
}

TEST(PartCut, IsTheSameOnAnyNumberOfThreads) {
  const Creature creature = three_limbs();
  std::vector<Eigen::VectorXd> fields;
  for (const std::size_t threads : {1U, 4U}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Loaded loaded(creature.mesh);
    PartCut cut(loaded.model);
    draw(cut, loaded.surface, creature.stroke(0, 0.2));
    ASSERT_TRUE(cut.faces());
    fields.push_back(cut.field());
  }
  EXPECT_EQ(fields[0], fields[1]);
}

TEST(PartCut, StaysOnTheComponentOfItsFirstPoint) {
  const Creature creature = three_limbs();
  const Loaded loaded(surfaces::together(creature.mesh, surfaces::moved(surfaces::icosphere(3, 0.2), {0.4, 0, 1.8})));
  auto stroke = creature.stroke(0, 0.3);
  stroke.emplace_back(0.4, 0, 1.6);
  const auto faces = part_of(loaded, stroke);
  EXPECT_LT(faces.back().index(), creature.mesh.triangles.size());
  EXPECT_GT(limbs::overlap(loaded.mesh, faces, creature.beyond(0, 0.3)), 0.8);
}

TEST(PartCut, TakesOpenNonManifoldAndTinyMeshes) {
  // On the rim of an open cylinder, across its middle, and along the rim.
  const Loaded open(surfaces::cylinder(0.5, 3));
  const auto across = [](double z, double from, double to) {
    std::vector<Vector3d> stroke;
    for (int i = 0; i <= 8; ++i) {
      const double u = from + (to - from) * i / 8;
      stroke.emplace_back(0.5 * std::cos(u), 0.5 * std::sin(u), z);
    }
    return stroke;
  };
  for (const double z : {0.0, 1.0, 1.5, 3.0}) {
    PartCut cut(open.model);
    draw(cut, open.surface, across(z, 0, 2));
    if (const auto faces = cut.faces()) {
      EXPECT_TRUE(connected(open.surface, *faces));
      EXPECT_LT(faces->size(), open.mesh.triangles.size());
    }
  }
  // Three sheets that meet in an edge, drawn over it.
  Mesh sheets = surfaces::paraboloid(0, 0, 20);
  const Mesh fin =
      surfaces::over({20, 10, false, false, 0}, [](double i, double j) { return Vector3d(2 * i - 1, 0, j); });
  sheets = surfaces::together(sheets, fin);
  for (Triangle& t : sheets.triangles)
    for (VertexId& v : t)
      if (v.index() >= 441 && sheets.position(v).z() == 0)
        for (std::size_t other = 0; other < 441; ++other)
          if ((sheets.positions[other] - sheets.position(v)).norm() < 1e-9) v = VertexId(other);
  const Loaded fan(sheets);
  const auto faces = part_of(fan, {{0.3, -0.4, 0}, {0.3, 0, 0}, {0.3, 0.4, 0}});
  EXPECT_TRUE(connected(fan.surface, faces));
  // Along that edge.
  EXPECT_TRUE(connected(fan.surface, part_of(fan, {{-0.5, 0, 0}, {0, 0, 0}, {0.5, 0, 0}})));

  const Loaded lone(surfaces::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  PartCut cut(lone.model);
  draw(cut, lone.surface, {{0.2, 0.2, 0}, {0.4, 0.4, 0}});
  const auto only = cut.faces();
  if (only) {
    EXPECT_EQ(only->size(), 1);
  } else {
    EXPECT_NE(only.error().message.find("no face lies"), std::string::npos);
  }
}

TEST(PartCut, SaysWhatIsWrongWithAStroke) {
  const Loaded loaded(surfaces::icosphere(3));
  PartCut cut(loaded.model);
  const auto none = cut.faces();
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().message, "no part: the stroke has no point on a face; draw along the cut");
  const auto off = project_stroke(loaded.surface, {{0, 0, 1}, {0, 0, 4}}, "stroke 0");
  ASSERT_FALSE(off);
  EXPECT_EQ(off.error().message.rfind("stroke 0, point 1: ", 0), 0);
  EXPECT_FALSE(project_stroke(loaded.surface, {{0, std::numeric_limits<double>::quiet_NaN(), 0}}, "stroke 0"));
}

}  // namespace
}  // namespace armature::sdk
