#pragma once

#include <cstddef>
#include <vector>

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/components.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Whether the two faces of every edge that has two walk it in opposite directions, so that they agree on what is
/// outside. Edges of three or more faces are not looked at.
[[nodiscard]] bool is_oriented(const Mesh& mesh, const Adjacency& adjacency);

/// Whether turning faces over could make it so: false for a Moebius strip.
[[nodiscard]] bool is_orientable(const Mesh& mesh, const Adjacency& adjacency);

/// The volume that each component encloses, by its number; negative where its faces point inward. Of a component that
/// is not closed: of the cone over it from its centroid.
[[nodiscard]] std::vector<double> signed_volumes(const Mesh& mesh, const Components& components);

/// Which faces, by FaceId, must be turned over for all to point outward. Faces linked by edges that have two faces are
/// made to agree with the larger part of their area, unless they have one side only. Then a shell (a component linked
/// by edges) of negative volume is turned over together with all that lies within it, unless it lies within another: an
/// inner shell keeps its relation to the shell around it, so that cavities stay cavities. Open shells are turned where
/// they are bent clearly.
[[nodiscard]] Expected<std::vector<bool>> find_inward_faces(const Mesh& mesh, const Adjacency& adjacency,
                                                            const Task& task = {});

/// Turns over what `find_inward_faces()` names, by exchanging second and third corners. Returns how many faces that
/// were. Unchanged when stopped.
[[nodiscard]] Expected<std::size_t> orient_outward(Mesh& mesh, const Task& task = {});

}  // namespace armature::sdk
