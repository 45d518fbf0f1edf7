#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>
#include <armature/sdk/mesh/ids.h>
#include <armature/sdk/selection/surface.h>

namespace armature::sdk {

/// How a part lies on a reference.
struct PartFit {
  Eigen::Matrix4d reference_from_part = Eigen::Matrix4d::Identity();  ///< a similarity
  bool mirrored = false;                                              ///< it fits clearly better mirrored
  double residual = 0;  ///< root mean square distance to the planes of the reference
};

/// Where a part begins, where it leads and how large it is.
struct PartFrame {
  /// z leads from the middle of the boundary to that of the area.
  Eigen::Matrix4d world_from_part = Eigen::Matrix4d::Identity();
  double size = 0;  ///< root of the area
};

/// Points with normals, laid out for looking at many at once.
class OrientedPoints {
 public:
  /// Adds one more.
  void add(const Eigen::Vector3d& point, const Eigen::Vector3d& normal);
  /// Where the closest one stands; there must be one.
  [[nodiscard]] std::size_t closest(const Eigen::Vector3d& point) const noexcept;
  [[nodiscard]] Eigen::Vector3d point(std::size_t place) const noexcept { return {x_[place], y_[place], z_[place]}; }
  [[nodiscard]] const Eigen::Vector3d& normal(std::size_t place) const noexcept { return normals_[place]; }

 private:
  static constexpr std::size_t kTogether = 16;
  std::vector<float> x_, y_, z_;  // filled up with infinities to whole groups
  std::vector<Eigen::Vector3d> normals_;
};

/// Of faces of a surface; the identity for none.
[[nodiscard]] PartFrame frame_of(const Surface& surface, std::span<const FaceId> faces);

/// Lays parts onto a reference: boundary onto boundary, axis onto axis, in the best of some turns about it, then by
/// iterated closest points with scale. Thread-safe to use.
class PartRegistration {
 public:
  /// The reference, faces of the surface; not empty. `around` lies beyond its boundary, so that what lies beyond that
  /// of a part finds its like.
  PartRegistration(const Surface& surface, std::span<const FaceId> reference, std::span<const VertexId> around);

  /// The reference's own.
  [[nodiscard]] const PartFrame& frame() const noexcept { return frame_; }
  /// Lays some points of a part onto the reference, which is `scale` times as large.
  [[nodiscard]] PartFit lay(const PartFrame& part, double scale, std::span<const Eigen::Vector3d> points) const;
  /// How far points lie from the planes of the reference, root mean square.
  [[nodiscard]] double residual(const Eigen::Matrix4d& reference_from_part,
                                std::span<const Eigen::Vector3d> points) const;
  /// Lays other points of it closer, from there.
  [[nodiscard]] PartFit refine(const PartFit& start, std::span<const Eigen::Vector3d> points) const;

 private:
  PartFrame frame_;
  OrientedPoints goal_;
};

}  // namespace armature::sdk
