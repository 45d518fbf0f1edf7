#include "tools/evaluation/selection_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string_view>
#include <utility>

#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/selection/part_cut.h>
#include <fmt/format.h>

#include "tools/evaluation/part_times.h"
#include "tools/evaluation/shapes.h"

namespace armature::tools {
namespace {

using Eigen::Vector3d;

sdk::Expected<sdk::Expansion> expand_patch(const PlantedScene& scene, const sdk::Task& task) {
  return sdk::expand_patch(sdk::Surface(scene.mesh), scene.reference, {}, task);
}

sdk::Expected<sdk::Expansion> expand_part(const PlantedScene& scene, const sdk::Task& task) {
  const sdk::Surface surface(scene.mesh);
  const auto model = sdk::PartModel::build(surface, task);
  if (!model) return tl::unexpected(model.error());
  return sdk::expand_part(*model, scene.reference, {}, task);
}

sdk::Expected<sdk::Expansion> expand_component(const PlantedScene& scene, const sdk::Task& task) {
  const sdk::Adjacency adjacency(scene.mesh);
  const auto index = sdk::ComponentIndex::build(scene.mesh, adjacency, task);
  if (!index) return tl::unexpected(index.error());
  return index->expand(scene.reference.front());
}

/// A body with a limb that is like no other: a club, a peg and a horn.
sdk::Mesh body_with_limbs() {
  sdk::Mesh mesh = icosphere(5);
  struct Limb {
    Vector3d towards;
    double width, height, round;
  };
  const std::array limbs = {Limb{{0, 0.2, 1}, 0.2, 1.3, 4}, Limb{{1, 0, -0.3}, 0.35, 0.5, 6},
                            Limb{{-1, 0.3, -0.4}, 0.25, 0.9, 2}};
  for (Vector3d& p : mesh.positions) {
    double height = 0;
    for (const Limb& limb : limbs) {
      const Vector3d axis = limb.towards.normalized();
      const Vector3d u = axis.unitOrthogonal();
      const auto angle_to = [&](const Vector3d& direction) {
        return std::acos(std::clamp(p.dot(direction.normalized()), -1.0, 1.0)) / limb.width;
      };
      // Two knobs of different size, so that it is neither round nor its own mirror image.
      const double large = angle_to(axis + 0.4 * limb.width * u);
      const double small = angle_to(axis + 0.5 * limb.width * axis.cross(u));
      height = std::max(height, limb.height * (std::exp(-std::pow(angle_to(axis), limb.round)) +
                                               0.35 * std::exp(-std::pow(large / 0.35, 2)) +
                                               0.2 * std::exp(-std::pow(small / 0.25, 2))));
    }
    p *= 1 + height;
  }
  return mesh;
}

sdk::Expected<std::vector<sdk::FaceId>> part_below(const sdk::Mesh& mesh, const PartTip& tip, const sdk::Task& task) {
  const sdk::Surface surface(mesh);
  const auto model = sdk::PartModel::build(surface, task);
  if (!model) return tl::unexpected(model.error());
  sdk::PartCut cut(*model);
  for (const sdk::SurfacePoint& point : stroke_below(*model, tip)) cut.add_point(point);
  return cut.faces();
}

using Region = std::vector<sdk::FaceId>;

/// Scenes of a model among its copies: one region is the reference, others are alike.
std::function<PlantedScene(const PlantOptions&)> among_copies(sdk::Mesh mesh, Region region,
                                                              std::vector<Region> alike = {}) {
  struct Model {
    sdk::Mesh mesh;
    Region region;
    std::vector<Region> alike;
  };
  auto model = std::make_shared<const Model>(Model{std::move(mesh), std::move(region), std::move(alike)});
  return [model](const PlantOptions& options) {
    PlantedScene scene = planted_models(model->mesh, model->region, options);
    const std::size_t faces = model->mesh.triangles.size();
    for (std::size_t first = 0; first < scene.mesh.triangles.size(); first += faces)
      for (const Region& like : model->alike) {
        Region there;
        for (const sdk::FaceId face : like) there.emplace_back(first + face.index());
        scene.others_alike.push_back(std::move(there));
      }
    return scene;
  };
}

std::string with_noise_said(std::string name, double noise) {
  return noise > 0 ? fmt::format("{}, {} % noise", name, noise) : name;
}

}  // namespace

sdk::Expected<std::vector<QualityCase>> planted_cases(const sdk::Task& task) {
  const sdk::Mesh body = body_with_limbs();
  const auto limb = part_below(body, {.at = Vector3d(0, 0.45, 2.2), .below = 0.2}, task);
  if (!limb) return tl::unexpected(limb.error());
  const auto reliefs = [](const PlantOptions& options) { return planted_reliefs(options, 6); };
  const auto components = [](const PlantOptions& options) { return planted_components(options, 5); };
  std::vector<QualityCase> cases;
  for (const double noise : {0.0, 0.2})
    for (const bool mirrored : {false, true}) {
      const std::string how = mirrored ? ", half mirrored" : "";
      const PlantOptions options{.mirrored = mirrored, .noise_percent = noise};
      cases.push_back({with_noise_said("patches" + how, noise), options, reliefs, expand_patch});
      PlantOptions parts = options;
      parts.largest_scale = 1.5;
      parts.bend_rad = 0.5;
      cases.push_back({with_noise_said("parts, bent, sizes 2/3 to 3/2" + how, noise), parts, among_copies(body, *limb),
                       expand_part});
      PlantOptions sizes = options;
      sizes.largest_scale = 2;
      cases.push_back(
          {with_noise_said("components, sizes 1/2 to 2" + how, noise), sizes, components, expand_component});
    }
  return cases;
}

sdk::Expected<std::vector<QualityCase>> model_cases(const std::filesystem::path& models, const sdk::Task& task) {
  struct Planted {
    std::string_view file;
    double radius;  // of a patch about the vertex farthest from the middle, of the diagonal; or 0 for a part
    PartTip tip;
    std::vector<PartTip> alike = {};
  };
  const std::array planted = {
      Planted{"vh_Hand1.off",
              0,
              {.at = Vector3d(-4.54, 95.23, -834.4), .below = 0.2},
              {{.at = Vector3d(-23.9, 87.3, -847.7), .below = 0.2}, {.at = Vector3d(-52, 54.6, -838.7), .below = 0.2}}},
      Planted{"vsa_gargoyle.off", 0.1, {}},
      Planted{"c3d_stanford-bunny.obj", 0.08, {}},
      Planted{"vm_bear.off", 0.1, {}},
      Planted{"vm_neptune.off", 0.05, {}},
      Planted{"igl_armadillo.obj", 0, {.at = Vector3d(0.019, -0.297, -0.375), .below = 0.15}},
      Planted{"vm_dolphin.off", 0, {.at = Vector3d(0.4166, 0.1516, 0.0105), .below = 0.08}},
      Planted{"vm_bear.off", 0, {.at = Vector3d(0.1944, 0.9893, 0.1367), .below = 0.1}},
  };
  std::vector<QualityCase> cases;
  for (const auto& [file, radius, tip, others] : planted) {
    const std::filesystem::path path = models / file;
    if (!std::filesystem::exists(path)) continue;
    auto mesh = sdk::read_mesh(path, {}, task);
    if (!mesh) return tl::unexpected(mesh.error());
    const bool is_part = radius == 0;
    auto region = is_part ? part_below(*mesh, tip, task)
                          : region_about(*mesh, farthest_vertex(*mesh), radius * sdk::bounding_box_diagonal(*mesh));
    if (!region) return tl::unexpected(region.error());
    std::vector<Region> alike;
    for (const PartTip& other : others) {
      auto found = part_below(*mesh, other, task);
      if (!found) return tl::unexpected(found.error());
      alike.push_back(std::move(*found));
    }
    const auto plant = among_copies(std::move(*mesh), std::move(*region), std::move(alike));
    for (const double noise : {0.0, 0.2}) {
      PlantOptions options{.copies = 5, .mirrored = true, .bend_rad = 0.3, .noise_percent = noise};
      if (is_part) options.largest_scale = 1.5;
      cases.push_back({with_noise_said(fmt::format("{} of {}", is_part ? "a part" : "a patch", file), noise), options,
                       plant, is_part ? expand_part : expand_patch});
    }
  }
  return cases;
}

sdk::Expected<PlantedQuality> mean_quality(const QualityCase& of, int seeds, const sdk::Task& task) {
  PlantedQuality mean;
  PlantOptions options = of.options;
  for (int seed = 1; seed <= seeds; ++seed) {
    options.seed = static_cast<std::uint32_t>(seed);
    const PlantedScene scene = of.plant(options);
    const auto expansion = of.expand(scene, task);
    if (!expansion) return tl::unexpected(expansion.error());
    const PlantedQuality one = quality_of(scene, *expansion);
    mean.precision += one.precision / seeds;
    mean.recall += one.recall / seeds;
    mean.overlap += one.overlap / seeds;
    mean.flipped += one.flipped / seeds;
  }
  return mean;
}

}  // namespace armature::tools
