#pragma once

#include <cstdint>
#include <filesystem>

namespace armature::sdk {

/// How a mesh is laid out in a file.
enum class MeshFormat : std::uint8_t {
  Off,    ///< Object File Format: ASCII, with or without colours
  Obj,    ///< Wavefront OBJ: positions, colours of vertices and faces; the rest of it is skipped
  Ply,    ///< Stanford PLY: ASCII or binary, either byte order
  Stl,    ///< stereolithography: ASCII or binary; equal corners become one vertex
  Xyz,    ///< points: lines X Y Z NX NY NZ (.xyz, .xyzn, .pwn), a line with their number before them or none
  Other,  ///< whatever assimp makes of it; the order of its vertices is not kept
};

/// The format that a file's extension stands for, in either case.
[[nodiscard]] MeshFormat mesh_format_of(const std::filesystem::path& path);

}  // namespace armature::sdk
