#include <algorithm>
#include <cmath>

#include <armature/sdk/spheremesh/extract.h>

#include "sdk/spheremesh/cut_surface.h"
#include "sdk/spheremesh/simplify_within.h"

namespace armature::sdk {
namespace {

// How the tolerance is shared out between the steps that each leave the surface.
constexpr double kThickening = 0.2;  // of parts without thickness, on either side
constexpr double kFine = 0.45;
constexpr double kCutting = 0.4;
constexpr double kSimplifying = 0.85;

}  // namespace

Expected<Mesh> extract_surface(const SphereMesh& shape, const ExtractOptions& options, const Task& task) {
  if (shape.spheres.empty()) return fail("a sphere-mesh without spheres has no surface");
  if (!(options.tolerance >= 1e-5 && options.tolerance <= 0.1))
    return fail("the tolerance is out of range: expected from 1e-5 to 0.1 of the bounding box's diagonal");
  const SpherePieces pieces(shape);
  const double diagonal = (pieces.upper - pieces.lower).norm();
  if (!(diagonal > 0)) return fail("a sphere-mesh of no size has no surface");
  const double tolerance = options.tolerance * diagonal;

  // What is thinner than the finest tetrahedra would slip through them.
  SphereMesh solid = shape;
  double simplifying = kSimplifying * tolerance;
  for (Sphere& s : solid.spheres) {
    if (s.radius >= kThickening * tolerance) continue;
    simplifying = (kSimplifying - kThickening) * tolerance;
    s.radius = kThickening * tolerance;
  }

  task.report("dividing space", 0);
  const SphereMeshTree tree(solid);
  const ConvexUnion bodies(solid);
  const CutOptions cut{.coarse = diagonal / 12,
                       .fine = kFine * tolerance,
                       .finest = 1.5 * kThickening * tolerance,
                       .error = std::min(kCutting * tolerance, simplifying / 2)};
  auto mesh = cut_surface(bodies, tree, cut, task);
  if (!mesh || mesh->triangles.empty()) return mesh;
  return simplify_within(*mesh, tree, bodies, simplifying, task);
}

}  // namespace armature::sdk
