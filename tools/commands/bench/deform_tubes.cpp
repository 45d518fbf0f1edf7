#include "tools/commands/bench/deform_tubes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

#include <armature/sdk/deformation/heat_diffusion.h>
#include <armature/sdk/deformation/skinned_level.h>
#include <armature/sdk/deformation/sphere_move.h>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/mesh/orientation.h>

#include "tools/evaluation/shapes.h"

namespace armature::tools {
namespace {

struct Kind {
  const char* name;
  double twist;          // in radians a radius
  double noise_percent;  // of the diagonal
};
constexpr std::array<Kind, 5> kKinds = {{{"smooth", 0, 0},
                                         {"twisted by 0.1", 0.1, 0},
                                         {"twisted by 0.5", 0.5, 0},
                                         {"noise of 0.05 %", 0, 0.05},
                                         {"noise of 0.2 %", 0, 0.2}}};
constexpr std::array kAround = {24, 48};
constexpr int kShortest = 4, kLongest = 32, kStep = 2;  // in radii
constexpr double kOff = 0.02;

constexpr std::array kLevels = {6, 10, 20};
constexpr std::array kHinges = {0.01, 0.15, -0.2};  // along the tube
constexpr std::array kAngles = {0.5, 1.0, 1.5};

/// By how much of it the volume of a tube changes at most, where what lies beyond a hinge turns by an angle.
struct Bent {
  double volume = 0;
  double compactness = 0;
};

Expected<Bent> bend(const sdk::Mesh& tube, double length, std::optional<double> compactness, SdkCall& call) {
  auto built = ours(sdk::build_hierarchy(tube, {.compactness = compactness}, call.task()));
  if (!built) return tl::unexpected(built.error());
  const sdk::Hierarchy& hierarchy = built->hierarchy;
  const auto diffusion = ours(sdk::HeatDiffusion::of(tube, {}, call.task()));
  if (!diffusion) return tl::unexpected(diffusion.error());
  const sdk::Components whole{.of_face = std::vector<std::uint32_t>(tube.triangles.size(), 0), .count = 1};
  const double before = sdk::signed_volumes(tube, whole)[0];
  sdk::SphereWeights weights(*diffusion, hierarchy);
  sdk::Mesh bent = tube;
  Bent result{.compactness = built->statistics.compactness};
  for (const auto spheres : kLevels) {
    const auto shape = hierarchy.level(static_cast<std::size_t>(spheres)).value();
    sdk::SkinnedLevel level(weights.of(hierarchy.nodes_of_level(shape.spheres.size())), shape, tube);
    for (const double hinge : kHinges)
      for (const double angle : kAngles) {
        const Eigen::Vector3d about(hinge * length, 0, 0);
        sdk::SphereMove move{.rotate = {0, 0, angle}, .about = about};
        for (std::size_t s = 0; s < shape.spheres.size(); ++s)
          if (shape.spheres[s].centre.x() > about.x()) move.spheres.emplace_back(s);
        if (move.spheres.empty()) continue;
        auto motions = sdk::at_rest(shape.spheres);
        sdk::move_spheres(move, motions);
        level.move(motions, sdk::Blend::DualQuaternions, bent.positions, sdk::Volume::KeptByTurns);
        result.volume = std::max(result.volume, std::abs(sdk::signed_volumes(bent, whole)[0] / before - 1));
      }
  }
  return result;
}

/// What is true of some tubes together.
struct Tally {
  int tubes = 0, across = 0, off = 0;
  double least_off = HUGE_VAL, most = 0;  // the least of those that are off, and the most of all

  void add(const Bent& bent) {
    ++tubes;
    across += bent.compactness > 0 ? 1 : 0;
    most = std::max(most, bent.volume);
    if (bent.volume <= kOff) return;
    ++off;
    least_off = std::min(least_off, bent.volume);
  }
};

Expected<void> say(const Report& report, const std::string& kind, const char* compactness, const Tally& tally) {
  return report.say(
      {{"section", "tubes"},
       {"kind", kind},
       {"compactness", compactness},
       {"tubes", tally.tubes},
       {"cut_across", tally.across},
       {"off", tally.off},
       {"least_off", number(tally.off > 0 ? tally.least_off : 0)},
       {"most", number(tally.most)}},
      fmt::format("{:<16} {:<8} {:>3} tubes, {:>3} cut across  {:>3} off by more than 2 %  at most {:.1e}", kind,
                  compactness, tally.tubes, tally.across, tally.off, tally.most));
}

}  // namespace

Expected<void> bench_tubes(const Report& report, SdkCall& call) {
  report.title("Straight tubes bent at hinges of 0.5 to 1.5 rad by 6, 10 and 20 spheres: how far the volume is off");
  std::array<Tally, 2> all;
  constexpr std::array<std::optional<double>, 2> kCompactness = {std::nullopt, 0.0};
  constexpr std::array kNames = {"found", "0"};
  for (const auto& [name, twist, noise_percent] : kKinds) {
    std::array<Tally, 2> tallies;
    for (const int around : kAround)
      for (int length = kShortest; length <= kLongest; length += kStep) {
        const sdk::Mesh tube = with_noise(straight_tube(length, around, twist), noise_percent, 1);
        for (std::size_t c = 0; c < kCompactness.size(); ++c) {
          const auto bent = bend(tube, length, kCompactness[c], call);
          if (!bent) return tl::unexpected(bent.error());
          tallies[c].add(*bent);
          all[c].add(*bent);
        }
        if (call.interrupted()) return fail("stopped on request");
      }
    for (std::size_t c = 0; c < tallies.size(); ++c)
      if (auto said = say(report, name, kNames[c], tallies[c]); !said) return said;
  }
  for (std::size_t c = 0; c < all.size(); ++c)
    if (auto said = say(report, "all", kNames[c], all[c]); !said) return said;
  return {};
}

}  // namespace armature::tools
