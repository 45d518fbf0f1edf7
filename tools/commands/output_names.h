#pragma once

#include <string>

namespace armature::tools {

/// What is wrong with the name of a mesh to write, for `CLI::Option::check`; empty if nothing is.
[[nodiscard]] std::string wrong_mesh_name(const std::string& path);
/// The same of points with normals.
[[nodiscard]] std::string wrong_points_name(const std::string& path);
/// The same where what is written may be either.
[[nodiscard]] std::string wrong_shape_name(const std::string& path);
/// The same of a sphere-mesh.
[[nodiscard]] std::string wrong_sphere_mesh_name(const std::string& path);

}  // namespace armature::tools
