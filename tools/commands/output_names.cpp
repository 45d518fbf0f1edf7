#include "tools/commands/output_names.h"

#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/sphere_mesh_file.h>

namespace armature::tools {

std::string wrong_mesh_name(const std::string& path) {
  const auto format = sdk::mesh_format_of(path);
  const bool known = format == sdk::MeshFormat::Ply || format == sdk::MeshFormat::Obj || format == sdk::MeshFormat::Off;
  return known ? "" : path + ": expected a name that ends in .ply, .obj or .off";
}

std::string wrong_points_name(const std::string& path) {
  const auto format = sdk::mesh_format_of(path);
  const bool known = format == sdk::MeshFormat::Ply || format == sdk::MeshFormat::Obj || format == sdk::MeshFormat::Xyz;
  return known ? "" : path + ": points are written as .ply, .obj or .xyz";
}

std::string wrong_shape_name(const std::string& path) {
  return wrong_points_name(path).empty() ? "" : wrong_mesh_name(path);
}

std::string wrong_sphere_mesh_name(const std::string& path) {
  return sdk::sphere_mesh_format_of(path) ? "" : path + ": expected a name that ends in .ma, .ply or .urdf";
}

}  // namespace armature::tools
