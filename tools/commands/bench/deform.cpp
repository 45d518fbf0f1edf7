#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <armature/sdk/deformation/refit.h>
#include <armature/sdk/deformation/skinned_level.h>
#include <armature/sdk/deformation/skinning.h>
#include <armature/sdk/deformation/sphere_move.h>
#include <armature/sdk/deformation/sphere_weights.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/laplacian/laplacian.h>
#include <armature/sdk/mesh/measures.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include "tools/commands/bench/bench.h"
#include "tools/commands/bench/deform_tubes.h"
#include "tools/commands/bench/sections.h"
#include "tools/commands/choices.h"
#include "tools/elapsed.h"
#include "tools/evaluation/bounded_biharmonic.h"
#include "tools/evaluation/shapes.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct DeformBenchOptions {
  std::vector<std::string> meshes;
  std::vector<std::string> only;
  std::size_t spheres = 50;
  std::size_t handles = 1;
  int rounds = 20;
  bool json = false;
};

/// The fastest of some rounds, in milliseconds.
template <class F>
double fastest(int rounds, F&& f) {
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const auto start = std::chrono::steady_clock::now();
    f();
    best = std::min(best, milliseconds_since(start));
  }
  return best;
}

/// The fastest of some rounds of each step, [steps]: their median and their slowest.
struct StepTimes {
  double median, slowest;
  explicit StepTimes(std::vector<double> ms) : slowest(*std::ranges::max_element(ms)) {
    std::ranges::nth_element(ms, ms.begin() + static_cast<std::ptrdiff_t>(ms.size() / 2));
    median = ms[ms.size() / 2];
  }
};

/// One mesh, one measure a method.
class MeshBench {
 public:
  MeshBench(std::string name, sdk::Mesh mesh, const DeformBenchOptions& options)
      : name_(std::move(name)), mesh_(std::move(mesh)), options_(options) {}

  Expected<void> run(SdkCall& call) {
    auto built = ours(sdk::build_hierarchy(mesh_, {}, call.task()));
    if (!built) return fail(name_ + ": " + built.error().message);
    hierarchy_ = std::move(built->hierarchy);
    if (hierarchy_.min_spheres() > options_.spheres || hierarchy_.leaf_count() <= options_.spheres)
      return fail(fmt::format("{}: has no level of {} spheres; choose other --spheres", name_, options_.spheres));
    return factor().and_then([&] { return levels(); }).and_then([&] { return frames(); }).and_then([&] {
      return baselines(call);
    });
  }

 private:
  Expected<void> factor() {
    laplacian_ = sdk::laplacian(mesh_, sdk::Adjacency(mesh_));
    const int rounds = std::max(3, options_.rounds / 4);
    const double laplacian_ms = fastest(rounds, [&] { (void)sdk::laplacian(mesh_, sdk::Adjacency(mesh_)); });
    const double length = sdk::HeatOptions{}.reach * sdk::bounding_box_diagonal(mesh_);
    Eigen::SparseMatrix<double> A = laplacian_.stiffness;
    for (Eigen::Index v = 0; v < A.rows(); ++v)
      A.coeffRef(v, v) += laplacian_.mass[v] > 0 ? laplacian_.mass[v] / (length * length) : 1;
    const double factor_ms = fastest(rounds, [&] { (void)sdk::SparseFactor::of(A, mesh_.positions); });
    auto diffusion = ours(sdk::HeatDiffusion::of(mesh_));
    if (!diffusion) return fail(name_ + ": " + diffusion.error().message);
    diffusion_ = std::make_unique<sdk::HeatDiffusion>(std::move(*diffusion));
    return say("laplacian", laplacian_ms, "ms", "the intrinsic Delaunay Laplacian, once a mesh").and_then([&] {
      return say("factor", factor_ms, "ms", "L + lambda M, order included, once a mesh");
    });
  }

  /// One level finer and one coarser, over levels 1 to 200, and a level from nothing.
  Expected<void> levels() {
    constexpr std::size_t kFinest = 200;
    const std::size_t coarsest = hierarchy_.min_spheres();
    const std::size_t finest = std::min(std::max(kFinest, coarsest + 1), hierarchy_.leaf_count());
    const int rounds = std::max(3, options_.rounds / 4);
    std::vector<double> finer_ms(finest - coarsest, std::numeric_limits<double>::infinity());
    std::vector<double> coarser_ms = finer_ms;
    for (int round = 0; round < rounds; ++round) {
      sdk::SphereWeights weights(*diffusion_, hierarchy_);
      const auto step_to = [&](std::size_t n, double& ms) {
        ms = std::min(ms, fastest(1, [&] { (void)weights.of(hierarchy_.nodes_of_level(n)); }));
      };
      (void)weights.of(hierarchy_.nodes_of_level(coarsest));
      for (std::size_t n = coarsest; n < finest; ++n) step_to(n + 1, finer_ms[n - coarsest]);
      for (std::size_t n = finest; n > coarsest; --n) step_to(n - 1, coarser_ms[n - 1 - coarsest]);
    }
    all_weights_ms_ = fastest(rounds, [&] {
      (void)sdk::SphereWeights(*diffusion_, hierarchy_).of(hierarchy_.nodes_of_level(options_.spheres));
    });
    const StepTimes finer(std::move(finer_ms));
    const StepTimes coarser(std::move(coarser_ms));
    return say("finer", finer.median, "ms", "new weights one level finer, in the median of levels 1 to 200")
        .and_then([&] { return say("finer at most", finer.slowest, "ms", "the same, the slowest of these levels"); })
        .and_then([&] { return say("coarser", coarser.median, "ms", "one level coarser again, in the median"); })
        .and_then([&] { return say("coarser at most", coarser.slowest, "ms", "the same, the slowest"); })
        .and_then([&] {
          return say("first level", all_weights_ms_, "ms",
                     fmt::format("all weights of the level of {}, from nothing", options_.spheres));
        });
  }

  /// All spheres move, each its own way.
  Expected<void> frames() {
    const auto nodes = hierarchy_.nodes_of_level(options_.spheres);
    sdk::SphereWeights weights(*diffusion_, hierarchy_);
    const sdk::SkinWeights skin = weights.of(nodes);
    auto motions = sdk::at_rest(hierarchy_.level(options_.spheres)->spheres);
    auto turns = motions;
    const Eigen::Vector3d middle = sdk::bounding_box(mesh_).center();
    const double diagonal = sdk::bounding_box_diagonal(mesh_);
    for (std::size_t s = 0; s < motions.size(); ++s) {
      const double part = static_cast<double>(s) / static_cast<double>(motions.size());
      const Eigen::Vector3d rotate(0.3 * part, 0.2, -0.1 * part);
      const Eigen::Vector3d translate(0.01 * diagonal * part, 0.005 * diagonal, 0);
      sdk::move_spheres({.spheres = {sdk::SphereId(s)}, .translate = translate, .rotate = rotate}, motions);
      sdk::move_spheres({.spheres = {sdk::SphereId(s)}, .rotate = rotate, .about = middle}, turns);
    }
    std::vector<Eigen::Vector3d> out = mesh_.positions;
    std::size_t entries = 0;
    for (const auto& column : skin.columns) entries += column->vertices.size();
    const auto time = [&](sdk::Blend blend) {
      return fastest(5 * options_.rounds, [&] { sdk::skin(skin, motions, blend, mesh_.positions, out); });
    };
    const double linear = time(sdk::Blend::Linear);
    const double dual = time(sdk::Blend::DualQuaternions);
    sdk::SkinnedLevel level(skin, *hierarchy_.level(options_.spheres), mesh_);
    const double kept = fastest(5 * options_.rounds,
                                [&] { level.move(turns, sdk::Blend::DualQuaternions, out, sdk::Volume::KeptByTurns); });
    level.move(motions, sdk::Blend::DualQuaternions, out);
    const sdk::Refit refit(mesh_, hierarchy_);
    const double refit_ms = fastest(5 * options_.rounds, [&] { (void)refit.fit(nodes, out); });
    return say("influences", static_cast<double>(entries) / static_cast<double>(out.size()), "",
               "spheres that move a vertex, in the mean")
        .and_then([&] { return say("frame", dual, "ms", "all vertices by dual quaternions, all spheres moving"); })
        .and_then([&] { return say("frame, volume kept", kept, "ms", "all spheres turning, with the volume kept"); })
        .and_then([&] { return say("frame, linear", linear, "ms", "the same by linear blending"); })
        .and_then([&] { return say("refit", refit_ms, "ms", "all spheres of the level, everything moved"); });
  }

  /// What others do.
  Expected<void> baselines(SdkCall& call) {
    const auto nodes = hierarchy_.nodes_of_level(options_.spheres + 1);
    const auto count = static_cast<Eigen::Index>(mesh_.positions.size());
    constexpr int kRounds = 3;
    const double naive_ms = fastest(kRounds, [&] {
      const auto diffusion = sdk::HeatDiffusion::of(mesh_);
      Eigen::MatrixXd p = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(nodes.size()));
      for (std::size_t s = 0; s < nodes.size(); ++s)
        for (const auto v : hierarchy_.vertices(nodes[s]))
          p(static_cast<Eigen::Index>(v.index()), static_cast<Eigen::Index>(s)) = 1;
      diffusion->diffuse(p);
    });
    double ours_ms = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
      sdk::SphereWeights weights(*diffusion_, hierarchy_);
      (void)weights.of(hierarchy_.nodes_of_level(options_.spheres));
      ours_ms = std::min(ours_ms, fastest(1, [&] { (void)weights.of(nodes); }));
    }
    if (auto said = say("factored again", naive_ms, "ms", "baseline: a level finer with a new factor and every column");
        !said)
      return said;
    if (auto said = say("ratio", naive_ms / ours_ms, "times", "that to the same step here"); !said) return said;
    if (options_.handles == 0 || call.interrupted()) return {};
    std::vector<sdk::VertexId> handles;
    for (const auto node : hierarchy_.nodes_of_level(options_.spheres)) handles.push_back(middle_of(node));
    int factorisations = 0;
    const std::size_t measured = std::min(options_.handles, handles.size());
    const double bounded_ms = fastest(1,
                                      [&] {
                                        for (std::size_t h = 0; h < measured; ++h)
                                          factorisations +=
                                              bounded_biharmonic_weights(laplacian_, handles, h).factorisations;
                                      }) /
                              static_cast<double>(measured);
    const double level_ms = bounded_ms * static_cast<double>(handles.size());
    return say("bounded biharmonic", bounded_ms, "ms",
               fmt::format("baseline: one handle, {} factorisations for {} of {}", factorisations, measured,
                           handles.size()))
        .and_then([&] {
          return say("ratio", level_ms / all_weights_ms_, "times",
                     "all handles of the level, by that one, to all weights of the level here");
        });
  }

  [[nodiscard]] sdk::VertexId middle_of(sdk::NodeId node) const {
    const auto own = hierarchy_.vertices(node);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto v : own) mean += mesh_.position(v) / static_cast<double>(own.size());
    return *std::ranges::min_element(own, {},
                                     [&](sdk::VertexId v) { return (mesh_.position(v) - mean).squaredNorm(); });
  }

  Expected<void> say(const std::string& what, double value, const std::string& unit, const std::string& note) const {
    if (options_.json)
      return write_json_line(stdout, {{"mesh", name_},
                                      {"vertices", mesh_.positions.size()},
                                      {"spheres", options_.spheres},
                                      {"measure", what},
                                      {"value", number(value)},
                                      {"unit", unit},
                                      {"note", note}});
    fmt::print("{:<24} {:>7} vertices  {:<18} {:>10.2f} {:<5} {}\n", name_, mesh_.positions.size(), what, value, unit,
               note);
    return {};
  }

  std::string name_;
  sdk::Mesh mesh_;
  const DeformBenchOptions& options_;
  sdk::Hierarchy hierarchy_;
  sdk::Laplacian laplacian_;
  std::unique_ptr<const sdk::HeatDiffusion> diffusion_;
  double all_weights_ms_ = 0;
};

class DeformBench {
 public:
  explicit DeformBench(DeformBenchOptions options) : options_(std::move(options)) {}

  Expected<void> run() {
    const tbb::global_control one_core(tbb::global_control::max_allowed_parallelism, 1);
    std::string section;
    return run_sections(*this, kSections, options_.only, call_, section);
  }
  /// The names of the experiments, in their order.
  [[nodiscard]] static std::vector<std::string> sections() { return names_of(kSections); }

 private:
  static const Sections<DeformBench, 2> kSections;

  Expected<void> times() {
    if (options_.meshes.empty()) {
      constexpr int kRounds = 6;
      return MeshBench("creature", creature(kRounds), options_).run(call_);
    }
    for (const std::string& file : options_.meshes) {
      const auto mesh = ours(sdk::read_mesh(file, {}, call_.task()));
      if (!mesh) return tl::unexpected(mesh.error());
      if (auto done = MeshBench(std::filesystem::path(file).filename().string(), *mesh, options_).run(call_); !done)
        return done;
      if (call_.interrupted()) return fail("stopped on request");
    }
    return {};
  }
  Expected<void> tubes() { return bench_tubes({options_.json}, call_); }

  DeformBenchOptions options_;
  SdkCall call_;
};

constexpr Sections<DeformBench, 2> DeformBench::kSections = {
    {{"times", &DeformBench::times}, {"tubes", &DeformBench::tubes}}};

}  // namespace

void add_bench_deform(CLI::App& bench, Run& run) {
  auto options = std::make_shared<DeformBenchOptions>();
  CLI::App* command = bench.add_subcommand("deform",
                                           "Time of deforming meshes by their spheres, on one core; the fastest of "
                                           "some rounds. And how well tubes keep their "
                                           "volume where they are bent.");
  command->add_option("MESH", options->meshes, "triangle meshes; a generated one of 41,000 vertices if left out");
  command->add_option("--only", options->only, "some of the experiments")
      ->delimiter(',')
      ->check(CLI::IsMember(DeformBench::sections()));
  command->add_option("--spheres", options->spheres, "of the level that moves the mesh")
      ->check(CLI::Range(2, 10'000))
      ->capture_default_str();
  command->add_option("--rounds", options->rounds, "how often each is measured")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--handles", options->handles, "of how many handles bounded biharmonic weights are solved")
      ->check(CLI::Range(0, 10'000))
      ->capture_default_str();
  command->add_flag("--json", options->json, "one JSON object a measure");
  command->footer(
      "Goals: factor 150 ms and a level 5 ms at 43,000 vertices; frame 2 ms and refit 5 ms at 100,000, 50 spheres.\n"
      "The baselines are programs of this benchmark: heat weights that factor anew for each level, and bounded\n"
      "biharmonic weights by an active set.\n\n"
      "Example:\n  armature bench deform armadillo.obj dragon.ply --only times");
  command->callback([options, &run] { run = [options] { return DeformBench(*options).run(); }; });
}

}  // namespace armature::tools
