#include <span>

#include <armature/sdk/mesh/components.h>

namespace armature::sdk {

Components find_components(const Mesh& mesh, const Adjacency& adjacency, LinkedBy link) {
  Components result{.of_face = std::vector<std::uint32_t>(mesh.triangles.size(), Components::kNone)};
  std::vector<FaceId> open;
  const auto reach = [&](std::span<const FaceId> faces) {
    for (const FaceId face : faces) {
      if (result.of_face[face.index()] != Components::kNone) continue;
      result.of_face[face.index()] = static_cast<std::uint32_t>(result.count);
      open.push_back(face);
    }
  };
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (result.of_face[i] != Components::kNone || repeats_a_vertex(mesh.triangles[i])) continue;
    const FaceId first(i);
    reach(std::span(&first, 1));
    while (!open.empty()) {
      const FaceId face = open.back();
      open.pop_back();
      if (link == LinkedBy::Vertices)
        for (const VertexId vertex : mesh.triangle(face)) reach(adjacency.faces(vertex));
      else
        for (const EdgeId edge : adjacency.edges(face)) reach(adjacency.faces(edge));
    }
    ++result.count;
  }
  return result;
}

}  // namespace armature::sdk
