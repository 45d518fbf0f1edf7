#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/decimation/similar_decimation.h>
#include <armature/sdk/distance/measure.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <fmt/format.h>

#include "tools/commands/bench/bench.h"
#include "tools/commands/bench/sections.h"
#include "tools/commands/choices.h"
#include "tools/evaluation/planted.h"
#include "tools/evaluation/shapes.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

constexpr std::size_t kFew = 200;  // spheres that a user works with

struct DecimateBenchOptions {
  std::string models;
  std::vector<std::string> only;
  int rounds = 3;
  int turns = 1;
  double threshold = sdk::SimilarityOptions{}.threshold;
  bool adaptive = false;
  bool json = false;
};

/// How many times fewer steps than collapses there are, from the finest level and from so many spheres down.
struct Condensation {
  double all = 0, below = 0;
};
Condensation condensation_of(const sdk::Hierarchy& hierarchy) {
  const std::size_t few = std::min(kFew, hierarchy.leaf_count());
  std::size_t steps = 0;
  for (std::size_t k = 1; k <= hierarchy.step_count(); ++k) steps += hierarchy.spheres_after(k) < few ? 1U : 0U;
  const auto times = [](std::size_t collapses, std::size_t in_steps) {
    return in_steps == 0 ? 0.0 : static_cast<double>(collapses) / static_cast<double>(in_steps);
  };
  return {times(hierarchy.collapse_count(), hierarchy.step_count()), times(few - hierarchy.min_spheres(), steps)};
}

constexpr std::uint32_t kNoSide = 0xFFFF'FFFF;

/// Sides of a mesh that should be simplified alike: copies in it, or the halves of what is symmetric.
struct Sided {
  std::string name;
  sdk::Mesh mesh = {};
  std::vector<std::uint32_t> side = {};  ///< by vertex; kNoSide for what is on a plane of symmetry
  std::size_t sides = 2;
  bool may_mix = false;  ///< spheres may belong to two sides; else levels at which one does no longer count
};

/// The share of levels, down to one sphere a side, at which all sides have the same number of spheres: of all, and of
/// those with at most so many spheres a side.
struct Evenness {
  double all = 0, below = 0;
};
Evenness evenness_of(const sdk::Hierarchy& hierarchy, const Sided& model) {
  std::vector<std::uint32_t> side(model.side);
  std::vector<std::size_t> left(model.sides, 0);
  for (const auto k : side)
    if (k != kNoSide) ++left[k];
  side.resize(hierarchy.node_count());
  std::array<std::size_t, 2> even{};
  std::array<std::size_t, 2> levels{};
  std::size_t node = hierarchy.leaf_count();
  bool goes_on = true;
  for (std::size_t k = 1; k <= hierarchy.step_count() && goes_on; ++k) {
    for (; node < 2 * hierarchy.leaf_count() - hierarchy.spheres_after(k); ++node) {
      const auto [a, b] = hierarchy.children(sdk::NodeId(node));
      const std::array sides = {side[a.index()], side[b.index()]};
      goes_on = goes_on && (sides[0] == sides[1] || model.may_mix);
      side[node] = sides[0] == sides[1] ? sides[0] : kNoSide;
      for (const auto s : sides)
        if (s != kNoSide) --left[s];
      if (side[node] != kNoSide) ++left[side[node]];
    }
    goes_on = goes_on && std::ranges::all_of(left, [](std::size_t n) { return n > 0; });
    if (!goes_on) break;
    const bool same = std::ranges::all_of(left, [&](std::size_t n) { return n == left.front(); });
    for (const std::size_t i : {std::size_t{0}, std::size_t{1}}) {
      if (i == 1 && hierarchy.spheres_after(k) > kFew * model.sides) continue;
      ++levels[i];
      even[i] += same ? 1U : 0U;
    }
  }
  const auto share = [&](std::size_t i) {
    return levels[i] == 0 ? 0.0 : static_cast<double>(even[i]) / static_cast<double>(levels[i]);
  };
  return {share(0), share(1)};
}

Sided copies_of(const sdk::Mesh& model, const std::string& name, const PlantOptions& options) {
  const std::vector<sdk::FaceId> region = {sdk::FaceId(0)};
  const std::size_t sides = options.copies + 1;
  Sided result{.name = fmt::format("{} copies of {}", sides, name),
               .mesh = planted_models(model, region, options).mesh,
               .sides = sides};
  for (std::size_t v = 0; v < result.mesh.positions.size(); ++v)
    result.side.push_back(static_cast<std::uint32_t>(v / model.positions.size()));
  return result;
}

/// A model and a copy of it that was triangulated otherwise.
Expected<Sided> remeshed(const sdk::Mesh& model, const std::string& name, const sdk::Task& task) {
  const auto other = ours(sdk::decimate_mesh(model, {.vertices = 3 * model.positions.size() / 4}, task));
  if (!other) return tl::unexpected(other.error());
  Sided result{.name = name + ", remeshed copy", .mesh = model};
  const std::size_t offset = model.positions.size();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  const Eigen::Vector3d there(2 * sdk::bounding_box_diagonal(model), 0, 0);
  for (const auto& p : other->mesh.positions) result.mesh.positions.emplace_back(turn * p + there);
  for (const auto& [a, b, c] : other->mesh.triangles)
    result.mesh.triangles.push_back(
        {sdk::VertexId(a.index() + offset), sdk::VertexId(b.index() + offset), sdk::VertexId(c.index() + offset)});
  for (std::size_t v = 0; v < result.mesh.positions.size(); ++v) result.side.push_back(v < offset ? 0 : 1);
  return result;
}

/// Points of a model and a copy of them, turned or mirrored, beside them.
struct SidedPoints {
  Sided sides;  ///< without a mesh
  sdk::PointSet points = {};
};
SidedPoints copied(const sdk::PointSet& model, const std::string& name, bool mirrored) {
  SidedPoints result{.sides = {.name = "2 copies of " + name + (mirrored ? ", mirrored" : "")}, .points = model};
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& p : model.positions) box.extend(p);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix() *
                               Eigen::Vector3d(mirrored ? -1 : 1, 1, 1).asDiagonal();
  const Eigen::Vector3d there = box.center() + 2 * box.diagonal().norm() * Eigen::Vector3d::UnitX();
  for (const Eigen::Vector3d& p : model.positions)
    result.points.positions.emplace_back(turn * (p - box.center()) + there);
  for (const Eigen::Vector3d& n : model.normals) result.points.normals.emplace_back(turn * n);
  for (const std::uint32_t side : {0U, 1U})
    result.sides.side.insert(result.sides.side.end(), model.positions.size(), side);
  return result;
}

/// A creature of two halves that mirror one another.
Sided mirrored_creature(int rounds) {
  Sided result{.name = "mirrored creature", .mesh = creature(rounds), .may_mix = true};
  const sdk::Mesh ball = icosphere(rounds);  // which is symmetric
  std::map<std::array<long, 3>, std::size_t> at;
  const auto place = [](const Eigen::Vector3d& p) {
    return std::array{std::lround(1e6 * p.x()), std::lround(1e6 * p.y()), std::lround(1e6 * p.z())};
  };
  for (std::size_t v = 0; v < ball.positions.size(); ++v) at[place(ball.positions[v])] = v;
  for (std::size_t v = 0; v < ball.positions.size(); ++v) {
    const Eigen::Vector3d& p = ball.positions[v];
    const auto there = place(p);
    result.side.push_back(there[0] == 0 ? kNoSide : there[0] > 0 ? 0 : 1);
    if (there[0] == 0) result.mesh.positions[v].x() = 0;
    if (there[0] < 0)
      result.mesh.positions[v] =
          result.mesh.positions[at.at({-there[0], there[1], there[2]})].cwiseProduct(Eigen::Vector3d(-1, 1, 1));
  }
  return result;
}

/// The measures of chapter 6, a section each.
class DecimateBench : Report {
 public:
  explicit DecimateBench(DecimateBenchOptions options) : Report{options.json}, options_(std::move(options)) {
    similarity_.threshold = options_.threshold;
    similarity_.adaptive = options_.adaptive;
  }

  Expected<void> run() { return run_sections(*this, kSections, options_.only, call_, section_); }

  [[nodiscard]] static std::vector<std::string> sections() { return names_of(kSections); }

 private:
  static const Sections<DecimateBench, 5> kSections;

  /// Fewer steps, at which error.
  Expected<void> condensation() {
    title(
        "Steps: collapses over steps, of all and below 200 spheres (goal 3 or more); error over the plain one (1.1): "
        "mean of 25 to 200 spheres, then at some");
    // The five of the thesis, then others, by which nothing was chosen.
    for (const char* name :
         {"igl_armadillo.obj", "vh_camel.off", "os_cat-low-resolution.obj", "vh_Hand1.off", "ca_ants27.off",
          "c3d_cow.obj", "nr3d_gorilla0.off", "nr3d_centaur0.off", "vm_bear.off", "vm_dolphin.off", "c3d_homer.obj",
          "vh_horse.off", "vm_spider.off", "vm_octpus.off", "animal.off", ""}) {
      const bool ours_too = name[0] == '\0';
      const std::filesystem::path path = std::filesystem::path(options_.models) / name;
      if (!ours_too && (options_.models.empty() || !std::filesystem::exists(path))) continue;
      const auto mesh = ours_too ? Expected<sdk::Mesh>(creature(5)) : ours(sdk::read_mesh(path, {}, call_.task()));
      if (!mesh) return tl::unexpected(mesh.error());
      const auto turned = simplified(*mesh);
      if (!turned) return tl::unexpected(turned.error());
      const sdk::Hierarchy& similar = turned->front().similar;
      const auto fewer = condensation_of(similar);
      const auto mean = mean_error_ratio(*turned, 1);
      if (!mean) return tl::unexpected(mean.error());
      Json json = {{"section", section_},
                   {"name", ours_too ? "creature" : name},
                   {"error_ratio_mean", number(*mean)},
                   {"steps", similar.step_count()},
                   {"condensed", number(fewer.all)},
                   {"condensed_below_200", number(fewer.below)}};
      std::string errors;
      for (const std::size_t spheres : {1000U, 200U, 100U, 50U, 25U}) {
        const auto ratio = error_ratio(*turned, spheres);
        if (!ratio) return tl::unexpected(ratio.error());
        json[fmt::format("error_ratio_{}", spheres)] = number(*ratio);
        errors += fmt::format("  {}: {:.2f}", spheres, *ratio);
      }
      if (auto said = say(
              json, fmt::format("{:<28} {:6} steps  {:5.1f}  {:5.1f}  M12 {:.2f}, at{}", ours_too ? "creature" : name,
                                similar.step_count(), fewer.all, fewer.below, *mean, errors));
          !said)
        return said;
    }
    return {};
  }

  /// Copies that are simplified alike.
  Expected<void> symmetry() {
    title(
        "Symmetry: the share of levels at which all sides have the same number of spheres (goal 0.9); beside it plain");
    if (auto said = say_evenness(mirrored_creature(4)); !said) return said;
    for (const auto& [name, path] : {std::pair{"creature", ""}, std::pair{"vh_camel.off", "vh_camel.off"},
                                     std::pair{"ca_ants27.off", "ca_ants27.off"}}) {
      sdk::Mesh model = creature(4);
      if (path[0] != '\0') {
        if (options_.models.empty() || !std::filesystem::exists(std::filesystem::path(options_.models) / path))
          continue;
        auto read = ours(sdk::read_mesh(std::filesystem::path(options_.models) / path, {}, call_.task()));
        if (!read) return tl::unexpected(read.error());
        model = std::move(*read);
      }
      const std::string here = name;
      auto other = remeshed(model, here, call_.task());
      if (!other) return tl::unexpected(other.error());
      for (const Sided& sided :
           {copies_of(model, here, {.copies = 1}), copies_of(model, here, {.copies = 3}),
            copies_of(model, here + ", mirrored", {.copies = 1, .mirrored = true}),
            copies_of(model, here + ", noise 0.1 %", {.copies = 1, .noise_percent = 0.1}), std::move(*other)})
        if (auto said = say_evenness(sided); !said) return said;
    }
    return {};
  }

  Expected<void> say_evenness(const Sided& model) {
    const auto turned = simplified(model.mesh);
    if (!turned) return tl::unexpected(turned.error());
    const auto mean = mean_error_ratio(*turned, model.sides);
    if (!mean) return tl::unexpected(mean.error());
    const auto at_50 = error_ratio(*turned, 50 * model.sides);
    if (!at_50) return tl::unexpected(at_50.error());
    return say_evenness(model, turned->front().plain, turned->front().similar, ErrorRatios{*mean, *at_50});
  }

  /// Over 25 to 200 spheres a side, and at 50.
  struct ErrorRatios {
    double mean, at_50;
  };
  Expected<void> say_evenness(const Sided& model, const sdk::Hierarchy& plain, const sdk::Hierarchy& similar,
                              std::optional<ErrorRatios> errors) {
    const Evenness here = evenness_of(similar, model);
    const Evenness there = evenness_of(plain, model);
    Json json = {{"section", section_},
                 {"name", model.name},
                 {"even", number(here.all)},
                 {"even_below_200", number(here.below)},
                 {"plain_even", number(there.all)},
                 {"plain_even_below_200", number(there.below)}};
    if (errors) {
      json["error_ratio_mean"] = number(errors->mean);
      json["error_ratio_50_a_side"] = number(errors->at_50);
    }
    return say(json, fmt::format("{:<40} {:.3f}, below 200 each {:.3f}; plain {:.3f}, {:.3f}", model.name, here.all,
                                 here.below, there.all, there.below) +
                         (errors ? fmt::format("; M12 {:.2f}, at 50 each {:.2f}", errors->mean, errors->at_50) : ""));
  }

  /// A mesh that was turned, and what becomes of it.
  struct Simplified {
    sdk::Mesh mesh;
    sdk::Hierarchy plain, similar;
  };
  /// Which of two limbs loses a sphere first is a matter of the last digits, and at one level an error varies by a
  /// tenth for it; so a mesh is looked at as it is and turned, each time as another.
  Expected<std::vector<Simplified>> simplified(const sdk::Mesh& mesh) {
    std::vector<Simplified> result;
    for (int k = 0; k < options_.turns; ++k) {
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(k, Eigen::Vector3d(1 + k, 2, 3 - k).normalized()).toRotationMatrix();
      sdk::Mesh turned = mesh;
      if (k > 0)
        for (Eigen::Vector3d& p : turned.positions) p = turn * p;
      auto plain = ours(sdk::build_hierarchy(turned, {}, call_.task()));
      if (!plain) return tl::unexpected(plain.error());
      auto similar = ours(sdk::build_similar_hierarchy(turned, {}, similarity_, call_.task()));
      if (!similar) return tl::unexpected(similar.error());
      result.push_back({std::move(turned), std::move(plain->hierarchy), std::move(similar->build.hierarchy)});
    }
    return result;
  }

  /// The mean distance from a mesh to a level where like regions go together over that to a plain one, of its turns.
  Expected<double> error_ratio(std::span<const Simplified> turns, std::size_t spheres) {
    double plain = 0;
    double similar = 0;
    for (const Simplified& turn : turns) {
      const auto of_plain = error_at(turn.mesh, turn.plain, spheres);
      if (!of_plain) return of_plain;
      const auto of_similar = error_at(turn.mesh, turn.similar, spheres);
      if (!of_similar) return of_similar;
      plain += *of_plain;
      similar += *of_similar;
    }
    return similar / plain;
  }

  /// The geometric mean of that over levels of 25 to 200 spheres a side, each the square root of two times the last.
  Expected<double> mean_error_ratio(std::span<const Simplified> turns, std::size_t sides) {
    constexpr std::array kSpheres = {25U, 35U, 50U, 71U, 100U, 141U, 200U};
    double sum = 0;
    for (const std::size_t spheres : kSpheres) {
      const auto ratio = error_ratio(turns, spheres * sides);
      if (!ratio) return ratio;
      sum += std::log(*ratio);
    }
    return std::exp(sum / kSpheres.size());
  }

  /// The mean distance from a mesh to a level of its hierarchy.
  Expected<double> error_at(const sdk::Mesh& mesh, const sdk::Hierarchy& hierarchy, std::size_t spheres) {
    const auto level = ours(hierarchy.level(spheres));
    if (!level) return tl::unexpected(level.error());
    const auto error = ours(sdk::measure(mesh, *level, {.samples = 20'000}, call_.task()));
    if (!error) return tl::unexpected(error.error());
    return error->mean_input_to_approximation;
  }

  /// What it costs, from 5 thousand to a million triangles, and where there are copies, few or many.
  Expected<void> growth() {
    title(
        "Growth: milliseconds of processor time, the least of some rounds in turns; goal: 3 times the plain "
        "decimation");
    sdk::Mesh mesh = creature(4);
    for (int round = 0; round < 5; ++round) {
      if (round > 0) mesh = subdivided(mesh);
      if (auto said = say_cost({.name = "creature", .mesh = mesh}); !said) return said;
    }
    for (const Sided& model : {mirrored_creature(6), copies_of(creature(5), "creature", {.copies = 1}),
                               copies_of(creature(6), "creature", {.copies = 1}),
                               copies_of(creature(4), "creature, noise 0.1 %", {.copies = 9, .noise_percent = 0.1}),
                               copies_of(creature(2), "creature, noise 1 %", {.copies = 199, .noise_percent = 1})})
      if (auto said = say_cost(model); !said) return said;
    return {};
  }

  Expected<void> say_cost(const Sided& model) {
    enum { Plain, Similar, Descriptors };
    std::array<double, 3> least;
    least.fill(std::numeric_limits<double>::infinity());
    for (int k = 0; k < options_.rounds; ++k) {
      std::clock_t start = std::clock();
      const auto took = [&](std::size_t what) {
        const std::clock_t now = std::clock();
        least[what] = std::min(least[what], 1e3 * static_cast<double>(now - start) / CLOCKS_PER_SEC);
        start = std::clock();
      };
      if (const auto plain = ours(sdk::build_hierarchy(model.mesh, {}, call_.task())); !plain)
        return tl::unexpected(plain.error());
      took(Plain);
      const auto descriptor = ours(sdk::region_descriptor(model.mesh, similarity_, call_.task()));
      if (!descriptor) return tl::unexpected(descriptor.error());
      took(Descriptors);
      if (const auto similar =
              ours(sdk::build_similar_hierarchy(model.mesh, **descriptor, {}, similarity_, call_.task()));
          !similar)
        return tl::unexpected(similar.error());
      took(Similar);
    }
    return say({{"section", section_},
                {"name", model.name},
                {"triangles", model.mesh.triangles.size()},
                {"plain_ms", number(least[Plain])},
                {"similar_ms", number(least[Similar])},
                {"descriptor_ms", number(least[Descriptors])}},
               fmt::format("{:<36} {:8} triangles  plain {:8.1f}  similar {:8.1f} ({:.2f} times)  descriptors {:8.1f}",
                           model.name, model.mesh.triangles.size(), least[Plain], least[Similar],
                           least[Similar] / least[Plain], least[Descriptors]));
  }

  /// All that regions can be compared by.
  Expected<void> descriptors() {
    title("Descriptors, on the creature: condensation of all and below 200 spheres");
    const sdk::Mesh mesh = creature(5);
    for (const auto& [name, descriptor, threshold] :
         {std::tuple{"gls-histogram", sdk::RegionDescriptor::GlsHistograms, options_.threshold},
          std::tuple{"gls-scaled", sdk::RegionDescriptor::ScaledGlsHistograms, options_.threshold},
          std::tuple{"gls-mean", sdk::RegionDescriptor::GlsMean, 0.01},
          std::tuple{"gls-merged", sdk::RegionDescriptor::MergedGls, 0.01},
          std::tuple{"quadric", sdk::RegionDescriptor::Quadric, 0.01}}) {
      const auto similar = ours(
          sdk::build_similar_hierarchy(mesh, {}, {.descriptor = descriptor, .threshold = threshold}, call_.task()));
      if (!similar) return tl::unexpected(similar.error());
      const auto fewer = condensation_of(similar->build.hierarchy);
      if (auto said =
              say({{"section", section_},
                   {"name", name},
                   {"threshold", threshold},
                   {"condensed", number(fewer.all)},
                   {"condensed_below_200", number(fewer.below)},
                   {"descriptor_ms", number(similar->descriptor_ms)},
                   {"decimate_ms", number(similar->build.statistics.decimate_ms)}},
                  fmt::format("{:<14} below {:.2f}  {:5.1f}  {:5.1f}  {:.0f} + {:.0f} ms", name, threshold, fewer.all,
                              fewer.below, similar->descriptor_ms, similar->build.statistics.decimate_ms));
          !said)
        return said;
    }
    return {};
  }

  /// Points instead of a mesh: as close to it, as condensed, as even.
  Expected<void> points() {
    title(
        "Points: M12 at 100 and 50 spheres of the mesh, and how many times that of as many points as it has vertices, "
        "evenly\nby area, and of its vertices with their normals (goal at most 1.10 to 1.25); condensation of points "
        "below 200 (3)");
    std::vector<SidedPoints> copies;
    std::array<double, 4> logs{};
    std::size_t count = 0;
    for (const char* name :
         {"vh_camel.off", "ca_ants27.off", "c3d_cow.obj", "os_cat-low-resolution.obj", "nr3d_gorilla0.off",
          "nr3d_centaur0.off", "vm_bear.off", "vm_dolphin.off", "vm_chair.off", "vh_horse.off", ""}) {
      const bool ours_too = name[0] == '\0';
      const std::filesystem::path path = std::filesystem::path(options_.models) / name;
      if (!ours_too && (options_.models.empty() || !std::filesystem::exists(path))) continue;
      const auto mesh = ours_too ? Expected<sdk::Mesh>(creature(5)) : ours(sdk::read_mesh(path, {}, call_.task()));
      if (!mesh) return tl::unexpected(mesh.error());
      const std::string called = ours_too ? "creature" : name;
      const sdk::PointSet samples = sdk::sample_points(*mesh, mesh->positions.size());
      sdk::PointSet vertices = sdk::point_set_of(*mesh);
      vertices.areas.clear();
      const auto of_mesh = ours(sdk::build_hierarchy(*mesh, {}, call_.task()));
      const auto of_samples = ours(sdk::build_hierarchy(samples, {}, call_.task()));
      const auto of_vertices = ours(sdk::build_hierarchy(vertices, {}, call_.task()));
      const auto similar = ours(sdk::build_similar_hierarchy(samples, {}, similarity_, call_.task()));
      for (const auto* built : {&of_mesh, &of_samples, &of_vertices})
        if (!*built) return tl::unexpected(built->error());
      if (!similar) return tl::unexpected(similar.error());
      const auto fewer = condensation_of(similar->build.hierarchy);
      Json json = {{"section", section_},
                   {"name", called},
                   {"points", samples.positions.size()},
                   {"condensed_below_200", number(fewer.below)}};
      std::string line = fmt::format("{:<26} {:6}", called, samples.positions.size());
      std::size_t at = 0;
      for (const std::size_t spheres : {100U, 50U}) {
        std::array<double, 3> mean{};
        const std::array all = {&of_mesh->hierarchy, &of_samples->hierarchy, &of_vertices->hierarchy};
        for (std::size_t k = 0; k < all.size(); ++k) {
          const auto error = error_at(*mesh, *all[k], spheres);
          if (!error) return tl::unexpected(error.error());
          mean[k] = *error;
        }
        json[fmt::format("error_{}", spheres)] = number(mean[0]);
        json[fmt::format("samples_ratio_{}", spheres)] = number(mean[1] / mean[0]);
        json[fmt::format("vertices_ratio_{}", spheres)] = number(mean[2] / mean[0]);
        line += fmt::format("  {}: {:.3f} {:.2f} {:.2f}", spheres, mean[0], mean[1] / mean[0], mean[2] / mean[0]);
        for (const std::size_t k : {std::size_t{1}, std::size_t{2}}) logs[at++] += std::log(mean[k] / mean[0]);
      }
      ++count;
      if (auto said = say(json, line + fmt::format("  {:.1f}", fewer.below)); !said) return said;
      if (ours_too || called == "vh_camel.off" || called == "ca_ants27.off")
        for (const bool mirrored : {false, true}) copies.push_back(copied(samples, called, mirrored));
    }
    for (double& log : logs) log = std::exp(log / static_cast<double>(count));
    if (auto said = say({{"section", section_},
                         {"name", "geometric mean"},
                         {"samples_ratio_100", number(logs[0])},
                         {"vertices_ratio_100", number(logs[1])},
                         {"samples_ratio_50", number(logs[2])},
                         {"vertices_ratio_50", number(logs[3])}},
                        fmt::format("{:<33}  100:       {:.2f} {:.2f}  50:       {:.2f} {:.2f}", "geometric mean",
                                    logs[0], logs[1], logs[2], logs[3]));
        !said)
      return said;
    title("Copies of points: the share of levels at which both have the same number of spheres (goal 0.9 below 200)");
    for (const SidedPoints& model : copies) {
      const auto plain = ours(sdk::build_hierarchy(model.points, {}, call_.task()));
      if (!plain) return tl::unexpected(plain.error());
      const auto similar = ours(sdk::build_similar_hierarchy(model.points, {}, similarity_, call_.task()));
      if (!similar) return tl::unexpected(similar.error());
      if (auto said = say_evenness(model.sides, plain->hierarchy, similar->build.hierarchy, {}); !said) return said;
    }
    return {};
  }

  DecimateBenchOptions options_;
  sdk::SimilarityOptions similarity_;
  SdkCall call_;
  std::string section_;
};

const Sections<DecimateBench, 5> DecimateBench::kSections = {{{"condensation", &DecimateBench::condensation},
                                                              {"symmetry", &DecimateBench::symmetry},
                                                              {"growth", &DecimateBench::growth},
                                                              {"descriptors", &DecimateBench::descriptors},
                                                              {"points", &DecimateBench::points}}};

}  // namespace

void add_bench_decimate(CLI::App& bench, Run& run) {
  auto options = std::make_shared<DecimateBenchOptions>();
  CLI::App* command = bench.add_subcommand(
      "decimate", "How similarity condenses hierarchies, keeps copies alike, and what it costs (thesis, chapter 6).");
  command->add_option("--models", options->models, "a folder with the thesis's models; else our own shapes alone")
      ->type_name("FOLDER");
  command
      ->add_option("--only", options->only,
                   "sections: " + fmt::format("{}", fmt::join(DecimateBench::sections(), ", ")))
      ->check(CLI::IsMember(DecimateBench::sections()))
      ->delimiter(',');
  command->add_option("--similar", options->threshold, "the threshold of histograms")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_flag("--adaptive", options->adaptive, "the first gap instead of a threshold");
  command->add_option("--rounds", options->rounds, "of the growth")->check(CLI::Range(1, 100))->capture_default_str();
  command
      ->add_option("--turns", options->turns,
                   "of condensation and symmetry: errors are means over so many turns of a model")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--json", options->json, "one JSON object a line");
  command->footer(
      "Examples:\n  armature bench decimate --only growth\n"
      "  armature bench decimate --models meshes --only symmetry,condensation --turns 8");
  command->callback([options, &run] { run = [options] { return DecimateBench(*options).run(); }; });
}

}  // namespace armature::tools
