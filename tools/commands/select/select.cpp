#include "tools/commands/select/select.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <armature/sdk/selection/boundary.h>
#include <armature/sdk/selection/part_cut.h>
#include <armature/sdk/selection/patch_brush.h>
#include <fmt/format.h>

#include "tools/commands/select/gesture.h"
#include "tools/commands/select/paint.h"
#include "tools/elapsed.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string mesh, gesture, from, ply;
  std::size_t expand = 0;
  bool any_size = false;
  bool json = false;
};

/// What came of a gesture, and how long it took by step, in milliseconds.
struct Outcome {
  sdk::Expansion expansion;
  Json timings_ms;
};

/// The sizes that --any-size looks for, a third of an octave apart.
constexpr std::array<double, 7> kAnySize = {0.5, 0.63, 0.794, 1, 1.26, 1.587, 2};

/// Does what each gesture asks for.
struct Select {
  const Arguments& arguments;
  const sdk::Mesh& mesh;
  const sdk::Mesh& drawn_on;  // the same, or that of --from
  const sdk::Task& task;

  sdk::Expected<Outcome> operator()(const ComponentGesture& gesture) const {
    const auto start = std::chrono::steady_clock::now();
    const auto index_of = [&](const sdk::Mesh& of) { return sdk::ComponentIndex::build(of, sdk::Adjacency(of), task); };
    const auto index = index_of(mesh);
    if (!index) return tl::unexpected(index.error());
    std::optional<sdk::ComponentIndex> other;
    if (&drawn_on != &mesh) {
      auto built = index_of(drawn_on);
      if (!built) return tl::unexpected(built.error());
      other = std::move(*built);
    }
    const double load_ms = milliseconds_since(start);
    const auto clicked = std::chrono::steady_clock::now();
    auto expansion = other ? index->expand(*other, gesture.face) : index->expand(gesture.face);
    if (!expansion) return tl::unexpected(expansion.error());
    return Outcome{std::move(*expansion), {{"load", number(load_ms)}, {"expand", number(milliseconds_since(clicked))}}};
  }

  sdk::Expected<Outcome> operator()(const PatchGesture& gesture) const { return patch(gesture); }
  sdk::Expected<Outcome> operator()(const LassoGesture& gesture) const { return patch(gesture); }

  static sdk::Expected<std::vector<sdk::FaceId>> select_in(const sdk::Surface& surface, const PatchGesture& gesture) {
    return sdk::select_patch(surface, gesture.drawn);
  }
  static sdk::Expected<std::vector<sdk::FaceId>> select_in(const sdk::Surface& surface, const LassoGesture& gesture) {
    auto faces = sdk::select_lasso(surface, gesture.drawn);
    if (!faces || !(gesture.snap > 0)) return faces;
    return sdk::snap_boundary(surface, *faces, gesture.snap);
  }

  /// A region of the surface, however it is selected, and its likes.
  template <class Drawn>
  sdk::Expected<Outcome> patch(const Drawn& gesture) const {
    const auto start = std::chrono::steady_clock::now();
    const sdk::Surface surface(mesh);
    std::optional<sdk::Surface> other;
    if (&drawn_on != &mesh) other.emplace(drawn_on);
    const sdk::Surface& of_patch = other ? *other : surface;
    const double load_ms = milliseconds_since(start);
    const auto began = std::chrono::steady_clock::now();
    auto patch = select_in(of_patch, gesture);
    if (!patch) return tl::unexpected(patch.error());
    Json timings = {{"load", number(load_ms)}, {"select", number(milliseconds_since(began))}};
    if (arguments.expand == 0) return Outcome{sdk::Expansion(std::move(*patch), {}, {}), std::move(timings)};
    sdk::PatchExpansionOptions options{.most = std::max<std::size_t>(64, 2 * arguments.expand)};
    if (arguments.any_size) options.scales = {kAnySize.begin(), kAnySize.end()};
    sdk::PatchExpansionTimes times;
    auto expansion = sdk::expand_patch(surface, of_patch, *patch, options, task, &times);
    if (!expansion) return tl::unexpected(expansion.error());
    timings["map"] = number(times.map_ms);
    timings["learn"] = number(times.learn_ms);
    timings["match"] = number(times.candidates > 0 ? times.matches_ms / static_cast<double>(times.candidates) : 0);
    return Outcome{std::move(*expansion), std::move(timings)};
  }

  sdk::Expected<Outcome> operator()(const PartGesture& gesture) const {
    const auto start = std::chrono::steady_clock::now();
    const sdk::Surface surface(drawn_on);
    const auto model = sdk::PartModel::build(surface, task);
    if (!model) return tl::unexpected(model.error());
    std::optional<sdk::Surface> there;  // of `mesh`, where the likes are looked for elsewhere
    std::optional<sdk::PartModel> likes;
    if (&drawn_on != &mesh && arguments.expand > 0) {
      there.emplace(mesh);
      auto built = sdk::PartModel::build(*there, task);
      if (!built) return tl::unexpected(built.error());
      likes.emplace(std::move(*built));
    }
    sdk::PartCut cut(*model);
    const double load_ms = milliseconds_since(start);
    const auto drawn = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < gesture.strokes.size(); ++i) {
      const auto points = sdk::project_stroke(surface, gesture.strokes[i], "stroke " + std::to_string(i));
      if (!points) return tl::unexpected(points.error());
      cut.begin_stroke();
      for (const sdk::SurfacePoint& point : *points) cut.add_point(point);
    }
    auto part = cut.faces();
    if (!part) return tl::unexpected(part.error());
    Json timings = {{"load", number(load_ms)}, {"select", number(milliseconds_since(drawn))}};
    if (arguments.expand == 0) return Outcome{sdk::Expansion(std::move(*part), {}, {}), std::move(timings)};
    const auto began = std::chrono::steady_clock::now();
    auto expansion = sdk::expand_part(likes ? *likes : *model, *model, *part, {}, task);
    if (!expansion) return tl::unexpected(expansion.error());
    timings["expand"] = number(milliseconds_since(began));
    return Outcome{std::move(*expansion), std::move(timings)};
  }
};

Json to_json(std::span<const sdk::FaceId> faces) {
  Json json = Json::array();
  for (const sdk::FaceId face : faces) json.push_back(face.index());
  return json;
}

Json to_json(const sdk::Match& match) {
  Json transform = Json::array();
  for (Eigen::Index row = 0; row < 4; ++row)
    for (Eigen::Index column = 0; column < 4; ++column) transform.push_back(match.reference_from_match(row, column));
  return {{"faces", to_json(match.faces)},
          {"score", number(match.score)},
          {"transform", std::move(transform)},
          {"mirrored", match.mirrored},
          {"reason", match.reason}};
}

Json to_json(const Outcome& outcome, std::span<const sdk::Match> matches) {
  Json json = {{"reference", {{"faces", to_json(outcome.expansion.reference())}}},
               {"matches", Json::array()},
               {"rejected", Json::array()},
               {"timings_ms", outcome.timings_ms}};
  for (const sdk::Match& match : matches) json["matches"].push_back(to_json(match));
  for (const sdk::Rejected& rejected : outcome.expansion.rejected())
    json["rejected"].push_back({{"face", rejected.face.index()}, {"reason", rejected.reason}});
  return json;
}

void print(const Outcome& outcome, std::span<const sdk::Match> matches) {
  fmt::print("selected {} faces; {} regions compared\n", outcome.expansion.reference().size(),
             outcome.expansion.size());
  std::size_t place = 0;
  for (const sdk::Match& match : matches)
    fmt::print("{:4}  {:.3f}  {:6} faces from {:<8} {}\n", ++place, match.score, match.faces.size(),
               match.faces.empty() ? 0 : match.faces.front().index(), match.reason);
}

Expected<void> run_select(const Arguments& arguments) {
  SdkCall call;
  const auto mesh = ours(sdk::read_mesh(arguments.mesh, {}, call.task()));
  if (!mesh) return tl::unexpected(mesh.error());
  std::optional<sdk::Mesh> other;
  if (!arguments.from.empty()) {
    auto read = ours(sdk::read_mesh(arguments.from, {}, call.task()));
    if (!read) return tl::unexpected(read.error());
    other = std::move(*read);
  }
  const sdk::Mesh& drawn_on = other ? *other : *mesh;
  const auto gesture = read_gesture(arguments.gesture, drawn_on.triangles.size());
  if (!gesture) return tl::unexpected(gesture.error());
  const auto outcome = std::visit(Select{arguments, *mesh, drawn_on, call.task()}, *gesture);
  if (!outcome) return fail(arguments.gesture + ": " + outcome.error().message);
  const auto matches = outcome->expansion.first(arguments.expand);
  if (!arguments.ply.empty()) {
    const std::vector<sdk::FaceId> elsewhere;
    const sdk::Mesh picture = painted(*mesh, other ? elsewhere : outcome->expansion.reference(), matches);
    if (auto written = ours(sdk::write_mesh(picture, arguments.ply, {.format = sdk::MeshFormat::Ply})); !written)
      return written;
  }
  if (arguments.json) return write_json_line(stdout, to_json(*outcome, matches));
  print(*outcome, matches);
  return {};
}

}  // namespace

void add_select(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("select", "Select a region of a mesh, and all that are like it");
  command->add_option("MESH", arguments->mesh, "a triangle mesh: OFF, OBJ, PLY, STL, or what assimp reads")->required();
  command->add_option("--gesture", arguments->gesture, "what is clicked or drawn, as JSON (below)")
      ->required()
      ->type_name("G.json");
  command->add_option("--expand", arguments->expand, "how many regions like it to find, best first")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str()
      ->type_name("K");
  command->add_flag("--any-size", arguments->any_size, "patches also from half to twice the size");
  command->add_option("--from", arguments->from, "the gesture is drawn on this mesh; its likes are looked for in MESH")
      ->type_name("MESH2");
  command
      ->add_option("--ply", arguments->ply, "write the mesh coloured: selection red, matches blue, paler if less alike")
      ->type_name("OUT.ply");
  command->add_flag("--json", arguments->json, "print the result as one line of JSON");
  command->footer(
      "Gestures (lengths in the model's units; faces count from 0, after polygons are cut into triangles):\n"
      "  {\"tool\":\"component\",\"face\":F}\n"
      "      the connected component of face F\n"
      "  {\"tool\":\"part\",\"stroke\":[[x,y,z],...]}\n"
      "      what a stroke along the cut cuts off, on the side that protrudes; or a list of strokes along one cut\n"
      "  {\"tool\":\"patch\",\"strokes\":[[[x,y,z],...],...],\"radius\":R,\"background\":[[[x,y,z],...],...]}\n"
      "      what a brush of radius R goes over, and on to where the surface bends; never over the background "
      "strokes,\n"
      "      which may be left out. Points are moved to the surface, at most 5 % of the bounding box's diagonal.\n"
      "  {\"tool\":\"lasso\",\"loop\":[[x,y,z],...],\"eye\":[x,y,z],\"through\":false,\"snap\":W}\n"
      "      what is seen inside the loop from the eye, or along a \"direction\":[x,y,z] given instead; also what is\n"
      "      hidden if \"through\" is true. With \"snap\" the boundary runs where the surface is best cut within W.\n"
      "      Its likes are those of a patch.\n\n"
      "Result: "
      "{\"reference\":{\"faces\":[...]},\"matches\":[{\"faces\":[...],\"score\":S,\"transform\":[16],...}],...}\n"
      "without the reference among the matches; S is 1 for the same shape. The transform is a 4 x 4 matrix, row by\n"
      "row, that maps the match onto the reference. With --from the reference's faces are those of MESH2, all others\n"
      "those of MESH; parts are found where they are a third to three times as large.\n\n"
      "Examples:\n"
      "  echo '{\"tool\":\"component\",\"face\":0}' > click.json\n"
      "  armature select engine.obj --gesture click.json --expand 8 --ply like.ply\n"
      "  armature render like.ply like.png");
  command->callback([arguments, &run] { run = [arguments] { return run_select(*arguments); }; });
}

}  // namespace armature::tools
