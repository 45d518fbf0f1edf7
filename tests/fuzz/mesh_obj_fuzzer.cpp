#include <cstddef>
#include <cstdint>
#include <string_view>

#include <armature/sdk/io/read_mesh.h>

#include "tests/fuzz/check_shape.h"

/// What the reader accepts must hold what every function relies on, and must be safe to analyse.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature::sdk;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  check_shape(parse_mesh_or_points(bytes, MeshFormat::Obj, "fuzz"));
  return 0;
}
