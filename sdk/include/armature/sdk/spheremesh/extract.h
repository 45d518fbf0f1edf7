#pragma once

#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How closely an extracted mesh follows its sphere-mesh.
struct ExtractOptions {
  /// How far the mesh may leave the outer surface and the surface the mesh, as a part of the diagonal of the bounding
  /// box of the union. From 1e-5 to 0.1.
  double tolerance = 1e-3;
};

/// The outer surface of a sphere-mesh as a triangle mesh: closed, manifold, oriented outwards, without the closed voids
/// inside, in large triangles where the surface is flat and sharp along its creases ("closing the loop", thesis,
/// section 4.9).
///
/// Space is divided into tetrahedra, halved where the surface passes until what they cut out is within the tolerance;
/// conforming tetrahedra cut out a closed manifold that nowhere runs through itself, whatever the signs at their
/// corners. What spans a cleft between two bodies is sunk to their crease. The mesh is then simplified by quadrics of
/// the exact tangent planes, which puts vertices onto creases and corners; each step is taken only if all of the new
/// triangles stay within the tolerance of the surface, points of the surface that lie close together within it of the
/// mesh, and no triangle runs through another. So all of the mesh is within the tolerance; of the surface, all but the
/// walls of clefts and gaps that are narrower than the tolerance. Parts thinner than 0.4 tolerances are thickened to
/// that, and voids whose way out is narrower than a cell of OuterSurface's grid count as closed, as they do there.
/// Refused: a sphere-mesh without spheres or of no size, and a tolerance that would take more than a few million
/// tetrahedra.
[[nodiscard]] Expected<Mesh> extract_surface(const SphereMesh& shape, const ExtractOptions& options = {},
                                             const Task& task = {});

}  // namespace armature::sdk
