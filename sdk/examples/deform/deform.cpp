// Lifts one of a few spheres of a shape, turns one of more, and prints the session, which can be replayed.
//
// usage: bend IN.obj OUT.obj

#include <cstdio>

#include <armature/sdk/deformation/session.h>
#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>

namespace sdk = armature::sdk;

namespace {

sdk::Expected<void> bend(const char* in, const char* out) {
  const auto mesh = sdk::read_mesh(in);
  if (!mesh) return tl::unexpected(mesh.error());
  const auto built = sdk::build_hierarchy(*mesh);
  if (!built) return tl::unexpected(built.error());
  auto session = sdk::DeformationSession::start(*mesh, built->hierarchy, 4);
  if (!session) return tl::unexpected(session.error());
  const double length = session->shape().spheres[0].radius;
  const auto done = session->move({.spheres = {sdk::SphereId(0)}, .translate = {0, 0, length}})
                        .and_then([&] { return session->go_to(12); })
                        .and_then([&] {
                          return session->move({.spheres = {sdk::SphereId(5)}, .rotate = {0, 0.5, 0}});
                        });
  if (!done) return done;
  std::printf("%s", session->text().c_str());
  sdk::Mesh deformed = *mesh;
  deformed.positions.assign(session->positions().begin(), session->positions().end());
  return sdk::write_mesh(deformed, out);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: bend IN.obj OUT.obj\n");
    return 2;
  }
  if (const auto done = bend(argv[1], argv[2]); !done) {
    std::fprintf(stderr, "bend: %s\n", done.error().message.c_str());
    return 1;
  }
  return 0;
}
