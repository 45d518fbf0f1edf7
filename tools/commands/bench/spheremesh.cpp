#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <armature/sdk/distance/measure.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/hierarchy/decimate_mesh.h>
#include <armature/sdk/hierarchy/level_cursor.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/spheremesh/refine.h>
#include <fmt/format.h>

#include "tools/commands/bench/bench.h"
#include "tools/commands/bench/sections.h"
#include "tools/commands/choices.h"
#include "tools/elapsed.h"
#include "tools/evaluation/published.h"
#include "tools/evaluation/shapes.h"
#include "tools/json_lines.h"
#include "tools/peak_memory.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct SphereMeshBenchOptions {
  std::string models;
  std::vector<std::string> only;
  bool json = false;
};

/// One approximation of one model, and how it came out.
struct Approximation {
  std::size_t spheres = 0, edges = 0, triangles = 0;
  sdk::BuildStatistics took;
  double refine_ms = 0;
  sdk::ApproximationErrors errors;
};

/// The experiments of the thesis's section 4.8, and those that are ours, one method each.
class SphereMeshBench {
 public:
  explicit SphereMeshBench(SphereMeshBenchOptions options) : options_(std::move(options)) {}

  Expected<void> run() { return run_sections(*this, kSections, options_.only, call_, section_); }

  /// The names of the experiments, in their order.
  [[nodiscard]] static std::vector<std::string> sections() { return names_of(kSections); }

 private:
  static const Sections<SphereMeshBench, 8> kSections;

  /// Table 4.1, beside what is printed there.
  Expected<void> table() {
    title("Table 4.1: sphere-meshes with the thesis's settings, and QEM, beside the printed values");
    for (const PublishedRow& row : kTable41) {
      auto mesh = model(row.file);
      if (!mesh) return tl::unexpected(mesh.error());
      if (!*mesh) continue;
      const std::string name(row.model);
      const auto spheres = static_cast<std::size_t>(row.spheres);
      auto ours_here = approximate(**mesh, spheres, sdk::HierarchyOptions::paper(), false);
      if (!ours_here) return tl::unexpected(ours_here.error());
      if (auto said = say(name, *ours_here); !said) return said;
      if (auto said = say_printed(name + ", printed", row.spheres, row.edges, row.triangles, row.sphere_mesh); !said)
        return said;
      auto qem = approximate_by_points(**mesh, spheres);
      if (!qem) return tl::unexpected(qem.error());
      if (auto said = say(name + ", QEM", *qem); !said) return said;
      if (auto said = say_printed(name + ", QEM, printed", row.spheres, 0, 0, row.qem); !said) return said;
    }
    return {};
  }

  /// Sphere-meshes fitted to their input, beside the best that is known.
  Expected<void> fit() {
    title("Fitted sphere-meshes: the elephant at 45, then six models at 50 and at 100 spheres");
    if (auto mesh = model("elephant_24955.off"); !mesh) {
      return tl::unexpected(mesh.error());
    } else if (*mesh) {
      for (const bool refine : {false, true}) {
        auto result = approximate(**mesh, 45, {}, refine);
        if (!result) return tl::unexpected(result.error());
        if (auto said = say(refine ? "elephant, refined" : "elephant, greedy", *result); !said) return said;
      }
    }
    for (const std::size_t spheres : {std::size_t{50}, std::size_t{100}}) {
      Eigen::Array3d logarithms = Eigen::Array3d::Zero();
      int models = 0;
      for (const std::string_view file : kFittedModels) {
        auto mesh = model(file);
        if (!mesh) return tl::unexpected(mesh.error());
        if (!*mesh) continue;
        auto result = approximate(**mesh, spheres, {}, true);
        if (!result) return tl::unexpected(result.error());
        if (auto said = say(std::string(file), *result); !said) return said;
        const sdk::ApproximationErrors& e = result->errors;
        logarithms += Eigen::Array3d(e.hausdorff, e.mean_input_to_approximation, e.mean_approximation_to_input).log();
        ++models;
      }
      if (models == 0) continue;
      const Eigen::Array3d mean = (logarithms / models).exp();
      const auto say_mean = [&](const std::string& name, const PublishedError& error) {
        return say_printed(name, static_cast<int>(spheres), 0, 0, error);
      };
      if (auto said = say_mean(fmt::format("geometric mean of {}", models), {mean[0], mean[1], mean[2]}); !said)
        return said;
      for (const PublishedFit& peer : kPublishedFits) {
        if (static_cast<std::size_t>(peer.spheres) != spheres) continue;
        if (auto said = say_mean(std::string(peer.peer) + ", as published", peer.mean); !said) return said;
      }
    }
    return {};
  }

  /// Figure 4.13.
  Expected<void> noise() {
    title("Noise (Figure 4.13): displacement in percent of the diagonal; errors against the clean model");
    const auto mesh = test_shape();
    if (!mesh) return tl::unexpected(mesh.error());
    for (const double percent : {0.0, 0.25, 0.5, 1.0, 2.0}) {
      auto result = approximate(with_noise(*mesh, percent, 1), 50, sdk::HierarchyOptions::paper(), false, &*mesh);
      if (!result) return tl::unexpected(result.error());
      if (auto said = say(fmt::format("{:.2f} % noise", percent), *result); !said) return said;
    }
    return {};
  }

  /// Figure 4.14.
  Expected<void> shell() {
    title("A thin shell (Figure 4.14), without and with links through the solid");
    const sdk::Mesh ball = hollow_ball(4, 0.9);
    for (const std::size_t spheres : {std::size_t{15}, std::size_t{50}, std::size_t{100}}) {
      for (const double enrichment : {0.0, 0.05}) {
        sdk::HierarchyOptions settings = sdk::HierarchyOptions::paper();
        settings.enrichment = enrichment;
        auto result = approximate(ball, spheres, settings, false);
        if (!result) return tl::unexpected(result.error());
        if (auto said = say(fmt::format("hollow ball, enrichment {:.2f}", enrichment), *result); !said) return said;
      }
    }
    return {};
  }

  /// "Half bear": a sphere-mesh closes what is open, which shows in M21.
  Expected<void> half() {
    title("Half a model (\"Half bear\" of Table 4.1): the opening is filled by spheres, and not by QEM");
    const auto mesh = test_shape();
    if (!mesh) return tl::unexpected(mesh.error());
    const sdk::Mesh open = half_of(*mesh);
    auto spheres = approximate(open, 60, sdk::HierarchyOptions::paper(), false);
    if (!spheres) return tl::unexpected(spheres.error());
    if (auto said = say("half, spheres", *spheres); !said) return said;
    auto points = approximate_by_points(open, 60);
    if (!points) return tl::unexpected(points.error());
    return say("half, QEM", *points);
  }

  /// Figure 4.15.
  Expected<void> few() {
    title("From many primitives to few (Figure 4.15): spheres against QEM's points");
    const auto mesh = test_shape();
    if (!mesh) return tl::unexpected(mesh.error());
    for (const std::size_t count : {2000, 1000, 500, 200, 100, 50, 25}) {
      auto spheres = approximate(*mesh, count, {}, false);
      if (!spheres) return tl::unexpected(spheres.error());
      if (auto said = say("spheres", *spheres); !said) return said;
      auto points = approximate_by_points(*mesh, count);
      if (!points) return tl::unexpected(points.error());
      if (auto said = say("QEM", *points); !said) return said;
    }
    return {};
  }

  /// What it costs to go from one level to the next.
  Expected<void> levels() {
    const sdk::Mesh mesh = subdivided(creature(5));
    title(fmt::format("From one level to the next, {} vertices", mesh.positions.size()));
    const auto built = ours(sdk::build_hierarchy(mesh, {}, call_.task()));
    if (!built) return tl::unexpected(built.error());
    sdk::LevelCursor cursor(built->hierarchy, built->hierarchy.leaf_count());
    std::vector<double> us;
    const auto timed = [&](bool (sdk::LevelCursor::*step)()) {
      for (bool went = true; went;) {
        const auto start = std::chrono::steady_clock::now();
        went = (cursor.*step)();
        us.push_back(1000 * milliseconds_since(start));
      }
    };
    timed(&sdk::LevelCursor::coarsen);
    timed(&sdk::LevelCursor::refine);
    std::ranges::sort(us);
    const auto at = [&](double share) {
      return us[static_cast<std::size_t>(share * static_cast<double>(us.size() - 1))];
    };
    if (options_.json) {
      return write_json_line(stdout, {{"section", section_},
                                      {"vertices", mesh.positions.size()},
                                      {"p50_us", number(at(0.5))},
                                      {"p99_us", number(at(0.99))},
                                      {"p99_9_us", number(at(0.999))}});
    }
    std::printf("%s\n", fmt::format("both ways through all levels: p50 {:.2f} us, p99 {:.2f} us, p99.9 {:.2f} us",
                                    at(0.5), at(0.99), at(0.999))
                            .c_str());
    return {};
  }

  /// Time and memory of the complete hierarchy, from some 10,000 triangles to more than a million.
  Expected<void> growth() {
    title("Growth: the complete hierarchy of one shape, ever finer");
    if (!options_.json) {
      std::printf("%12s%12s%12s%14s%16s\n", "triangles", "init ms", "collapse ms", "us/collapse", "KB a vertex");
    }
    for (const int rounds : {5, 6, 7, 8}) {
      const sdk::Mesh mesh = creature(rounds);
      const double before_mb = (reset_peak_memory(), peak_memory_mb());
      const auto built = ours(sdk::build_hierarchy(mesh, {}, call_.task()));
      if (!built) return tl::unexpected(built.error());
      const sdk::BuildStatistics& took = built->statistics;
      const double each_us = 1000 * took.decimate_ms / static_cast<double>(took.collapses);
      const double kb = 1024 * (peak_memory_mb() - before_mb) / static_cast<double>(mesh.positions.size());
      if (options_.json) {
        auto written = write_json_line(stdout, {{"section", section_},
                                                {"triangles", mesh.triangles.size()},
                                                {"init_ms", number(took.init_ms)},
                                                {"decimate_ms", number(took.decimate_ms)},
                                                {"us_per_collapse", number(each_us)},
                                                {"kb_per_vertex", number(kb)}});
        if (!written) return written;
      } else {
        std::printf("%12zu%12.1f%12.1f%14.2f%16.2f\n", mesh.triangles.size(), took.init_ms, took.decimate_ms, each_us,
                    kb);
      }
    }
    return {};
  }

  /// A model of the folder; nothing, and a word on stderr, where it is not at hand.
  Expected<std::optional<sdk::Mesh>> model(std::string_view file) {
    const std::filesystem::path path = std::filesystem::path(options_.models) / file;
    if (options_.models.empty() || !std::filesystem::exists(path)) {
      std::fprintf(stderr, "%s\n", fmt::format("bench: {} is not at hand (--models FOLDER): left out", file).c_str());
      return std::optional<sdk::Mesh>();
    }
    return ours(sdk::read_mesh(path, {}, call_.task())).map([](sdk::Mesh&& mesh) {
      return std::optional(std::move(mesh));
    });
  }

  /// The elephant where it is at hand, else a shape of ours.
  Expected<sdk::Mesh> test_shape() {
    auto elephant = model("elephant_24955.off");
    if (!elephant) return tl::unexpected(elephant.error());
    return *elephant ? std::move(**elephant) : creature(6);
  }

  Expected<Approximation> approximate(const sdk::Mesh& mesh, std::size_t spheres, sdk::HierarchyOptions settings,
                                      bool refine, const sdk::Mesh* measured_against = nullptr) {
    settings.stop_at = spheres;
    auto built = ours(sdk::build_hierarchy(mesh, settings, call_.task()));
    if (!built) return tl::unexpected(built.error());
    auto shape = ours(built->hierarchy.level(spheres));
    const auto start = std::chrono::steady_clock::now();
    if (shape && refine) shape = ours(sdk::refine(mesh, *shape, {}, call_.task()));
    if (!shape) return tl::unexpected(shape.error());
    const double refine_ms = refine ? milliseconds_since(start) : 0;
    auto errors = ours(sdk::measure(measured_against != nullptr ? *measured_against : mesh, *shape, {}, call_.task()));
    if (!errors) return tl::unexpected(errors.error());
    return Approximation{shape->spheres.size(), shape->edges.size(), shape->triangles.size(),
                         built->statistics,     refine_ms,           *errors};
  }

  /// The baseline: a mesh of so many points, by Garland and Heckbert's quadrics.
  Expected<Approximation> approximate_by_points(const sdk::Mesh& mesh, std::size_t points) {
    auto built = ours(sdk::decimate_mesh(mesh, {.vertices = points}, call_.task()));
    if (!built) return tl::unexpected(built.error());
    auto errors = ours(sdk::measure(mesh, built->mesh, {}, call_.task()));
    if (!errors) return tl::unexpected(errors.error());
    return Approximation{built->mesh.positions.size(), 0, built->mesh.triangles.size(), {}, 0, *errors};
  }

  void title(const std::string& text) const {
    if (!options_.json) std::printf("\n%s\n", text.c_str());
    headed_ = false;
  }

  Expected<void> say(const std::string& name, const Approximation& a) const {
    const sdk::ApproximationErrors& e = a.errors;
    if (options_.json) {
      return write_json_line(stdout, {{"section", section_},
                                      {"name", name},
                                      {"spheres", a.spheres},
                                      {"edges", a.edges},
                                      {"triangles", a.triangles},
                                      {"init_ms", number(a.took.init_ms)},
                                      {"decimate_ms", number(a.took.decimate_ms)},
                                      {"refine_ms", number(a.refine_ms)},
                                      {"hausdorff", number(e.hausdorff)},
                                      {"mean_input_to_approximation", number(e.mean_input_to_approximation)},
                                      {"mean_approximation_to_input", number(e.mean_approximation_to_input)}});
    }
    head();
    std::printf("%s\n", fmt::format("{:<30}{:>7}{:>6}{:>6}{:>9.3f}{:>8.3f}{:>8.3f}{:>9.0f}{:>9.0f}{:>9.0f}", name,
                                    a.spheres, a.edges, a.triangles, e.hausdorff, e.mean_input_to_approximation,
                                    e.mean_approximation_to_input, a.took.init_ms, a.took.decimate_ms, a.refine_ms)
                            .c_str());
    std::fflush(stdout);
    return {};
  }

  /// Numbers that somebody else measured, or means; counts of 0 are not known.
  Expected<void> say_printed(const std::string& name, int spheres, int edges, int triangles,
                             const PublishedError& e) const {
    if (options_.json) {
      return write_json_line(stdout, {{"section", section_},
                                      {"name", name},
                                      {"spheres", spheres},
                                      {"hausdorff", number(e.hausdorff)},
                                      {"mean_input_to_approximation", number(e.input_to_approximation)},
                                      {"mean_approximation_to_input", number(e.approximation_to_input)}});
    }
    head();
    const auto count = [](int value) { return value == 0 ? std::string() : std::to_string(value); };
    std::printf("%s\n", fmt::format("{:<30}{:>7}{:>6}{:>6}{:>9.3f}{:>8.3f}{:>8.3f}", name, spheres, count(edges),
                                    count(triangles), e.hausdorff, e.input_to_approximation, e.approximation_to_input)
                            .c_str());
    std::fflush(stdout);
    return {};
  }

  void head() const {
    if (headed_) return;
    headed_ = true;
    std::printf("%s\n", fmt::format("{:<30}{:>7}{:>6}{:>6}{:>9}{:>8}{:>8}{:>9}{:>9}{:>9}", "percent of the diagonal",
                                    "#S", "#E", "#T", "H", "M12", "M21", "init ms", "dec ms", "ref ms")
                            .c_str());
  }

  SphereMeshBenchOptions options_;
  SdkCall call_;
  std::string section_;
  mutable bool headed_ = false;
};

constexpr Sections<SphereMeshBench, 8> SphereMeshBench::kSections = {{{"table", &SphereMeshBench::table},
                                                                      {"fit", &SphereMeshBench::fit},
                                                                      {"noise", &SphereMeshBench::noise},
                                                                      {"shell", &SphereMeshBench::shell},
                                                                      {"half", &SphereMeshBench::half},
                                                                      {"few", &SphereMeshBench::few},
                                                                      {"levels", &SphereMeshBench::levels},
                                                                      {"growth", &SphereMeshBench::growth}}};

}  // namespace

void add_bench_spheremesh(CLI::App& bench, Run& run) {
  auto options = std::make_shared<SphereMeshBenchOptions>();
  CLI::App* command = bench.add_subcommand(
      "spheremesh",
      "How near sphere-meshes come, beside what is published: Table 4.1 and the experiments of section "
      "4.8 of the thesis, fitted sphere-meshes, and how time and memory grow.");
  command->add_option("--models", options->models, "folder with the models, under their published names")
      ->type_name("FOLDER");
  command->add_option("--only", options->only, "some of the experiments")
      ->delimiter(',')
      ->check(CLI::IsMember(SphereMeshBench::sections()));
  command->add_flag("--json", options->json, "one JSON object a row");
  command->footer(
      "Without models, shapes of our own stand in where they can. H is the two-sided Hausdorff distance, M12 the mean\n"
      "distance from the input to the approximation, M21 the one back.\n\n"
      "Example:\n  armature bench spheremesh --models meshes --only table,fit");
  command->callback([options, &run] { run = [options] { return SphereMeshBench(*options).run(); }; });
}

}  // namespace armature::tools
