#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/mesh/report.h>

/// What the reader accepts must hold what every function relies on, and must be safe to analyse.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace armature::sdk;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto mesh = parse_mesh(bytes, MeshFormat::Ply, "fuzz");
  if (mesh && (!validate(*mesh) || !analyse(*mesh))) std::abort();
  return 0;
}
