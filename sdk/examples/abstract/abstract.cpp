// Abstracts a mesh to a few interpolated spheres.
//
// usage: abstract IN.obj OUT.ma [SPHERES]

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/sphere_mesh_file.h>

namespace sdk = armature::sdk;

namespace {

/// From a mesh's file to a sphere-mesh's; how many spheres it got.
sdk::Expected<std::size_t> abstract(const char* in, const char* out, std::size_t spheres) {
  const auto mesh = sdk::read_mesh(in);
  if (!mesh) return tl::unexpected(mesh.error());
  const auto built = sdk::build_hierarchy(*mesh);
  if (!built) return tl::unexpected(built.error());
  // Every level is there, down to one sphere for a mesh in one piece.
  const sdk::Hierarchy& hierarchy = built->hierarchy;
  const auto shape = hierarchy.level(std::clamp(spheres, hierarchy.min_spheres(), hierarchy.leaf_count()));
  if (!shape) return tl::unexpected(shape.error());
  if (const auto written = sdk::write_sphere_mesh(*shape, out); !written) return tl::unexpected(written.error());
  return shape->spheres.size();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: abstract IN.obj OUT.ma [SPHERES]\n");
    return 2;
  }
  const long spheres = argc > 3 ? std::atol(argv[3]) : 45;
  const auto done = abstract(argv[1], argv[2], static_cast<std::size_t>(std::max(1L, spheres)));
  if (!done) {
    std::fprintf(stderr, "abstract: %s\n", done.error().message.c_str());
    return 1;
  }
  std::printf("%zu spheres\n", *done);
  return 0;
}
