// meshoptimizer's simplification, to its end: float quadrics of points, a much simpler problem than ours.
#include <cfloat>
#include <vector>

#include <meshoptimizer.h>

#include "tools/peers/peer.h"

namespace {

std::size_t used_vertices(const unsigned* indices, std::size_t index_count, std::size_t vertex_count) {
  std::vector<char> used(vertex_count, 0);
  for (std::size_t i = 0; i < index_count; ++i) used[indices[i]] = 1;
  std::size_t count = 0;
  for (const char u : used) count += static_cast<std::size_t>(u);
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  const armature::sdk::Mesh mesh = armature::peers::mesh_of_command_line(argc, argv);
  std::vector<float> positions;
  for (const auto& p : mesh.positions) {
    for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(p[axis]));
  }
  std::vector<unsigned> indices;
  for (const auto& triangle : mesh.triangles) {
    for (const auto vertex : triangle) indices.push_back(static_cast<unsigned>(vertex.index()));
  }
  const std::size_t vertices = mesh.positions.size();
  const std::size_t used = used_vertices(indices.data(), indices.size(), vertices);
  armature::peers::report("meshoptimizer", std::vector<unsigned>(indices.size()), [&](std::vector<unsigned>& result) {
    const std::size_t left = meshopt_simplify(result.data(), indices.data(), indices.size(), positions.data(), vertices,
                                              3 * sizeof(float), 0, FLT_MAX, 0, nullptr);
    return used - used_vertices(result.data(), left, vertices);
  });
  return 0;
}
