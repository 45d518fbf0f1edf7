#pragma once

#include <span>
#include <variant>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/expansion/expansion.h>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/selection/surface.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// Along the normals, by a distance on the reference.
struct DisplaceEdit {
  double distance = 0;  ///< outward, in the model's unit
};
/// Implicit smoothing over a length on the reference.
struct SmoothEdit {
  double length = 0;  ///< in the model's unit
};
/// A handle at a point of the reference is moved and draws the region with it: all where it is, which is a disc of a
/// quarter of the region's radius that lets go towards its rim, nothing at the boundary, harmonic in between.
struct HandleEdit {
  Eigen::Vector3d point;  ///< on the reference
  Eigen::Vector3d by;     ///< how far it is moved
};
/// A colour.
struct PaintEdit {
  Colour colour = {};   ///< of the vertices
  double strength = 1;  ///< 0 to 1; beyond, as at the nearer of them
};
/// The match takes the shape of the reference.
struct CopyEdit {};
/// What is done to a region: the edit itself, not its result (thesis, section 5.6.2).
using RegionEdit = std::variant<DisplaceEdit, SmoothEdit, HandleEdit, PaintEdit, CopyEdit>;

/// How edits end at the boundaries of regions.
struct TransportOptions {
  /// An edit grows from nothing at the boundary to all of it at so much of the way to the innermost vertex, by length
  /// along edges; 0 to 1. Regions without a boundary are edited throughout.
  double blend = 0.5;
};

/// Edits the reference, and every match in the same way: lengths by the size of the match, places and directions by its
/// motion onto the reference, mirrored where it is mirrored. A vertex in several regions takes the first. Nothing
/// outside of the regions moves. Refused for a region without faces or with faces that are not there, and a motion that
/// cannot be undone; no matches at all are fine.
[[nodiscard]] Expected<Mesh> transported(const Surface& surface, std::span<const FaceId> reference,
                                         std::span<const Match> matches, const RegionEdit& edit,
                                         const TransportOptions& options = {}, const Task& task = {});

/// Makes like regions more alike: each vertex goes towards the mean of the places that the regions have there once they
/// are laid onto one another, all the way for an amount of 1; a negative amount exaggerates what sets them apart
/// (thesis, section 5.6.3). Otherwise as `transported()`.
[[nodiscard]] Expected<Mesh> made_alike(const Surface& surface, std::span<const FaceId> reference,
                                        std::span<const Match> matches, double amount,
                                        const TransportOptions& options = {}, const Task& task = {});

}  // namespace armature::sdk
