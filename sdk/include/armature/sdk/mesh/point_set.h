#pragma once

#include <vector>

#include <Eigen/Core>
#include <armature/sdk/error.h>
#include <armature/sdk/mesh/mesh.h>

namespace armature::sdk {

/// Points of a surface that need not be joined. Any length unit, any frame.
struct PointSet {
  std::vector<Eigen::Vector3d> positions = {};  ///< one a point
  std::vector<Eigen::Vector3d> normals = {};    ///< outward, of unit length; zero where it is not known
  std::vector<double> areas = {};               ///< that each stands for; empty: all the same
  std::vector<Colour> colours = {};             ///< one a point, or empty
};

/// The vertices of a mesh with their normals and barycentric cells; vertices on no face have neither.
[[nodiscard]] PointSet point_set_of(const Mesh& mesh);

/// What is wrong with a point set, in one line that names the first point; nothing if there are one position and one
/// normal for each point, all are finite, areas and colours are there for all or none, and areas are not negative.
[[nodiscard]] Expected<void> validate(const PointSet& points);

/// How far points lie apart: the median distance to the nearest other one at another place. 0 where there is none.
[[nodiscard]] double spacing(const PointSet& points);

}  // namespace armature::sdk
