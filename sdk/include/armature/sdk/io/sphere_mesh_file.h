#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <armature/sdk/error.h>
#include <armature/sdk/spheremesh/sphere_mesh.h>
#include <armature/sdk/task.h>

namespace armature::sdk {

/// How a sphere-mesh is laid out in a file.
enum class SphereMeshFormat : std::uint8_t {
  Ma,    ///< Q-MAT's (Li et al. 2015): "nV nE nF", then lines "v x y z r", "e i j", "f i j k", counted from 0
  Ply,   ///< PLY whose vertices have a radius, with elements "edge" (vertex1, vertex2) and "face"
  Urdf,  ///< a robot's link whose collision and visual geometry are the spheres; written only
};

/// The format that a file's extension stands for: .ma, .ply or .urdf, in either case.
[[nodiscard]] std::optional<SphereMeshFormat> sphere_mesh_format_of(const std::filesystem::path& path);

/// Whether a file is to be read as a sphere-mesh and not as a triangle mesh: by its extension, and of PLY by its
/// header, which gives vertices a radius or not. False for a .ply file that cannot be read.
[[nodiscard]] bool holds_sphere_mesh(const std::filesystem::path& path);

/// Reads a sphere-mesh from a .ma or .ply file. Edges that lie on triangles may be listed or not; the result names none
/// of them. Blank lines and comments after '#' are skipped. Refused with the line or byte: a count that does not hold,
/// an index out of range, a coordinate or radius that is not finite, a negative radius, a file without a sphere.
[[nodiscard]] Expected<SphereMesh> read_sphere_mesh(const std::filesystem::path& path, const Task& task = {});

/// The same for the bytes of such a file. `name` stands for the file in messages.
[[nodiscard]] Expected<SphereMesh> parse_sphere_mesh(std::string_view bytes, SphereMeshFormat format,
                                                     std::string_view name, const Task& task = {});

/// Writes a sphere-mesh as .ma, .ply (binary) or .urdf. Numbers in .ma and .ply read back as the same bits; listed are
/// the wire edges alone, so that the header of .ma holds the counts of `edges` and `triangles`. URDF has spheres only:
/// what lies between them, and spheres without a radius, is lost. The file appears once it is complete, or not at all.
[[nodiscard]] Expected<void> write_sphere_mesh(const SphereMesh& shape, const std::filesystem::path& path,
                                               const Task& task = {});

/// The bytes of such a file. `name` is what URDF calls robot and link.
[[nodiscard]] std::string encode_sphere_mesh(const SphereMesh& shape, SphereMeshFormat format,
                                             std::string_view name = "shape");

}  // namespace armature::sdk
