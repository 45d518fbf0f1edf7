#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/mesh/mesh.h>

#include "firmware_host/error.h"

namespace armature::tools {

/// Reads the spheres that a user decides for a mesh of so many vertices, a line each: "VERTEX" alone, which stays where
/// it is with radius 0, or "VERTEX X Y Z RADIUS" in the mesh's coordinates. Vertices count from 0 in the order of the
/// mesh's file. What follows '#' is a comment. Fails with file and line.
[[nodiscard]] Expected<std::vector<sdk::PinnedSphere>> read_pins(const std::string& file, std::size_t vertices);

/// Reads a label for each vertex, whole numbers from 0 to 2^32 - 1 a line each. What follows '#' is a comment. Fails
/// with file and line.
[[nodiscard]] Expected<std::vector<std::uint32_t>> read_labels(const std::string& file, std::size_t vertices);

/// A label for each vertex: its colour. Of a mesh whose vertices have colours.
[[nodiscard]] std::vector<std::uint32_t> labels_of_paint(std::span<const sdk::Colour> colours);

}  // namespace armature::tools
