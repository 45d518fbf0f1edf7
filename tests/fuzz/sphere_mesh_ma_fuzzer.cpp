#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <armature/sdk/io/sphere_mesh_file.h>

/// What the reader accepts must come back from what is written of it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature::sdk;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto shape = parse_sphere_mesh(bytes, SphereMeshFormat::Ma, "fuzz");
  if (!shape) return 0;
  for (const SphereMeshFormat format : {SphereMeshFormat::Ma, SphereMeshFormat::Ply}) {
    const auto again = parse_sphere_mesh(encode_sphere_mesh(*shape, format), format, "again");
    if (!again || again->spheres.size() != shape->spheres.size() || again->edges != shape->edges ||
        again->triangles != shape->triangles)
      std::abort();
  }
  return 0;
}
