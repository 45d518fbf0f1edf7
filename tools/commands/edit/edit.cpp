#include "tools/commands/edit/edit.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/descriptors/descriptors.h>
#include <armature/sdk/editing/region_edits.h>
#include <armature/sdk/editing/vertex_edits.h>
#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/expand_part.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/io/mesh_format.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <armature/sdk/mesh/components.h>
#include <armature/sdk/selection/part_cut.h>
#include <armature/sdk/selection/patch_brush.h>
#include <fmt/format.h>

#include "tools/commands/choices.h"
#include "tools/commands/output_names.h"
#include "tools/commands/select/gesture.h"
#include "tools/elapsed.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

constexpr sdk::Colour kPaint = {24, 84, 214};

struct Arguments {
  std::string mesh, out, gesture;
  std::string map = "gls";
  std::string op;
  double amount = 0;
  double share = 0.05, from = 0.1, to = 0.9;
  std::size_t expand = 0;
  bool json = false;
};

/// Selects what a gesture shows, and its likes where some are asked for.
struct Select {
  const sdk::Surface& surface;
  std::size_t expand;
  const sdk::Task& task;

  using Found = sdk::Expected<sdk::Expansion>;
  static Found alone(sdk::Expected<std::vector<sdk::FaceId>> faces) {
    return std::move(faces).map([](auto&& found) { return sdk::Expansion(std::move(found), {}, {}); });
  }
  Found operator()(const ComponentGesture& gesture) const {
    const auto index = sdk::ComponentIndex::build(surface.mesh, surface.adjacency, task);
    if (!index) return tl::unexpected(index.error());
    return index->expand(gesture.face);
  }
  Found operator()(const PartGesture& gesture) const {
    const auto model = sdk::PartModel::build(surface, task);
    if (!model) return tl::unexpected(model.error());
    sdk::PartCut cut(*model);
    for (std::size_t i = 0; i < gesture.strokes.size(); ++i) {
      const auto points = sdk::project_stroke(surface, gesture.strokes[i], "stroke " + std::to_string(i));
      if (!points) return tl::unexpected(points.error());
      cut.begin_stroke();
      for (const sdk::SurfacePoint& point : *points) cut.add_point(point);
    }
    auto part = cut.faces();
    if (!part || expand == 0) return alone(std::move(part));
    return sdk::expand_part(*model, *part, {}, task);
  }
  Found operator()(const PatchGesture& gesture) const { return patch(sdk::select_patch(surface, gesture.drawn)); }
  Found operator()(const LassoGesture& gesture) const { return patch(sdk::select_lasso(surface, gesture.drawn)); }
  Found patch(sdk::Expected<std::vector<sdk::FaceId>> faces) const {
    if (!faces || expand == 0) return alone(std::move(faces));
    return sdk::expand_patch(surface, *faces, {.most = std::max<std::size_t>(64, 2 * expand)}, task);
  }
};

/// The descriptor of every point by name, where no faces are needed.
template <sdk::GlsAggregation aggregation>
sdk::Expected<std::unique_ptr<sdk::Descriptor>> gls_of(const sdk::PointSet& points, const sdk::Task& task) {
  const auto fits = sdk::GrowingLeastSquares::build(points, {}, task);
  if (!fits) return tl::unexpected(fits.error());
  return sdk::gls_descriptor(*fits, aggregation, task);
}
using MakePointDescriptor = sdk::Expected<std::unique_ptr<sdk::Descriptor>> (*)(const sdk::PointSet&, const sdk::Task&);
constexpr std::array<std::pair<const char*, MakePointDescriptor>, 2> kPointMaps = {
    {{"gls", gls_of<sdk::GlsAggregation::Mean>}, {"gls-histogram", gls_of<sdk::GlsAggregation::Histograms>}}};

/// The descriptor of every vertex by name.
template <sdk::GlsAggregation aggregation>
sdk::Expected<std::unique_ptr<sdk::Descriptor>> gls(const sdk::Surface& surface, std::span<const sdk::FaceId>,
                                                    const sdk::Task& task) {
  return gls_of<aggregation>(sdk::point_set_of(surface.mesh), task);
}
template <auto signature>
sdk::Expected<std::unique_ptr<sdk::Descriptor>> spectral(const sdk::Surface& surface, std::span<const sdk::FaceId>,
                                                         const sdk::Task& task) {
  const sdk::Laplacian laplacian = sdk::laplacian(surface.mesh, surface.adjacency);
  // A map needs no more digits than that; where a mesh has slivers, rounding leaves five or six.
  constexpr double kEnough = 1e-4;
  const sdk::SpectrumOptions options;
  const auto components = sdk::find_components(surface.mesh, surface.adjacency, sdk::LinkedBy::Vertices).count;
  if (components >= options.count)
    return sdk::fail(
        fmt::format("has {} components; the map looks at {} eigenfunctions, which tell components apart "
                    "first; try --map gls",
                    components, options.count));
  const auto spectrum = sdk::spectrum(surface.mesh, laplacian, options, task);
  if (!spectrum) return tl::unexpected(spectrum.error());
  const double worst = spectrum->residuals.maxCoeff();
  if (!(worst <= kEnough))
    return sdk::fail(fmt::format(
        "the Laplacian's eigenfunctions did not converge: a residual of {:.1e}, expected {:.0e}; try --map gls", worst,
        kEnough));
  if (worst > options.tolerance)
    fmt::print(stderr,
               "note: the map is less exact than usual: residuals of eigenfunctions are up to {:.1e}, not {:.0e}\n",
               worst, options.tolerance);
  return signature(*spectrum, laplacian);
}
sdk::Expected<std::unique_ptr<sdk::Descriptor>> psc(const sdk::Surface& surface, std::span<const sdk::FaceId> reference,
                                                    const sdk::Task& task) {
  const auto ball = sdk::patch_ball(surface, reference);
  if (!ball) return tl::unexpected(ball.error());
  const auto contexts = sdk::PatchContexts::build(surface, ball->radius, task);
  if (!contexts) return tl::unexpected(contexts.error());
  return sdk::patch_shape_context(surface, *contexts, task);
}
sdk::Expected<std::unique_ptr<sdk::Descriptor>> quadric(const sdk::Surface& surface, std::span<const sdk::FaceId>,
                                                        const sdk::Task&) {
  return sdk::quadric_descriptor(surface.mesh);
}
using MakeDescriptor = sdk::Expected<std::unique_ptr<sdk::Descriptor>> (*)(const sdk::Surface&,
                                                                           std::span<const sdk::FaceId>,
                                                                           const sdk::Task&);
constexpr std::array<std::pair<const char*, MakeDescriptor>, 7> kMaps = {
    {{"gls", gls<sdk::GlsAggregation::Mean>},
     {"gls-histogram", gls<sdk::GlsAggregation::Histograms>},
     {"quadric", quadric},
     {"hks", spectral<sdk::heat_kernel_signature>},
     {"si-hks", spectral<sdk::scale_invariant_heat_kernel_signature>},
     {"wks", spectral<sdk::wave_kernel_signature>},
     {"psc", psc}}};

/// By the similarity of every vertex to some of them.
sdk::Expected<std::vector<double>> weights_by(sdk::Expected<std::unique_ptr<sdk::Descriptor>> descriptor,
                                              std::span<const sdk::VertexId> reference, const Arguments& arguments,
                                              const sdk::Task& task) {
  if (!descriptor) return tl::unexpected(descriptor.error());
  const auto unlike = sdk::dissimilarities(**descriptor, reference, task);
  if (!unlike) return tl::unexpected(unlike.error());
  return sdk::edit_weights(sdk::similarity_map(*unlike, arguments.share), {arguments.from, arguments.to});
}

/// What all edits work on.
struct Job {
  const Arguments& arguments;
  const sdk::Surface& surface;
  const sdk::Expansion& found;
  const sdk::Task& task;

  [[nodiscard]] double length() const { return arguments.amount * surface.diagonal; }
  [[nodiscard]] std::span<const sdk::Match> matches() const { return found.first(arguments.expand); }

  /// By the similarity of every vertex to the selection.
  [[nodiscard]] sdk::Expected<std::vector<double>> weights() const {
    std::vector<sdk::VertexId> vertices;
    for (const sdk::FaceId face : found.reference())
      for (const sdk::VertexId v : surface.mesh.triangle(face)) vertices.push_back(v);
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return weights_by(choice_of(kMaps, arguments.map)(surface, found.reference(), task), vertices, arguments, task);
  }
  [[nodiscard]] sdk::Expected<sdk::Mesh> everywhere(const sdk::RegionEdit& edit) const {
    return sdk::transported(surface, found.reference(), matches(), edit, {}, task);
  }
};

using Op = sdk::Expected<sdk::Mesh> (*)(const Job&);

sdk::Expected<sdk::Mesh> displace(const Job& job) {
  if (job.arguments.expand > 0) return job.everywhere(sdk::DisplaceEdit{job.length()});
  return job.weights().and_then([&](const auto& w) { return sdk::displaced(job.surface.mesh, w, job.length()); });
}
sdk::Expected<sdk::Mesh> smooth(const Job& job) {
  if (job.arguments.expand > 0) return job.everywhere(sdk::SmoothEdit{job.length()});
  return job.weights().and_then([&](const auto& w) {
    return sdk::smoothed(job.surface.mesh, sdk::laplacian(job.surface.mesh, job.surface.adjacency), w, job.length(),
                         job.task);
  });
}
sdk::Expected<sdk::Mesh> sharpen(const Job& job) {
  if (job.arguments.expand > 0) return sdk::fail("--op sharpen: works by a map; leave --expand out");
  constexpr double kLength = 0.01;
  return job.weights().and_then([&](const auto& w) {
    return sdk::sharpened(job.surface.mesh, sdk::laplacian(job.surface.mesh, job.surface.adjacency), w,
                          kLength * job.surface.diagonal, job.arguments.amount, job.task);
  });
}
sdk::Expected<sdk::Mesh> paint(const Job& job) {
  if (job.arguments.expand > 0)
    return job.everywhere(sdk::PaintEdit{kPaint, std::clamp(job.arguments.amount, 0.0, 1.0)});
  return job.weights().and_then([&](auto w) {
    for (double& weight : w) weight *= std::clamp(job.arguments.amount, 0.0, 1.0);
    return sdk::painted(job.surface.mesh, w, kPaint);
  });
}
sdk::Expected<sdk::Mesh> pull(const Job& job) {
  const auto ball = sdk::patch_ball(job.surface, job.found.reference());
  if (!ball) return tl::unexpected(ball.error());
  const Eigen::Vector3d& normal = job.surface.vertex_normals[ball->centre.index()];
  return job.everywhere(sdk::HandleEdit{job.surface.mesh.position(ball->centre), job.length() * normal});
}
sdk::Expected<sdk::Mesh> copy(const Job& job) {
  if (job.arguments.expand == 0) return sdk::fail("--op copy: needs --expand, how many regions take the shape");
  return job.everywhere(sdk::CopyEdit{});
}
sdk::Expected<sdk::Mesh> alike(const Job& job) {
  if (job.arguments.expand == 0) return sdk::fail("--op alike: needs --expand, how many regions become alike");
  return sdk::made_alike(job.surface, job.found.reference(), job.matches(), job.arguments.amount, {}, job.task);
}

constexpr std::array<std::pair<const char*, Op>, 7> kOps = {{{"alike", alike},
                                                             {"copy", copy},
                                                             {"displace", displace},
                                                             {"paint", paint},
                                                             {"pull", pull},
                                                             {"sharpen", sharpen},
                                                             {"smooth", smooth}}};

/// What an edit took, and how many regions it was carried to.
struct Took {
  double select_ms = 0, edit_ms = 0;
  std::size_t matches = 0;
};

/// What an edit moved, and how far.
struct Moved {
  std::size_t vertices = 0;
  double farthest = 0;
};

/// Refuses what went so far that squares of its way are no numbers.
Expected<Moved> moved(const Arguments& arguments, std::span<const Eigen::Vector3d> before,
                      std::span<const Eigen::Vector3d> after) {
  Moved result;
  for (std::size_t v = 0; v < before.size(); ++v) {
    const double way = (after[v] - before[v]).norm();
    if (!std::isfinite(way))
      return fail(
          fmt::format("--amount: {} moves vertices beyond all numbers; expected one nearer 0", arguments.amount));
    result.vertices += way > 0 ? 1U : 0U;
    result.farthest = std::max(result.farthest, way);
  }
  return result;
}

Expected<void> tell(const Arguments& arguments, std::size_t vertices, const Moved& moved, const Took& took) {
  if (arguments.json)
    return write_json_line(stdout, {{"matches", took.matches},
                                    {"moved", moved.vertices},
                                    {"farthest", number(moved.farthest)},
                                    {"select_ms", number(took.select_ms)},
                                    {"edit_ms", number(took.edit_ms)}});
  fmt::print("{}: moved {} of {} vertices, by {:.4g} at most; {} matches\n", arguments.out, moved.vertices, vertices,
             moved.farthest, took.matches);
  return {};
}

Expected<void> edit_mesh(const Arguments& arguments, const sdk::Mesh& mesh, const sdk::Task& task) {
  if (const std::string wrong = wrong_mesh_name(arguments.out); !wrong.empty()) return fail(wrong);
  const auto gesture = read_gesture(arguments.gesture, mesh.triangles.size());
  if (!gesture) return tl::unexpected(gesture.error());
  const auto start = std::chrono::steady_clock::now();
  const sdk::Surface surface(mesh);
  const auto found = std::visit(Select{surface, arguments.expand, task}, *gesture);
  if (!found) return fail(arguments.gesture + ": " + found.error().message);
  Took took{.select_ms = milliseconds_since(start)};
  const auto began = std::chrono::steady_clock::now();
  const Job job{arguments, surface, *found, task};
  const auto edited = ours(choice_of(kOps, arguments.op)(job));
  if (!edited) return fail(arguments.mesh + ": " + edited.error().message);
  took.edit_ms = milliseconds_since(began);
  took.matches = job.matches().size();
  const auto done = moved(arguments, mesh.positions, edited->positions);
  if (!done) return tl::unexpected(done.error());
  if (auto written = ours(sdk::write_mesh(*edited, arguments.out)); !written) return written;
  return tell(arguments, mesh.positions.size(), *done, took);
}

/// By a map and along normals: what needs no faces.
Expected<void> edit_points(const Arguments& arguments, const sdk::PointSet& points, const sdk::Task& task) {
  const auto refuse = [&](const char* what) {
    return fail(fmt::format("{}: has {} points and no faces; {}", arguments.mesh, points.positions.size(), what));
  };
  if (const std::string wrong = wrong_points_name(arguments.out); !wrong.empty()) return fail(wrong);
  if (arguments.op != "displace" && arguments.op != "paint")
    return refuse("--op displace and paint work on points, the others on meshes");
  if (arguments.op == "paint" && sdk::mesh_format_of(arguments.out) == sdk::MeshFormat::Xyz)
    return fail(arguments.out + ": XYZ keeps no colours; expected a name that ends in .ply or .obj for --op paint");
  if (arguments.expand > 0) return refuse("--expand needs a mesh; leave it out to edit by the map");
  const auto map = std::ranges::find(kPointMaps, arguments.map, [](const auto& known) { return known.first; });
  if (map == kPointMaps.end()) return refuse("--map gls and gls-histogram work on points, the others on meshes");
  const auto gesture = read_gesture(arguments.gesture, 0);
  if (!gesture) return tl::unexpected(gesture.error());
  const auto* patch = std::get_if<PatchGesture>(&*gesture);
  if (patch == nullptr) return refuse("a gesture of the tool patch selects points, the others faces");
  const auto start = std::chrono::steady_clock::now();
  const auto reference = sdk::select_patch(points, patch->drawn);
  if (!reference) return fail(arguments.gesture + ": " + reference.error().message);
  Took took{.select_ms = milliseconds_since(start)};
  const auto began = std::chrono::steady_clock::now();
  const auto edited =
      ours(weights_by(map->second(points, task), *reference, arguments, task).and_then([&](auto weights) {
        if (arguments.op == "displace") {
          Eigen::AlignedBox3d box;
          for (const Eigen::Vector3d& p : points.positions) box.extend(p);
          return sdk::displaced(points, weights, arguments.amount * box.diagonal().norm());
        }
        for (double& weight : weights) weight *= std::clamp(arguments.amount, 0.0, 1.0);
        return sdk::painted(points, weights, kPaint);
      }));
  if (!edited) return fail(arguments.mesh + ": " + edited.error().message);
  took.edit_ms = milliseconds_since(began);
  const auto done = moved(arguments, points.positions, edited->positions);
  if (!done) return tl::unexpected(done.error());
  if (auto written = ours(sdk::write_points(*edited, arguments.out)); !written) return written;
  return tell(arguments, points.positions.size(), *done, took);
}

Expected<void> run_edit(const Arguments& arguments) {
  if (!(arguments.to > arguments.from)) return fail("--to: expected more than --from");
  if (!std::isfinite(arguments.amount)) return fail("--amount: expected a finite number");
  if (!(arguments.share > 0 && arguments.share <= 1)) return fail("--share: expected more than 0 and at most 1");
  SdkCall call;
  const auto shape = ours(sdk::read_mesh_or_points(arguments.mesh, {}, call.task()));
  if (!shape) return tl::unexpected(shape.error());
  if (const auto* points = std::get_if<sdk::PointSet>(&*shape)) return edit_points(arguments, *points, call.task());
  return edit_mesh(arguments, std::get<sdk::Mesh>(*shape), call.task());
}

}  // namespace

void add_edit(CLI::App& app, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("edit", "Edit a mesh, or points, at a selection and at all that is like it");
  command->add_option("MESH", arguments->mesh, "a triangle mesh, or points with normals (PLY, OBJ, NOFF, XYZ)")
      ->required();
  command
      ->add_option("OUT", arguments->out, "the edited one: OBJ, OFF or PLY; of points: PLY, OBJ or, but for paint, XYZ")
      ->required()
      ->check(wrong_shape_name);
  command->add_option("--gesture", arguments->gesture, "what is selected, as for `armature select`")
      ->required()
      ->type_name("G.json");
  command->add_option("--map", arguments->map, "what vertices are compared with the selection by")
      ->check(CLI::IsMember(names_of(kMaps)))
      ->capture_default_str();
  command->add_option("--op", arguments->op, "what is done")->required()->check(CLI::IsMember(names_of(kOps)));
  command
      ->add_option("--amount", arguments->amount,
                   "how much: a part of the bounding box's diagonal for displace, pull (along the normal) and smooth; "
                   "a factor for sharpen and alike; a strength up to 1 for paint")
      ->required()
      ->type_name("A");
  command
      ->add_option("--expand", arguments->expand,
                   "edit the selection and so many regions like it, each in its place, instead of by the map")
      ->check(CLI::Range(0, 1'000'000))
      ->type_name("K");
  command->add_option("--share", arguments->share, "of the vertices within one sigma of the selection, by the map")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  command->add_option("--from", arguments->from, "similarity up to which nothing is done")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--to", arguments->to, "similarity from which all is done")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_flag("--json", arguments->json, "one JSON object: matches, moved, farthest, times in milliseconds");
  command->footer(
      "By a map: displace, smooth, sharpen, paint. By regions (--expand): displace, smooth, paint, pull (a handle in\n"
      "the middle), copy (the others take the selection's shape), alike (towards their mean; away for a negative\n"
      "amount). Regions are edited up to their boundary, where the edit has faded. Points, which have no faces, are\n"
      "displaced and painted by --map gls or gls-histogram, from a gesture of the tool patch.\n\n"
      "Examples:\n"
      "  echo '{\"tool\":\"component\",\"face\":0}' > click.json\n"
      "  armature edit engine.obj larger.obj --gesture click.json --op displace --amount 0.01 --expand 8\n"
      "  armature edit scan.xyz map.ply --gesture patch.json --op paint --amount 1\n"
      "  armature edit cow.obj bumpy.obj --gesture patch.json --map wks --op displace --amount 0.02");
  command->callback([arguments, &run] { run = [arguments] { return run_edit(*arguments); }; });
}

}  // namespace armature::tools
