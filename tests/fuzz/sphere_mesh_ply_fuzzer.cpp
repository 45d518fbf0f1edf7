#include "tests/fuzz/sphere_mesh_round_trip.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  armature::sdk::check_round_trip(data, size, armature::sdk::SphereMeshFormat::Ply);
  return 0;
}
