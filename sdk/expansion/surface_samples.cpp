#include "sdk/expansion/surface_samples.h"

#include <algorithm>
#include <cmath>

#include <armature/sdk/mesh/measures.h>

namespace armature::sdk {

using Eigen::Vector3d;

std::vector<SurfaceSample> samples_of(const Mesh& mesh, std::span<const FaceId> faces, double area) {
  constexpr double kMostCuts = 64;
  std::vector<SurfaceSample> samples;
  samples.reserve(faces.size());
  for (const FaceId face : faces) {
    const Vector3d vector = area_vector(mesh, face);
    const double size = vector.norm();
    if (!(size > 0)) continue;
    const int k = static_cast<int>(std::clamp(std::round(std::sqrt(size / area)), 1.0, kMostCuts));
    const Vector3d& a = mesh.corner(face, 0);
    const Vector3d u = (mesh.corner(face, 1) - a) / k;
    const Vector3d v = (mesh.corner(face, 2) - a) / k;
    const SurfaceSample piece{a, vector / size, size / (k * k), face};
    for (int i = 0; i < k; ++i)
      for (int j = 0; i + j < k; ++j) {
        samples.push_back(piece);
        samples.back().point += (i + 1 / 3.) * u + (j + 1 / 3.) * v;
        if (i + j + 1 == k) continue;
        samples.push_back(piece);
        samples.back().point += (i + 2 / 3.) * u + (j + 2 / 3.) * v;
      }
  }
  return samples;
}

}  // namespace armature::sdk
