// What the expansions find of what was planted: the goals of section 5.4, on meshes of our own.
#include "tools/evaluation/planted.h"

#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <gtest/gtest.h>

namespace armature::tools {
namespace {

/// The mean over some seeds.
template <class Plant, class Expand>
PlantedQuality mean_quality(PlantOptions options, const Plant& plant, const Expand& expand, int seeds) {
  PlantedQuality mean;
  for (int seed = 1; seed <= seeds; ++seed) {
    options.seed = static_cast<std::uint32_t>(seed);
    const PlantedScene scene = plant(options);
    const auto expansion = expand(scene);
    EXPECT_TRUE(expansion);
    const PlantedQuality quality = quality_of(scene, *expansion);
    mean.precision += quality.precision / seeds;
    mean.recall += quality.recall / seeds;
    mean.overlap += quality.overlap / seeds;
    mean.flipped += quality.flipped / seeds;
  }
  return mean;
}

void expect_good(const PlantedQuality& quality, double overlap) {
  EXPECT_GE(quality.precision, 0.95);
  EXPECT_GE(quality.recall, 0.95);
  EXPECT_GE(quality.overlap, overlap);
  EXPECT_LE(quality.flipped, 0.01);
}

PlantedScene reliefs(const PlantOptions& options) {
  return planted_reliefs(options, 6);
}

auto patch_expansion(const PlantedScene& scene) {
  return sdk::expand_patch(sdk::Surface(scene.mesh), scene.reference);
}

TEST(PlantedReliefs, AreFoundAtAnyTurn) {
  expect_good(mean_quality({}, reliefs, patch_expansion, 3), 0.95);
}

TEST(PlantedReliefs, AreFoundMirrored) {
  expect_good(mean_quality({.mirrored = true}, reliefs, patch_expansion, 3), 0.95);
}

TEST(PlantedReliefs, AreFoundUnderNoise) {
  expect_good(mean_quality({.noise_percent = 0.2}, reliefs, patch_expansion, 3), 0.9);
}

TEST(PlantedReliefs, AreFoundAtOtherSizes) {
  const auto plant = [](const PlantOptions& options) {
    const PlantedScene model = planted_reliefs({.copies = 0}, 5);
    return planted_models(model.mesh, model.reference, options);
  };
  const auto expand = [](const PlantedScene& scene) {
    return sdk::expand_patch(sdk::Surface(scene.mesh), scene.reference, {.scales = {0.63, 0.794, 1, 1.26, 1.587}});
  };
  expect_good(mean_quality({.copies = 5, .largest_scale = 1.5}, plant, expand, 1), 0.95);
}

TEST(PlantedComponents, AreFoundAtAnyTurnAndSizeUnderNoise) {
  const auto plant = [](const PlantOptions& options) { return planted_components(options, 4); };
  const auto expand = [](const PlantedScene& scene) -> sdk::Expected<sdk::Expansion> {
    const sdk::Adjacency adjacency(scene.mesh);
    const auto index = sdk::ComponentIndex::build(scene.mesh, adjacency);
    return index->expand(scene.reference.front());
  };
  expect_good(mean_quality({.largest_scale = 2}, plant, expand, 3), 0.95);
  expect_good(mean_quality({.largest_scale = 2, .mirrored = true, .noise_percent = 0.2}, plant, expand, 3), 0.95);
}

TEST(Planted, WhatIsAlikeTooIsNeitherRightNorWrong) {
  PlantedScene scene = planted_reliefs({.copies = 2}, 4);
  const auto match_of = [](const std::vector<sdk::FaceId>& faces, double score) {
    return sdk::Candidate{{.faces = faces, .score = score}};
  };
  const std::vector<sdk::FaceId> other = {sdk::FaceId(0), sdk::FaceId(1)};
  const sdk::Expansion expansion(
      scene.reference,
      {match_of(other, 0.9), match_of(scene.copies[0].faces, 0.8), match_of(scene.copies[1].faces, 0.7)}, {});
  EXPECT_EQ(quality_of(scene, expansion).precision, 0.5);
  scene.others_alike = {other};
  EXPECT_EQ(quality_of(scene, expansion).precision, 1);
}

TEST(Planted, IsTheSameForTheSameSeed) {
  EXPECT_EQ(planted_reliefs({.seed = 3}, 4).mesh.positions, planted_reliefs({.seed = 3}, 4).mesh.positions);
  EXPECT_NE(planted_reliefs({.seed = 3}, 4).mesh.positions, planted_reliefs({.seed = 4}, 4).mesh.positions);
}

}  // namespace
}  // namespace armature::tools
