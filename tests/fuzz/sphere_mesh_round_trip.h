#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <armature/sdk/io/sphere_mesh_file.h>

namespace armature::sdk {

/// What the reader of `format` accepts must come back from what is written of it, or the program ends.
inline void check_round_trip(const std::uint8_t* data, std::size_t size, SphereMeshFormat format) {
  const auto shape = parse_sphere_mesh({reinterpret_cast<const char*>(data), size}, format, "fuzz");
  if (!shape) return;
  for (const SphereMeshFormat written : {SphereMeshFormat::Ma, SphereMeshFormat::Ply}) {
    const auto again = parse_sphere_mesh(encode_sphere_mesh(*shape, written), written, "again");
    if (!again || again->spheres.size() != shape->spheres.size() || again->edges != shape->edges ||
        again->triangles != shape->triangles)
      std::abort();
  }
}

}  // namespace armature::sdk
