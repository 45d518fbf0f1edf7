#include "tools/commands/select/paint.h"

#include <algorithm>
#include <cmath>

#include <armature/sdk/editing/vertex_edits.h>

namespace armature::tools {
namespace {

constexpr sdk::Colour kReference = {214, 40, 40};
constexpr sdk::Colour kMatch = {24, 84, 214};
constexpr double kPalest = 0.25;  // saturation of what is nothing like the reference

sdk::Colour blend(const sdk::Colour& from, const sdk::Colour& to, double share) {
  sdk::Colour colour{};
  for (std::size_t k = 0; k < colour.size(); ++k)
    colour[k] = static_cast<std::uint8_t>(std::lround(from[k] + share * (to[k] - from[k])));
  return colour;
}

}  // namespace

sdk::Mesh painted(const sdk::Mesh& mesh, std::span<const sdk::FaceId> reference, std::span<const sdk::Match> matches) {
  sdk::Mesh result{.positions = mesh.positions, .triangles = mesh.triangles};
  result.face_colours.assign(mesh.triangles.size(), sdk::kPlainColour);
  const auto paint = [&](std::span<const sdk::FaceId> faces, const sdk::Colour& colour) {
    for (const sdk::FaceId face : faces) result.face_colours[face.index()] = colour;
  };
  for (std::size_t i = matches.size(); i-- > 0;) {
    const double share = kPalest + (1 - kPalest) * std::clamp(matches[i].score, 0.0, 1.0);
    paint(matches[i].faces, blend(sdk::kPlainColour, kMatch, share));
  }
  paint(reference, kReference);
  return result;
}

}  // namespace armature::tools
