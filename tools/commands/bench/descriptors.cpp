#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <armature/sdk/descriptors/descriptors.h>
#include <armature/sdk/editing/region_edits.h>
#include <armature/sdk/expansion/component_index.h>
#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/measures.h>
#include <fmt/format.h>

#include "tools/commands/bench/bench.h"
#include "tools/commands/bench/sections.h"
#include "tools/commands/choices.h"
#include "tools/elapsed.h"
#include "tools/evaluation/planted.h"
#include "tools/evaluation/shapes.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

using Eigen::Vector3d;
using Clock = std::chrono::steady_clock;

struct DescriptorsBenchOptions {
  std::string models;
  std::vector<std::string> only;
  int rounds = 3;
  bool json = false;
};

struct Named {
  std::string name;
  sdk::Mesh mesh;
};

/// A sheet in the plane, or rolled up to most of a cylinder, which is isometric as a surface.
sdk::Mesh sheet(int cells, bool rolled) {
  sdk::Mesh mesh;
  for (int i = 0; i <= 2 * cells; ++i)
    for (int j = 0; j <= cells; ++j) {
      const Vector3d at(static_cast<double>(i) / (2 * cells), static_cast<double>(j) / cells, 0);
      const double x = 2 * at.x() + 0.3 * at.x() * at.y();
      mesh.positions.push_back(rolled ? Vector3d(std::cos(x), std::sin(x), at.y()) : Vector3d(x, at.y(), 0));
    }
  const auto vertex = [&](int i, int j) { return sdk::VertexId(static_cast<std::size_t>(i * (cells + 1) + j)); };
  for (int i = 0; i < 2 * cells; ++i)
    for (int j = 0; j < cells; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  return mesh;
}

constexpr double kMajor = 2, kMinor = 0.7;

/// Points of a torus with their normals and areas: `around` along its tube, three times as many along its ring.
sdk::PointSet torus(int around) {
  sdk::PointSet points;
  constexpr double pi = std::numbers::pi;
  for (int i = 0; i < 3 * around; ++i)
    for (int j = 0; j < around; ++j) {
      const double u = 2 * pi * i / (3 * around);
      const double v = 2 * pi * (j + 0.5) / around;
      const Vector3d out(std::cos(u), std::sin(u), 0);
      const Vector3d normal = std::cos(v) * out + std::sin(v) * Vector3d::UnitZ();
      points.positions.emplace_back(kMajor * out + kMinor * normal);
      points.normals.push_back(normal);
      points.areas.push_back((kMajor + kMinor * std::cos(v)) * kMinor * 4 * pi * pi / (3 * around * around));
    }
  return points;
}

/// What descriptors cost and how exact they are, and edits that are carried by likeness (thesis, chapters 5.6 and 6).
class DescriptorsBench : Report {
 public:
  explicit DescriptorsBench(DescriptorsBenchOptions options) : Report{options.json}, options_(std::move(options)) {}

  Expected<void> run() { return run_sections(*this, kSections, options_.only, call_, section_); }

  [[nodiscard]] static std::vector<std::string> sections() { return names_of(kSections); }

 private:
  static const Sections<DescriptorsBench, 5> kSections;

  Expected<std::vector<Named>> shapes(std::initializer_list<const char*> files) {
    std::vector<Named> all;
    for (int rounds = 5; rounds <= 7; ++rounds) all.push_back({fmt::format("creature {}", rounds), creature(rounds)});
    for (const char* file : files) {
      const std::filesystem::path path = std::filesystem::path(options_.models) / file;
      if (options_.models.empty() || !std::filesystem::exists(path)) continue;
      auto mesh = ours(sdk::read_mesh(path, {}, call_.task()));
      if (!mesh) return tl::unexpected(mesh.error());
      all.push_back({file, std::move(*mesh)});
    }
    return all;
  }

  /// A hundred eigenpairs.
  Expected<void> spectra() {
    title("100 eigenpairs: milliseconds, the fastest of some rounds, from the mesh on (goal at 50k vertices 3000)");
    const auto all = shapes({"vh_Hand1.off", "cg_raptor.off"});
    if (!all) return tl::unexpected(all.error());
    for (const auto& [name, mesh] : *all) {
      double least = std::numeric_limits<double>::infinity();
      sdk::Spectrum found;
      for (int k = 0; k < options_.rounds; ++k) {
        const auto start = Clock::now();
        const sdk::Laplacian laplacian = sdk::laplacian(mesh, sdk::Adjacency(mesh));
        auto spectrum = ours(sdk::spectrum(mesh, laplacian, {}, call_.task()));
        if (!spectrum) return tl::unexpected(spectrum.error());
        least = std::min(least, milliseconds_since(start));
        found = std::move(*spectrum);
      }
      const double worst = found.residuals.maxCoeff();
      if (auto said = say({{"section", section_},
                           {"name", name},
                           {"vertices", mesh.positions.size()},
                           {"ms", number(least)},
                           {"worst_residual", worst},
                           {"converged", found.converged}},
                          fmt::format("{:<28} {:8} vertices {:9.0f}  residuals to {:.1e}, {} converged", name,
                                      mesh.positions.size(), least, worst, found.converged));
          !said)
        return said;
    }
    return {};
  }

  /// Ten scales of growing least squares.
  Expected<void> gls() {
    title(
        "GLS at 10 scales: milliseconds, the fastest of some rounds, from points with normals on (goal at 100k 1000)");
    const auto all = shapes({"sd_dragon_vrip_res2.ply"});
    if (!all) return tl::unexpected(all.error());
    for (const auto& [name, mesh] : *all) {
      const sdk::PointSet points = sdk::point_set_of(mesh);
      double least = std::numeric_limits<double>::infinity();
      for (int k = 0; k < options_.rounds; ++k) {
        const auto start = Clock::now();
        const auto fits = ours(sdk::GrowingLeastSquares::build(points, {}, call_.task()));
        if (!fits) return tl::unexpected(fits.error());
        for (std::size_t scale = 0; scale < fits->scales().size(); ++scale)
          if (auto at = ours(fits->at_points(scale, call_.task())); !at) return tl::unexpected(at.error());
        least = std::min(least, milliseconds_since(start));
      }
      if (auto said =
              say({{"section", section_}, {"name", name}, {"points", points.positions.size()}, {"ms", number(least)}},
                  fmt::format("{:<28} {:8} points {:9.0f}", name, points.positions.size(), least));
          !said)
        return said;
    }
    return {};
  }

  /// A sheet that is rolled up.
  Expected<void> isometry() {
    title("Signatures of a sheet and of the same rolled up: how unlike at the same place at most, and places usually");
    for (const int cells : {15, 30, 60, 120}) {
      const std::array meshes = {sheet(cells, false), sheet(cells, true)};
      std::array<std::array<std::unique_ptr<sdk::Descriptor>, 3>, 2> signatures;
      for (std::size_t k = 0; k < 2; ++k) {
        const sdk::Laplacian laplacian = sdk::laplacian(meshes[k], sdk::Adjacency(meshes[k]));
        const auto spectrum = ours(sdk::spectrum(meshes[k], laplacian, {}, call_.task()));
        if (!spectrum) return tl::unexpected(spectrum.error());
        signatures[k] = {sdk::heat_kernel_signature(*spectrum, laplacian),
                         sdk::scale_invariant_heat_kernel_signature(*spectrum, laplacian),
                         sdk::wave_kernel_signature(*spectrum, laplacian)};
      }
      Json json = {{"section", section_}, {"vertices", meshes[0].positions.size()}};
      std::string line = fmt::format("{:6} vertices", meshes[0].positions.size());
      for (std::size_t s = 0; s < 3; ++s) {
        static constexpr std::array kNames = {"hks", "si_hks", "wks"};
        std::vector<float> a(signatures[0][s]->width()), b(a), first(a);
        signatures[0][s]->describe(sdk::VertexId(0), first);
        double worst = 0;
        double usual = 0;
        const std::size_t count = meshes[0].positions.size();
        for (std::size_t v = 0; v < count; ++v) {
          signatures[0][s]->describe(sdk::VertexId(v), a);
          signatures[1][s]->describe(sdk::VertexId(v), b);
          worst = std::max(worst, signatures[0][s]->dissimilarity(a, b, 1));
          usual += signatures[0][s]->dissimilarity(a, first, 1) / static_cast<double>(count);
        }
        json[fmt::format("{}_worst", kNames[s])] = worst;
        json[fmt::format("{}_usual", kNames[s])] = usual;
        line += fmt::format("  {} {:.1e} of {:.2f}", kNames[s], worst, usual);
      }
      if (auto said = say(json, line); !said) return said;
    }
    return {};
  }

  /// Ever more points of a torus.
  Expected<void> refinement() {
    title(
        "GLS on a torus of tube 0.7, scale 0.3: the farthest from the finest, by tau / t, t kappa, phi; without unit");
    constexpr double kScale = 0.3;
    const auto fits_of = [&](int around, double merged) {
      return ours(sdk::GrowingLeastSquares::build(torus(around), {.scales = {kScale}, .merged = merged}, call_.task()));
    };
    const auto finest = fits_of(1024, 0);
    if (!finest) return tl::unexpected(finest.error());
    for (const double merged : {0.0, sdk::GlsOptions{}.merged})
      for (const int around : {16, 32, 64, 128, 256}) {
        const auto fits = fits_of(around, merged);
        if (!fits) return tl::unexpected(fits.error());
        std::array<double, 3> worst{};
        for (int k = 0; k < 48; ++k) {
          const double v = 2 * std::numbers::pi * k / 48;
          const Vector3d out = Vector3d(std::cos(0.37 * k), std::sin(0.37 * k), 0);
          const Vector3d place = kMajor * out + kMinor * (std::cos(v) * out + std::sin(v) * Vector3d::UnitZ());
          const sdk::Gls here = fits->at(place, 0);
          const sdk::Gls there = finest->at(place, 0);
          worst[0] = std::max(worst[0], std::abs(here.tau - there.tau) / kScale);
          worst[1] = std::max(worst[1], std::abs(here.kappa - there.kappa) * kScale);
          worst[2] = std::max(worst[2], std::abs(here.phi - there.phi));
        }
        const std::size_t points = fits->points().positions.size();
        if (auto said = say({{"section", section_},
                             {"points", points},
                             {"merged", merged},
                             {"tau", worst[0]},
                             {"kappa", worst[1]},
                             {"phi", worst[2]}},
                            fmt::format("{:8} points, {}  {:.1e}  {:.1e}  {:.1e}", points,
                                        merged > 0 ? "summed up" : "each     ", worst[0], worst[1], worst[2]));
            !said)
          return said;
      }
    return {};
  }

  /// An edit that is carried to copies, against the same edit done there.
  Expected<void> transport() {
    title("Edits carried to what is found of copies: off what is done there, in % of the diagonal (goal 1)");
    constexpr int kRounds = 6;
    for (const auto& [name, plant] : {std::pair{"reliefs, turned", PlantOptions{}},
                                      {"reliefs, mirrored", PlantOptions{.mirrored = true}},
                                      {"reliefs, noise 0.1 %", PlantOptions{.noise_percent = 0.1}}}) {
      const PlantedScene scene = planted_reliefs(plant, kRounds);
      const sdk::Surface surface(scene.mesh);
      const auto found = ours(sdk::expand_patch(surface, scene.reference, {}, call_.task()));
      if (!found) return tl::unexpected(found.error());
      if (auto said = say_transport(name, scene, surface, *found); !said) return said;
    }
    for (const auto& [name, plant] : {std::pair{"components, turned", PlantOptions{}},
                                      {"components, mirrored", PlantOptions{.mirrored = true}},
                                      {"components, 1.5 times as large", PlantOptions{.largest_scale = 1.5}},
                                      {"components, noise 0.1 %", PlantOptions{.noise_percent = 0.1}}}) {
      const PlantedScene scene = planted_components(plant, 4);
      const sdk::Surface surface(scene.mesh);
      const auto index = ours(sdk::ComponentIndex::build(scene.mesh, surface.adjacency, call_.task()));
      if (!index) return tl::unexpected(index.error());
      const auto found = ours(index->expand(scene.reference.front()));
      if (!found) return tl::unexpected(found.error());
      if (auto said = say_transport(name, scene, surface, *found); !said) return said;
    }
    return {};
  }

  Expected<void> say_transport(const std::string& name, const PlantedScene& scene, const sdk::Surface& surface,
                               const sdk::Expansion& found) {
    Eigen::AlignedBox3d box;
    for (const sdk::FaceId face : scene.reference)
      for (const sdk::VertexId v : scene.mesh.triangle(face)) box.extend(scene.mesh.position(v));
    const double size = box.diagonal().norm();
    // Reliefs are parts of a mesh, components meshes of their own.
    const bool parts = scene.reference.size() < scene.mesh.triangles.size() / 100;
    const double diagonal = parts ? surface.diagonal : size;
    sdk::VertexId middle = scene.mesh.triangle(scene.reference.front())[0];
    for (const sdk::FaceId face : scene.reference)
      for (const sdk::VertexId v : scene.mesh.triangle(face))
        if ((scene.mesh.position(v) - box.center()).norm() < (scene.mesh.position(middle) - box.center()).norm())
          middle = v;
    const Vector3d by = 0.2 * size * Vector3d(1, 2, -1).normalized();
    for (const auto& [kind, edit] : {std::pair<const char*, sdk::RegionEdit>{"displace", sdk::DisplaceEdit{0.1 * size}},
                                     {"smooth", sdk::SmoothEdit{0.1 * size}},
                                     {"handle", sdk::HandleEdit{scene.mesh.position(middle), by}}}) {
      const auto carried =
          ours(sdk::transported(surface, scene.reference, found.first(scene.copies.size()), edit, {}, call_.task()));
      if (!carried) return tl::unexpected(carried.error());
      double worst = 0;
      double sum = 0;
      double moved_by = 0;
      std::size_t count = 0;
      for (const PlantedCopy& copy : scene.copies) {
        const Eigen::Matrix4d there = copy.reference_from_copy.inverse();
        const double scale = std::cbrt(std::abs(there.topLeftCorner<3, 3>().determinant()));
        const auto done = ours(sdk::transported(surface, copy.faces, {}, moved(edit, there, scale), {}, call_.task()));
        if (!done) return tl::unexpected(done.error());
        for (const sdk::FaceId face : copy.faces)
          for (const sdk::VertexId v : scene.mesh.triangle(face)) {
            const double off = (carried->position(v) - done->position(v)).norm() / (scale * diagonal);
            moved_by = std::max(moved_by, (done->position(v) - scene.mesh.position(v)).norm() / (scale * diagonal));
            worst = std::max(worst, off);
            sum += off;
            ++count;
          }
      }
      const double mean = sum / static_cast<double>(count);
      if (auto said = say({{"section", section_},
                           {"name", name},
                           {"edit", kind},
                           {"moved_percent", number(100 * moved_by)},
                           {"mean_percent", number(100 * mean)},
                           {"worst_percent", number(100 * worst)}},
                          fmt::format("{:<32} {:<10} by up to {:6.3f}  mean {:.3f}  worst {:.3f}", name, kind,
                                      100 * moved_by, 100 * mean, 100 * worst));
          !said)
        return said;
    }
    return {};
  }

  /// An edit as it is to be done at a copy.
  static sdk::RegionEdit moved(const sdk::RegionEdit& edit, const Eigen::Matrix4d& there, double scale) {
    if (const auto* displace = std::get_if<sdk::DisplaceEdit>(&edit))
      return sdk::DisplaceEdit{scale * displace->distance};
    if (const auto* smooth = std::get_if<sdk::SmoothEdit>(&edit)) return sdk::SmoothEdit{scale * smooth->length};
    const auto& handle = std::get<sdk::HandleEdit>(edit);
    return sdk::HandleEdit{(there * handle.point.homogeneous()).head<3>(), there.topLeftCorner<3, 3>() * handle.by};
  }

  DescriptorsBenchOptions options_;
  SdkCall call_;
  std::string section_;
};

const Sections<DescriptorsBench, 5> DescriptorsBench::kSections = {{{"spectra", &DescriptorsBench::spectra},
                                                                    {"gls", &DescriptorsBench::gls},
                                                                    {"isometry", &DescriptorsBench::isometry},
                                                                    {"refinement", &DescriptorsBench::refinement},
                                                                    {"transport", &DescriptorsBench::transport}}};

}  // namespace

void add_bench_descriptors(CLI::App& bench, Run& run) {
  auto options = std::make_shared<DescriptorsBenchOptions>();
  CLI::App* command = bench.add_subcommand(
      "descriptors", "What descriptors cost, how exact they are, and what is carried by likeness (thesis, 5.6 and 6).");
  command->add_option("--models", options->models, "a folder with the thesis's models; else our own shapes alone")
      ->type_name("FOLDER");
  command
      ->add_option("--only", options->only,
                   "sections: " + fmt::format("{}", fmt::join(DescriptorsBench::sections(), ", ")))
      ->check(CLI::IsMember(DescriptorsBench::sections()))
      ->delimiter(',');
  command->add_option("--rounds", options->rounds, "of what is timed")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--json", options->json, "one JSON object a line");
  command->footer("Example:\n  armature bench descriptors --only isometry,refinement,transport");
  command->callback([options, &run] { run = [options] { return DescriptorsBench(*options).run(); }; });
}

}  // namespace armature::tools
