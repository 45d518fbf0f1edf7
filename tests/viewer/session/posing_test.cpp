// A model while it is being posed: how far it reaches, and what clicking on it needs.
#include "viewer/session/posing.h"

#include <algorithm>
#include <memory>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/spheremesh/extract.h>
#include <gtest/gtest.h>

namespace armature::viewer {
namespace {

TEST(WhatIsPosed, LiesWithinItsExtent) {
  sdk::SphereMesh bar;
  bar.spheres = {{{-1, 0, 0}, 0.3}, {{1, 0, 0}, 0.3}};
  bar.edges = {{sdk::SphereId(0), sdk::SphereId(1)}};
  Model model;
  model.mesh = std::make_shared<const MeshShape>(sdk::extract_surface(bar, {.tolerance = 1e-2}, {}).value());
  const auto hierarchy = std::make_shared<const sdk::Hierarchy>(sdk::build_hierarchy(model.mesh->mesh)->hierarchy);
  model.set_hierarchy(hierarchy, 4);
  const auto reaches = [&](const sdk::Sphere& around) {
    double most = 0;
    for (const Eigen::Vector3d& at : model.shown_mesh().positions) most = std::max(most, (at - around.centre).norm());
    for (const sdk::Sphere& s : model.spheres->shape->spheres)
      most = std::max(most, (s.centre - around.centre).norm() + s.radius);
    return most;
  };
  EXPECT_LE(reaches(model.extent()), model.extent().radius * (1 + 1e-12));
  model.posing = Posing::begin(model.mesh, hierarchy, 4, {}).value();
  model.lay(model.posing->move({.spheres = {sdk::SphereId(0)}, .translate = {0, 9, 0}}).value());
  EXPECT_GT(reaches(model.around()), 1.5 * model.around().radius) << "far from where it was";
  EXPECT_LE(reaches(model.extent()), model.extent().radius * (1 + 1e-12));
  EXPECT_EQ(model.around().radius, model.mesh->around.radius) << "it is as large as before";
  // What is previewed is seen, and nothing that lasts.
  const sdk::Sphere lasting = model.lasting_extent();
  model.preview(model.posing->preview({.spheres = {sdk::SphereId(0)}, .translate = {0, 50, 0}}).value());
  EXPECT_LE(reaches(model.extent()), model.extent().radius * (1 + 1e-12));
  EXPECT_GT(model.extent().radius, 2 * lasting.radius);
  EXPECT_EQ(model.lasting_extent().radius, lasting.radius);
}

TEST(WhatIsPosed, HasTheTreeOfManySpheresWhereItLiesToStay) {
  sdk::SphereMesh ball;
  ball.spheres = {{{0, 0, 0}, 1}};
  Model model;
  model.mesh = std::make_shared<const MeshShape>(sdk::extract_surface(ball, {.tolerance = 2e-4}, {}).value());
  const auto hierarchy = std::make_shared<const sdk::Hierarchy>(sdk::build_hierarchy(model.mesh->mesh)->hierarchy);
  const std::size_t many = 2500;
  ASSERT_GT(hierarchy->leaf_count(), many);
  model.set_hierarchy(hierarchy, many);
  model.posing = Posing::begin(model.mesh, hierarchy, many, {}).value();
  const sdk::SphereMove move{.spheres = {sdk::SphereId(0)}, .translate = {0, 0.1, 0}};
  model.lay(model.posing->lies().value());
  EXPECT_TRUE(model.spheres->tree);
  model.lay(model.posing->move(move).value());
  EXPECT_TRUE(model.spheres->tree);
  model.preview(model.posing->preview(move).value());
  EXPECT_FALSE(model.spheres->tree) << "nothing can be clicked while it is dragged";
  model.preview(nullptr);
  EXPECT_TRUE(model.spheres->tree);
}

}  // namespace
}  // namespace armature::viewer
