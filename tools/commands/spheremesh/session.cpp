#include <array>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>

#include <armature/sdk/deformation/session.h>
#include <armature/sdk/io/sphere_mesh_file.h>
#include <armature/sdk/io/write_mesh.h>
#include <fmt/format.h>

#include "tools/commands/output_names.h"
#include "tools/commands/spheremesh/inputs.h"
#include "tools/commands/spheremesh/spheremesh.h"
#include "tools/json_lines.h"
#include "tools/sdk_call.h"

namespace armature::tools {
namespace {

struct Arguments {
  std::string mesh, hierarchy, session, out, spheres;
  bool json = false;
};

Expected<std::string> contents_of(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string text;
  std::array<char, 65536> block;
  while (in.read(block.data(), block.size()) || in.gcount() > 0)
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
  if (!in.is_open() || in.bad()) return fail(file + ": cannot be read; expected a deformation session");
  return text;
}

Expected<void> run_session(const Arguments& arguments) {
  SdkCall call;
  const auto read = read_mesh_with_hierarchy(arguments.mesh, arguments.hierarchy, call.task());
  if (!read) return tl::unexpected(read.error());
  const auto& [mesh, hierarchy] = *read;
  const auto text = contents_of(arguments.session);
  if (!text) return tl::unexpected(text.error());
  auto session = sdk::DeformationSession::start(mesh, hierarchy, hierarchy.min_spheres(), {}, call.task());
  if (!session) return fail(fmt::format("{}: {}", arguments.mesh, session.error().message));
  if (const auto replayed = ours(session->replay(*text, arguments.session, call.task())); !replayed) return replayed;
  sdk::Mesh deformed = mesh;
  deformed.positions.assign(session->positions().begin(), session->positions().end());
  if (auto written = ours(sdk::write_mesh(deformed, arguments.out, {}, call.task())); !written) return written;
  if (!arguments.spheres.empty())
    if (auto written = ours(sdk::write_sphere_mesh(session->shape(), arguments.spheres, call.task())); !written)
      return written;
  if (arguments.json)
    return write_json_line(stdout, {{"vertices", deformed.positions.size()}, {"spheres", session->nodes().size()}});
  fmt::print("{}: {} vertices, at a level of {} spheres\n", arguments.out, deformed.positions.size(),
             session->nodes().size());
  return {};
}

}  // namespace

void add_spheremesh_session(CLI::App& spheremesh, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = spheremesh.add_subcommand("session", "Replay a deformation session over several levels.");
  command->add_option("MESH", arguments->mesh, "the mesh that the hierarchy was built from")->required();
  command->add_option("HIERARCHY", arguments->hierarchy, "its hierarchy (.smh)")->required()->type_name("H.smh");
  command->add_option("SESSION", arguments->session, "the steps, one a line (below)")->required()->type_name("S.txt");
  command->add_option("OUT", arguments->out, "the deformed mesh: .ply, .obj or .off; vertices keep their order")
      ->required()
      ->check(wrong_mesh_name);
  command->add_option("--spheres", arguments->spheres, "write the last level, fitted to it, as well (.ma, .ply, .urdf)")
      ->type_name("OUT.ma")
      ->check(wrong_sphere_mesh_name);
  command->add_flag("--json", arguments->json, "one JSON object: vertices, spheres");
  command->footer(
      "  armature deformation 1\n"
      "  level 40                                  # spheres from here on\n"
      "  move spheres 3 7 translate 0 0.1 0 rotate 0 0 0.5 about 1 0 0 scale 1.1 radius 0.2 frame parent\n"
      "  move spheres 5 translate 0 0 0.01 surface 2   # what lies within 2 edges follows as rigidly as possible\n"
      "  pin spheres 4                             # and unpin: what it stands for stays, at every level\n"
      "Moves are as in `spheremesh deform`; after each the spheres are fitted to the mesh as it then is. With\n"
      "`frame parent` numbers are those of the undeformed model, carried along with the sphere above.\n\n"
      "Example:\n  armature spheremesh session cow.obj cow.smh pose.txt posed.ply");
  command->callback([arguments, &run] { run = [arguments] { return run_session(*arguments); }; });
}

}  // namespace armature::tools
