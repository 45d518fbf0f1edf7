// Selects a patch of a mesh with one dab of a brush, and lists all that is like it.
//
// usage: select_likes IN.obj X Y Z RADIUS

#include <cstdio>
#include <cstdlib>

#include <armature/sdk/expansion/patch_expansion.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/selection/patch_brush.h>

namespace sdk = armature::sdk;

namespace {

sdk::Expected<void> list_likes(const char* in, const Eigen::Vector3d& at, double radius) {
  const auto mesh = sdk::read_mesh(in);
  if (!mesh) return tl::unexpected(mesh.error());
  const sdk::Surface surface(*mesh);
  const auto patch = sdk::select_patch(surface, {.strokes = {{at}}, .radius = radius});
  if (!patch) return tl::unexpected(patch.error());
  // All candidates are found now; asking for the best 5, or 50, then costs nothing.
  auto likes = sdk::expand_patch(surface, *patch);
  if (!likes) return tl::unexpected(likes.error());
  for (const sdk::Match& match : likes->first(5))
    std::printf("%.2f  %zu faces: %s\n", match.score, match.faces.size(), match.reason.c_str());
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: select_likes IN.obj X Y Z RADIUS\n");
    return 2;
  }
  const auto done =
      list_likes(argv[1], {std::atof(argv[2]), std::atof(argv[3]), std::atof(argv[4])}, std::atof(argv[5]));
  if (!done) {
    std::fprintf(stderr, "select_likes: %s\n", done.error().message.c_str());
    return 1;
  }
  return 0;
}
