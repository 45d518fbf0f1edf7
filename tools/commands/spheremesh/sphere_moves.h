#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <armature/sdk/deformation/sphere_move.h>

#include "firmware_host/error.h"

namespace armature::tools {

/// Reads moves of spheres from JSON, for a level of so many: an array of
/// {"spheres":[i,...],"translate":[x,y,z],"rotate":[ax,ay,az],"about":[x,y,z],"scale":s,"radius":r}, of which all but
/// the spheres may be left out. Refused in one line with the place: what is not JSON, keys that are unknown or there
/// twice, values of the wrong kind, numbers that are not finite, spheres that are not there. `name` stands for the file
/// in messages.
[[nodiscard]] Expected<std::vector<sdk::SphereMove>> parse_sphere_moves(std::string_view bytes, std::string_view name,
                                                                        std::size_t spheres);

/// The same of a file.
[[nodiscard]] Expected<std::vector<sdk::SphereMove>> read_sphere_moves(const std::string& file, std::size_t spheres);

}  // namespace armature::tools
