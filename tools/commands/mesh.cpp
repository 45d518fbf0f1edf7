#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <armature/sdk/distance/measure.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <armature/sdk/mesh/report.h>
#include <fmt/format.h>

#include "tools/commands/commands.h"
#include "tools/commands/output_names.h"
#include "tools/evaluation/shapes.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string file;
  bool json = false;
};

Json to_json(const sdk::MeshReport& report) {
  Json json;
  json["vertices"] = report.vertices;
  json["faces"] = report.faces;
  json["components"] = report.components;
  json["boundary_loops"] = report.boundary_loops;
  json["nonmanifold_edges"] = report.nonmanifold_edges;
  json["degenerate_faces"] = report.degenerate_faces;
  json["closed"] = report.closed;
  json["oriented"] = report.oriented;
  json["genus"] = report.genus ? Json(*report.genus) : Json(nullptr);
  json["bbox_diagonal"] = report.bbox_diagonal;
  json["edges"] = report.edges;
  json["boundary_edges"] = report.boundary_edges;
  json["nonmanifold_vertices"] = report.nonmanifold_vertices;
  json["duplicate_faces"] = report.duplicate_faces;
  json["unused_vertices"] = report.unused_vertices;
  json["inward_faces"] = report.inward_faces;
  json["area"] = report.area;
  json["volume"] = report.volume;
  return json;
}

/// What is unusual about the mesh, and what follows from it; a line each.
std::vector<std::string> remarks(const sdk::MeshReport& report) {
  std::vector<std::string> lines;
  const auto remark = [&](std::size_t count, const char* one, const char* many, const char* consequence) {
    if (count > 0) lines.push_back(fmt::format("{} {}: {}", count, count == 1 ? one : many, consequence));
  };
  remark(report.boundary_loops, "hole", "holes", "the surface is open, so it encloses no definite volume");
  remark(report.nonmanifold_edges, "edge of three or more faces", "edges of three or more faces",
         "there the surface branches and has no genus");
  remark(report.nonmanifold_vertices, "pinched vertex", "pinched vertices",
         "there the surface touches itself and has no genus");
  remark(report.degenerate_faces, "face without area", "faces without area", "they have no normal and weigh nothing");
  remark(report.duplicate_faces, "face that is there already", "faces that are there already",
         "their area counts more than once");
  remark(report.unused_vertices, "vertex on no face", "vertices on no face", "they count in the bounding box alone");
  if (!report.oriented) lines.emplace_back("faces disagree on what is outside: some are turned over");
  if (report.inward_faces == report.faces)
    lines.emplace_back("inside out: all faces point inward");
  else
    remark(report.inward_faces, "face points inward", "faces point inward",
           "normals must point outward for spheres to fit");
  return lines;
}

void print(const std::string& file, const sdk::MeshReport& report) {
  const auto row = [](const char* name, const std::string& value) { fmt::print("  {:<20}{}\n", name, value); };
  const auto yes = [](bool value) { return std::string(value ? "yes" : "no"); };
  fmt::print("{}\n", file);
  row("vertices", std::to_string(report.vertices));
  row("edges", std::to_string(report.edges));
  row("faces", std::to_string(report.faces));
  row("components", std::to_string(report.components));
  row("closed", yes(report.closed));
  row("oriented", yes(report.oriented));
  row("genus", report.genus ? std::to_string(*report.genus) : "none: not a two-sided manifold");
  row("bounding box", fmt::format("{:.6g} across", report.bbox_diagonal));
  row("area", fmt::format("{:.6g}", report.area));
  if (report.closed && report.oriented) row("volume", fmt::format("{:.6g}", report.volume));
  for (const std::string& line : remarks(report)) fmt::print("  ! {}\n", line);
}

Expected<void> info(const Arguments& arguments) {
  SdkCall call;
  const auto mesh = ours(sdk::read_mesh(arguments.file, {}, call.task()));
  if (!mesh) return tl::unexpected(mesh.error());
  const auto report = ours(sdk::analyse(*mesh, call.task()));
  if (!report) return tl::unexpected(report.error());
  if (arguments.json) return write_json_line(stdout, to_json(*report));
  print(std::filesystem::path(arguments.file).filename().string(), *report);
  return {};
}

struct SampleArguments {
  std::string shape, out;
  int rounds = 6;
};

Expected<void> sample(const SampleArguments& arguments) {
  const auto shape = [&] {
    if (arguments.shape == "ball") return icosphere(arguments.rounds);
    if (arguments.shape == "hollow-ball") return hollow_ball(arguments.rounds, 0.9);
    return creature(arguments.rounds);
  };
  return ours(sdk::write_mesh(shape(), arguments.out));
}

struct PointsArguments {
  std::string mesh, out;
  std::optional<std::size_t> count;
};

Expected<void> points(const PointsArguments& arguments) {
  SdkCall call;
  const auto mesh = ours(sdk::read_mesh(arguments.mesh, {}, call.task()));
  if (!mesh) return tl::unexpected(mesh.error());
  if (!(sdk::surface_area(*mesh) > 0)) return fail(arguments.mesh + ": has no area to take points of");
  return ours(sdk::write_points(sdk::sample_points(*mesh, arguments.count.value_or(mesh->positions.size())),
                                arguments.out, {}, call.task()));
}

}  // namespace

void add_mesh(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("mesh", "Triangle meshes");
  command->require_subcommand(1);
  auto arguments = std::make_shared<Arguments>();
  CLI::App* shown = command->add_subcommand("info", "Tell what a mesh is like and what is wrong with it");
  shown->add_option("FILE", arguments->file, "OFF, OBJ, PLY, STL, or what assimp reads")->required();
  shown->add_flag("--json", arguments->json, "Print the result as one line of JSON");
  shown->footer(
      "Polygons count as the triangles they are cut into. Components hang together by vertices. The genus is that of "
      "a\n"
      "two-sided manifold with its holes closed, summed over the components; null in JSON for anything else.\n\n"
      "Example:\n"
      "  armature mesh info elephant.off --json");
  shown->callback([arguments, &run] { run = [arguments] { return info(*arguments); }; });

  auto samples = std::make_shared<SampleArguments>();
  CLI::App* sampled = command->add_subcommand("sample", "Write a shape to try things on");
  sampled->add_option("SHAPE", samples->shape, "creature, ball or hollow-ball")
      ->required()
      ->check(CLI::IsMember({"creature", "ball", "hollow-ball"}));
  sampled->add_option("OUT", samples->out, "the mesh: .off, .obj or .ply")->required();
  sampled->add_option("--rounds", samples->rounds, "times that every face is cut into four")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  sampled->footer("Example:\n  armature mesh sample creature creature.off");
  sampled->callback([samples, &run] { run = [samples] { return sample(*samples); }; });

  auto taken = std::make_shared<PointsArguments>();
  CLI::App* of_mesh = command->add_subcommand("points", "Take points with normals from a mesh, evenly by area");
  of_mesh->add_option("MESH", taken->mesh, "a triangle mesh")->required();
  of_mesh->add_option("OUT", taken->out, "the points: .ply, .obj or .xyz")->required()->check(wrong_points_name);
  of_mesh->add_option("--count", taken->count, "how many, about (default: as many as there are vertices)")
      ->check(CLI::Range(1, 100'000'000));
  of_mesh->footer("Example:\n  armature mesh points cow.obj cow.xyz --count 10000");
  of_mesh->callback([taken, &run] { run = [taken] { return points(*taken); }; });
}

}  // namespace armature::tools
