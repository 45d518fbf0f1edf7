#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/adjacency.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// The middle of a face's corners.
[[nodiscard]] Eigen::Vector3d middle(const Mesh& mesh, FaceId face);

/// What hangs together, by edges, with some faces and is wanted; the seeds that are wanted first. In the order in which
/// it is reached.
[[nodiscard]] std::vector<FaceId> flood(const Adjacency& adjacency, std::span<const FaceId> seeds, std::size_t faces,
                                        const std::function<bool(FaceId)>& wanted);

}  // namespace armature::sdk
