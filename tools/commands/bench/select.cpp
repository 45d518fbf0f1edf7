#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/selection/patch_brush.h>
#include <fmt/format.h>

#include "tools/commands/bench/bench.h"
#include "tools/commands/bench/sections.h"
#include "tools/commands/choices.h"
#include "tools/elapsed.h"
#include "tools/evaluation/part_times.h"
#include "tools/evaluation/planted.h"
#include "tools/evaluation/published.h"
#include "tools/evaluation/selection_quality.h"
#include "tools/evaluation/selection_tasks.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct SelectBenchOptions {
  std::string models;
  std::vector<std::string> only;
  int seeds = 3;
  int rounds = 3;
  bool json = false;
};

/// How long the steps of selecting a patch and its likes take, in milliseconds.
struct PatchTimes {
  double load_ms = std::numeric_limits<double>::infinity();
  double select_ms = load_ms, map_ms = load_ms, learn_ms = load_ms, match_ms = load_ms;
  double match_processor_ms = std::numeric_limits<double>::infinity();  // on all cores together
};

/// The experiments of chapter 5, one method each.
class SelectBench {
 public:
  explicit SelectBench(SelectBenchOptions options) : options_(std::move(options)) {}

  Expected<void> run() { return run_sections(*this, kSections, options_.only, call_, section_); }

  [[nodiscard]] static std::vector<std::string> sections() { return names_of(kSections); }

 private:
  static const Sections<SelectBench, 6> kSections;

  /// What is found of what was planted.
  Expected<void> quality() {
    title("Planted copies: of the first k, k being how many there are; goals 0.95, 0.95, 0.95 (noise: 0.90), 0.01");
    auto cases = ours(planted_cases(call_.task()));
    if (!cases) return tl::unexpected(cases.error());
    if (!options_.models.empty()) {
      auto more = ours(model_cases(options_.models, call_.task()));
      if (!more) return tl::unexpected(more.error());
      std::ranges::move(*more, std::back_inserter(*cases));
    }
    for (const QualityCase& one : *cases) {
      const auto mean = ours(mean_quality(one, options_.seeds, call_.task()));
      if (!mean) return tl::unexpected(mean.error());
      if (auto said = say_quality(one.name, *mean); !said) return said;
    }
    return {};
  }

  /// What the thesis's participants did (annex B.2).
  Expected<void> tasks() {
    title("Annex B.2: tasks on stand-in models; of the first k, k being how many others there are");
    const auto tasks = ours(selection_tasks(call_.task()));
    if (!tasks) return tl::unexpected(tasks.error());
    for (const SelectionTask& task : *tasks)
      if (auto said = say_quality(task.name, quality_of(task.scene, task.expansion)); !said) return said;
    return {};
  }

  Expected<void> say_quality(const std::string& name, const PlantedQuality& quality) const {
    if (options_.json)
      return write_json_line(stdout, {{"section", section_},
                                      {"name", name},
                                      {"precision", number(quality.precision)},
                                      {"recall", number(quality.recall)},
                                      {"overlap", number(quality.overlap)},
                                      {"flipped", number(quality.flipped)}});
    fmt::print("{:<60} precision {:.3f}  recall {:.3f}  overlap {:.3f}  flipped {:.3f}\n", name, quality.precision,
               quality.recall, quality.overlap, quality.flipped);
    std::fflush(stdout);
    return {};
  }

  /// Models of many components, and copies of a blob among other things, from 10 to 700 thousand triangles.
  Expected<void> components() {
    title(
        "Components: milliseconds; load: adjacency and what they are compared by; expand: a click; goals 100 and 0.1");
    for (const char* file : {"as_2CylinderEngine.obj", "qmvc_Bench.obj"}) {
      const std::filesystem::path path = std::filesystem::path(options_.models) / file;
      if (options_.models.empty() || !std::filesystem::exists(path)) continue;
      const auto mesh = ours(sdk::read_mesh(path, {}, call_.task()));
      if (!mesh) return tl::unexpected(mesh.error());
      if (auto said = time_components(file, *mesh); !said) return said;
    }
    for (int rounds = 2; rounds <= 5; ++rounds)
      if (auto said = time_components("planted", planted_components({}, rounds).mesh); !said) return said;
    return {};
  }

  /// The fastest of some rounds; a click on every component, or on 100 of them, in the median.
  Expected<void> time_components(const std::string& name, const sdk::Mesh& mesh) {
    constexpr std::size_t kClicks = 100;
    double load_ms = std::numeric_limits<double>::infinity();
    double expand_ms = load_ms;
    std::size_t count = 0;
    for (int round = 0; round < options_.rounds; ++round) {
      const auto start = std::chrono::steady_clock::now();
      const sdk::Adjacency adjacency(mesh);
      const auto index = ours(sdk::ComponentIndex::build(mesh, adjacency, call_.task()));
      if (!index) return tl::unexpected(index.error());
      load_ms = std::min(load_ms, milliseconds_since(start));
      count = index->size();
      std::vector<double> clicks;
      for (std::size_t c = 0; c < count; c += 1 + count / kClicks) {
        const sdk::FaceId face = index->faces(c).front();
        const auto clicked = std::chrono::steady_clock::now();
        const auto expansion = ours(index->expand(face));
        clicks.push_back(milliseconds_since(clicked));
        if (!expansion) return tl::unexpected(expansion.error());
      }
      const auto middle = clicks.begin() + static_cast<std::ptrdiff_t>(clicks.size() / 2);
      std::ranges::nth_element(clicks, middle);
      expand_ms = std::min(expand_ms, *middle);
    }
    if (options_.json)
      return write_json_line(stdout, {{"section", section_},
                                      {"name", name},
                                      {"triangles", mesh.triangles.size()},
                                      {"components", count},
                                      {"load_ms", number(load_ms)},
                                      {"expand_ms", number(expand_ms)}});
    fmt::print("{:<36} {:>8} triangles  {:>5} components  load {:7.1f}  expand {:7.3f}\n", name, mesh.triangles.size(),
               count, load_ms, expand_ms);
    std::fflush(stdout);
    return {};
  }

  /// Table 5.2, beside what is printed there for the same size.
  Expected<void> table() {
    title(
        "Table 5.2: patches. Milliseconds; SVMt: asking about the reference once; ICP - SVMp: a match, on all cores "
        "and "
        "of processor time");
    for (const PublishedPatchRow& printed : kTable52) {
      const std::filesystem::path path = std::filesystem::path(options_.models) / printed.file;
      if (options_.models.empty() || !std::filesystem::exists(path)) continue;
      const auto mesh = ours(sdk::read_mesh(path, {}, call_.task()));
      if (!mesh) return tl::unexpected(mesh.error());
      const auto times = measured(*mesh, printed.r);
      if (!times) return tl::unexpected(times.error());
      const std::string name = fmt::format("{} ({:.0f}k)", printed.model, printed.thousand_vertices);
      const PatchTimes said_there{0, printed.select_ms, printed.map_ms, printed.training_ms, printed.match_ms};
      if (auto said = say(name + ", printed", printed.r, said_there); !said) return said;
      const std::string here =
          fmt::format("{} ({:.0f}k)", path.filename().string(), static_cast<double>(mesh->positions.size()) / 1000);
      if (auto said = say(here, printed.r, *times); !said) return said;
    }
    return {};
  }

  /// Table 5.1, beside what is printed there for the same size; then a ball with 47 horns, as many as its dragon has
  /// strokes (12 on the coarsest), from 5 thousand to 1.3 million triangles.
  Expected<void> parts() {
    title(
        "Table 5.1: parts. Milliseconds; PT: precomputation, ST: a step of the stroke, PS: strokes, ET: expansion; "
        "usable: from the mesh to the part of a first point");
    for (const PublishedPartRow& printed : kTable51) {
      const std::filesystem::path path = std::filesystem::path(options_.models) / printed.file;
      if (options_.models.empty() || !std::filesystem::exists(path)) continue;
      const auto mesh = ours(sdk::read_mesh(path, {}, call_.task()));
      if (!mesh) return tl::unexpected(mesh.error());
      const std::string name = fmt::format("{} ({:.0f}k), printed", printed.model, printed.thousand_vertices);
      const PartTimes said_there{.precompute_ms = printed.precompute_ms,
                                 .step_ms = printed.step_ms,
                                 .strokes = static_cast<std::size_t>(printed.strokes),
                                 .expand_ms = printed.expand_ms};
      if (auto said = say_parts(name, said_there); !said) return said;
      const PartTip tip{.at = Eigen::Vector3d(printed.tip.data()), .below = printed.below};
      if (auto said = time_parts(path.filename().string(), *mesh, tip); !said) return said;
    }
    for (int rounds = 4; rounds <= 8; ++rounds) {
      const int horns = rounds == 4 ? 12 : 47;  // more would melt into one another
      if (auto said = time_parts(fmt::format("{} horns", horns), horned_ball(rounds, horns), {}); !said) return said;
    }
    return {};
  }

  Expected<void> time_parts(const std::string& name, const sdk::Mesh& mesh, const PartTip& tip) {
    const auto times = part_times(mesh, tip, options_.rounds, call_.task());
    if (!times && call_.interrupted()) return fail("stopped on request");
    if (!times) {
      // Where the stroke that is made up for a model cuts nothing off.
      if (!options_.json) fmt::print("{:<36} {}\n", name, times.error().message);
      return {};
    }
    return say_parts(fmt::format("{} ({:.0f}k)", name, static_cast<double>(mesh.positions.size()) / 1000), *times);
  }

  Expected<void> say_parts(const std::string& name, const PartTimes& times) const {
    const bool measured_here = times.usable_ms > 0;
    if (options_.json) {
      Json line = {{"section", section_},
                   {"name", name},
                   {"load_ms", number(times.load_ms)},
                   {"precompute_ms", number(times.precompute_ms)},
                   {"step_ms", number(times.step_ms)},
                   {"strokes", times.strokes},
                   {"expand_ms", number(times.expand_ms)}};
      if (measured_here) line["usable_ms"] = number(times.usable_ms);
      return write_json_line(stdout, line);
    }
    fmt::print("{:<36} load {:7.1f}  PT {:8.1f}  ST {:6.1f}  PS {:3}  ET {:8.1f}", name, times.load_ms,
               times.precompute_ms, times.step_ms, times.strokes, times.expand_ms);
    if (measured_here) fmt::print("  (usable after {:8.1f})", times.usable_ms);
    fmt::print("\n");
    std::fflush(stdout);
    return {};
  }

  /// From five thousand to a million triangles.
  Expected<void> sizes() {
    title("Patches on a ball with reliefs, r = 0.06, from 5 thousand to 1.3 million triangles; milliseconds");
    for (int rounds = 4; rounds <= 8; ++rounds) {
      const sdk::Mesh mesh = planted_reliefs({}, rounds).mesh;
      const auto times = measured(mesh, 0.06);
      if (!times) return tl::unexpected(times.error());
      if (auto said = say(fmt::format("{} triangles", mesh.triangles.size()), 0.06, *times); !said) return said;
    }
    return {};
  }

  /// The fastest of some rounds, since others use the machine too.
  Expected<PatchTimes> measured(const sdk::Mesh& mesh, double r) {
    PatchTimes best;
    const auto keep = [](double& least, double ms) { least = std::min(least, ms); };
    for (int round = 0; round < options_.rounds; ++round) {
      const auto start = std::chrono::steady_clock::now();
      const sdk::Surface surface(mesh);
      keep(best.load_ms, milliseconds_since(start));
      const sdk::VertexId centre = farthest_vertex(mesh);
      // A brush of a third of the patch's radius, so that its floods reach as far as the patch.
      sdk::PatchBrush brush(surface, r * surface.diagonal / 3);
      const auto drawn = std::chrono::steady_clock::now();
      brush.draw_to(surface.tree.closest(mesh.position(centre)));
      const auto brushed = brush.faces();
      keep(best.select_ms, milliseconds_since(drawn));
      sdk::PatchExpansionTimes times;
      const auto region = region_about(mesh, centre, r * surface.diagonal);
      const auto expansion = ours(sdk::expand_patch(surface, region, {}, call_.task(), &times));
      if (!expansion) return tl::unexpected(expansion.error());
      keep(best.map_ms, times.map_ms);
      keep(best.learn_ms, times.learn_ms);
      if (times.candidates == 0) continue;
      keep(best.match_ms, times.matches_ms / static_cast<double>(times.candidates));
      keep(best.match_processor_ms, times.matches_processor_ms / static_cast<double>(times.candidates));
    }
    return best;
  }

  void title(const std::string& text) const {
    if (!options_.json) fmt::print("\n{}\n", text);
  }

  Expected<void> say(const std::string& name, double r, const PatchTimes& times) const {
    const bool measured_here = std::isfinite(times.match_processor_ms);
    if (options_.json) {
      Json line = {{"section", section_},
                   {"name", name},
                   {"r", number(r)},
                   {"load_ms", number(times.load_ms)},
                   {"select_ms", number(times.select_ms)},
                   {"map_ms", number(times.map_ms)},
                   {"learn_ms", number(times.learn_ms)},
                   {"match_ms", number(times.match_ms)}};
      if (measured_here) line["match_processor_ms"] = number(times.match_processor_ms);
      return write_json_line(stdout, line);
    }
    fmt::print("{:<36} r {:.2f}  load {:7.1f}  select {:6.1f}  map {:8.1f}  SVMt {:7.1f}  ICP - SVMp {:6.1f}", name, r,
               times.load_ms, times.select_ms, times.map_ms, times.learn_ms, times.match_ms);
    if (measured_here) fmt::print("  (processor {:5.1f})", times.match_processor_ms);
    fmt::print("\n");
    std::fflush(stdout);
    return {};
  }

  SelectBenchOptions options_;
  SdkCall call_;
  std::string section_;
};

const Sections<SelectBench, 6> SelectBench::kSections = {{{"quality", &SelectBench::quality},
                                                          {"tasks", &SelectBench::tasks},
                                                          {"components", &SelectBench::components},
                                                          {"parts", &SelectBench::parts},
                                                          {"table", &SelectBench::table},
                                                          {"sizes", &SelectBench::sizes}}};

}  // namespace

void add_bench_select(CLI::App& bench, Run& run) {
  auto options = std::make_shared<SelectBenchOptions>();
  CLI::App* select = bench.add_subcommand("select", "Selecting regions and their likes: what is found, and how fast.");
  select
      ->add_option("--models", options->models, "folder of models for tables and quality; without it they are left out")
      ->check(CLI::ExistingDirectory);
  select->add_option("--only", options->only, "some of the experiments")
      ->delimiter(',')
      ->check(CLI::IsMember(SelectBench::sections()));
  select->add_option("--seeds", options->seeds, "scenes of each kind that quality is the mean of")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  select->add_option("--rounds", options->rounds, "times that each step is timed; the fastest counts")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  select->add_flag("--json", options->json, "one JSON object a row");
  select->footer(
      "Quality is measured on meshes of our own, from fixed seeds. The table prints the thesis's row above ours, on a\n"
      "model of about the same size.\n\n"
      "Examples:\n"
      "  armature bench select --only quality\n"
      "  armature bench select --models meshes --only table");
  select->callback([options, &run] { run = [options] { return SelectBench(*options).run(); }; });
}

}  // namespace armature::tools
