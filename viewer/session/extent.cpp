#include "viewer/session/extent.h"

#include <algorithm>

#include <armature/sdk/mesh/measures.h>

namespace armature::viewer {

sdk::Sphere sphere_around(const sdk::Mesh& mesh) {
  const Eigen::AlignedBox3d box = sdk::bounding_box(mesh);
  if (box.isEmpty()) return {Eigen::Vector3d::Zero(), 1};
  sdk::Sphere around{box.center(), 0};
  for (const Eigen::Vector3d& position : mesh.positions)
    around.radius = std::max(around.radius, (position - around.centre).norm());
  return around;
}

sdk::Sphere sphere_around(const sdk::SphereMesh& shape) {
  Eigen::AlignedBox3d box;
  for (const sdk::Sphere& sphere : shape.spheres) {
    const Eigen::Vector3d corner = Eigen::Vector3d::Constant(sphere.radius);
    box.extend(Eigen::AlignedBox3d(sphere.centre - corner, sphere.centre + corner));
  }
  if (box.isEmpty()) return {Eigen::Vector3d::Zero(), 1};
  sdk::Sphere around{box.center(), 0};
  for (const sdk::Sphere& sphere : shape.spheres)
    around.radius = std::max(around.radius, (sphere.centre - around.centre).norm() + sphere.radius);
  return around;
}

sdk::Sphere widened(const sdk::Sphere& sphere, const sdk::Sphere& by) {
  return {sphere.centre, std::max(sphere.radius, (by.centre - sphere.centre).norm() + by.radius)};
}

}  // namespace armature::viewer
