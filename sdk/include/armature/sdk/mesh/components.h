#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// What makes two faces hang together.
enum class LinkedBy : std::uint8_t {
  Vertices,  ///< a vertex in common
  Edges,     ///< an edge in common
};

/// The parts of a mesh that hang together, numbered by their first faces. Vertices that no face uses belong to none.
struct Components {
  static constexpr std::uint32_t kNone = 0xFFFF'FFFF;  ///< of a face that names a vertex twice
  std::vector<std::uint32_t> of_face = {};             ///< by FaceId
  std::size_t count = 0;                               ///< of the parts
};

/// Finds the parts. Faces that name a vertex twice are left out, as `Adjacency` does.
[[nodiscard]] Components find_components(const Mesh& mesh, const Adjacency& adjacency, LinkedBy link);

}  // namespace armature::sdk
