#include <cmath>
#include <string>

#include <armature/sdk/deformation/sphere_move.h>

namespace armature::sdk {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Expected<void> check(const SphereMove& move, std::size_t spheres) {
  for (std::size_t k = 0; k < move.spheres.size(); ++k)
    if (!move.spheres[k].valid() || move.spheres[k].index() >= spheres)
      return fail("spheres[" + std::to_string(k) + "]: expected a sphere of the level, 0 to " +
                  std::to_string(spheres - 1) +
                  (move.spheres[k].valid() ? ", found " + std::to_string(move.spheres[k].index()) : std::string()));
  if (!move.translate.allFinite()) return fail("translate: expected finite numbers");
  if (!move.rotate.allFinite()) return fail("rotate: expected finite numbers");
  if (move.about && !move.about->allFinite()) return fail("about: expected finite numbers");
  if (!(move.scale > 0) || !std::isfinite(move.scale)) return fail("scale: expected a positive number");
  if (move.radius && !(*move.radius >= 0 && std::isfinite(*move.radius)))
    return fail("radius: expected a number that is not negative");
  return {};
}

std::vector<SphereMotion> at_rest(std::span<const Sphere> spheres) {
  std::vector<SphereMotion> motions;
  motions.reserve(spheres.size());
  for (const Sphere& sphere : spheres) motions.push_back({.before = sphere, .after = sphere});
  return motions;
}

void move_spheres(const SphereMove& move, std::span<SphereMotion> motions, const std::vector<bool>& held) {
  std::vector<bool> seen(motions.size(), false);
  std::vector<SphereMotion*> moving;
  Vector3d mean = Vector3d::Zero();
  for (const SphereId sphere : move.spheres) {
    if (seen[sphere.index()]) continue;
    seen[sphere.index()] = true;
    mean += motions[sphere.index()].after.centre;
    moving.push_back(&motions[sphere.index()]);
  }
  if (moving.empty()) return;
  const Vector3d about = move.about.value_or(mean / static_cast<double>(moving.size()));
  const double angle = move.rotate.norm();
  const Quaterniond turn =
      angle > 0 ? Quaterniond(Eigen::AngleAxisd(angle, move.rotate / angle)) : Quaterniond::Identity();
  const bool stays_in_place = angle == 0 && move.scale == 1;
  for (SphereMotion* motion : moving) {
    if (!held.empty() && held[static_cast<std::size_t>(motion - motions.data())]) continue;
    Vector3d& centre = motion->after.centre;
    if (!stays_in_place) centre = about + turn * (move.scale * (centre - about));
    centre += move.translate;
    if (angle > 0) motion->turn = (turn * motion->turn).normalized();
    motion->scale *= move.scale;
    motion->after.radius = move.radius.value_or(move.scale * motion->after.radius);
  }
}

}  // namespace armature::sdk
