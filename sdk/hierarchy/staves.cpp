#include "sdk/hierarchy/staves.h"

#include <vector>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <armature/sdk/mesh/measures.h>

#include "sdk/mesh/lengths.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLength = 3;       // of a stave, in widths
constexpr double kFacing = 0.5;     // the length of its mean normal, at least
constexpr double kStraight = 0.02;  // the variance of its normals along it, at most

/// Sums over a region of its area, and of its points and normals, and their squares, times that.
struct Moments {
  double area = 0;
  Vector3d x = Vector3d::Zero(), n = Vector3d::Zero();
  Matrix3d xx = Matrix3d::Zero(), nn = Matrix3d::Zero();

  void add(double part, const Vector3d& point, const Vector3d& normal) {
    area += part;
    x += part * point;
    n += part * normal;
    xx += part * point * point.transpose();
    nn += part * normal * normal.transpose();
  }

  [[nodiscard]] bool is_stave() const {
    if (!(area > 0) || n.norm() < kFacing * area) return false;
    const auto variance = [&](const Matrix3d& squares, const Vector3d& sum) {
      return Matrix3d(squares / area - sum * sum.transpose() / (area * area));
    };
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(variance(xx, x));
    const Vector3d along = axes.eigenvectors().col(2);
    return axes.eigenvalues()[2] > kLength * kLength * axes.eigenvalues()[1] &&
           along.dot(variance(nn, n) * along) < kStraight;
  }
};

}  // namespace

double share_of_staves(const Mesh& mesh, std::span<const std::uint32_t> regions) {
  std::vector<std::uint32_t> places(mesh.positions.size(), UINT32_MAX);  // by region
  std::vector<Moments> moments;
  const double unit = unit_near(bounding_box_diagonal(mesh));
  // From a point of the mesh, or digits would cancel.
  const auto place_of = [&](VertexId v) -> Vector3d { return (mesh.position(v) - mesh.positions[0]) / unit; };
  double area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const FaceId face(t);
    const Vector3d& a = mesh.corner(face, 0);
    const Vector3d cross = ((mesh.corner(face, 1) - a) / unit).cross((mesh.corner(face, 2) - a) / unit);
    const double size = cross.norm();
    if (!(size > 0)) continue;
    area += size;
    for (const VertexId corner : mesh.triangles[t]) {
      std::uint32_t& place = places[regions[corner.index()]];
      if (place == UINT32_MAX) {
        place = static_cast<std::uint32_t>(moments.size());
        moments.emplace_back();
      }
      moments[place].add(size / 3, place_of(corner), cross / size);
    }
  }
  double staves = 0;
  for (const Moments& region : moments)
    if (region.is_stave()) staves += region.area;
  return area > 0 ? staves / area : 0;
}

}  // namespace armature::sdk
