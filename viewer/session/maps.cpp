#include "viewer/session/maps.h"

#include <algorithm>
#include <cmath>

#include <armature/sdk/expansion/patch_map.h>
#include <armature/sdk/mesh/components.h>
#include <armature/sdk/mesh/curvature.h>
#include <armature/sdk/selection/part_model.h>

namespace armature::viewer {
namespace {

/// Spreads values over [0, 1] by their ranks' ends: the lowest and highest fiftieth are cut off.
std::vector<float> spread(const std::vector<double>& values) {
  std::vector<double> sorted = values;
  const std::size_t cut = sorted.size() / 50;
  const auto at = [&](std::size_t place) {
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(place), sorted.end());
    return sorted[place];
  };
  if (sorted.empty()) return {};
  const double low = at(cut);
  const double high = at(sorted.size() - 1 - cut);
  std::vector<float> result;
  for (const double value : values)
    result.push_back(high > low ? static_cast<float>(std::clamp((value - low) / (high - low), 0.0, 1.0)) : 0.5F);
  return result;
}

/// Between two colours.
sdk::Colour mixed(const sdk::Colour& a, const sdk::Colour& b, double share) {
  sdk::Colour result{};
  for (std::size_t c = 0; c < 3; ++c)
    result[c] = static_cast<std::uint8_t>(std::lround((1 - share) * a[c] + share * b[c]));
  return result;
}

/// Dark blue over green to yellow: lightness rises throughout (after viridis).
sdk::Colour ramp(double value) {
  static constexpr std::array<sdk::Colour, 6> kStops = {
      {{72, 40, 120}, {62, 83, 140}, {38, 130, 142}, {53, 183, 121}, {144, 215, 67}, {253, 231, 37}}};
  const double place = std::clamp(value, 0.0, 1.0) * (kStops.size() - 1);
  const auto before = std::min(static_cast<std::size_t>(place), kStops.size() - 2);
  return mixed(kStops[before], kStops[before + 1], place - static_cast<double>(before));
}

/// Colours that neighbours in a list do not share, by the golden angle.
sdk::Colour component_colour(std::size_t component) {
  const double hue = std::fmod(0.61803398875 * static_cast<double>(component) + 0.58, 1.0) * 6;
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue, 6.0);
    return static_cast<std::uint8_t>(std::lround(225 - 105 * std::clamp(std::min(k, 4 - k), 0.0, 1.0)));
  };
  return {channel(5), channel(3), channel(1)};
}

constexpr sdk::Colour kSelected = {214, 88, 62};
constexpr sdk::Colour kDrawn = {240, 158, 62};
constexpr sdk::Colour kLike = {40, 112, 196};

}  // namespace

sdk::Expected<std::vector<float>> compute_map(const MeshShape& shape, MapKind kind,
                                              const std::vector<sdk::FaceId>& reference, const sdk::Task& task) {
  if (kind == MapKind::Curvature) {
    const auto curvatures = sdk::principal_curvatures(shape.mesh, shape.surface.adjacency, task);
    if (!curvatures) return tl::unexpected(curvatures.error());
    std::vector<double> values;
    for (const auto& [k1, k2] : *curvatures) values.push_back(k1 + k2);
    return spread(values);
  }
  if (kind == MapKind::Protrusion) {
    const auto model = shape.parts(task);
    if (!model) return tl::unexpected(model.error());
    const Eigen::VectorXd& factor = (*model)->conformal_factor();
    return spread({factor.begin(), factor.end()});
  }
  const auto ball = sdk::patch_ball(shape.surface, reference);
  if (!ball) return tl::unexpected(ball.error());
  const auto contexts = sdk::PatchContexts::build(shape.surface, ball->radius, task);
  if (!contexts) return tl::unexpected(contexts.error());
  return contexts->similarity_to(contexts->of(ball->centre), task);
}

MeshPaint paint_of(const Model& model, MapKind map) {
  const Selecting& selecting = model.selecting;
  MeshPaint paint{.map = map, .selected = selecting.selection.faces(), .drawn = selecting.drawn};
  if (map != MapKind::None) paint.values = model.values;
  if (selecting.expansion) {
    const auto shown = selecting.expansion->first(selecting.shown);
    paint.like.assign(shown.begin(), shown.end());
  }
  return paint;
}

std::vector<std::array<sdk::Colour, 3>> corner_colours(const sdk::Mesh& mesh, const sdk::Adjacency& adjacency,
                                                       const MeshPaint& paint, const sdk::Colour& plain) {
  std::vector<std::array<sdk::Colour, 3>> colours(mesh.triangles.size(), {plain, plain, plain});
  if (paint.map == MapKind::Components) {
    const auto components = sdk::find_components(mesh, adjacency, sdk::LinkedBy::Edges);
    for (std::size_t f = 0; f < colours.size(); ++f)
      if (components.of_face[f] != sdk::Components::kNone) colours[f].fill(component_colour(components.of_face[f]));
  } else if (!paint.values.empty()) {
    for (std::size_t f = 0; f < colours.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) colours[f][k] = ramp(paint.values[mesh.triangles[f][k].index()]);
  } else if (!mesh.face_colours.empty()) {
    for (std::size_t f = 0; f < colours.size(); ++f) colours[f].fill(mesh.face_colours[f]);
  } else if (!mesh.vertex_colours.empty()) {
    for (std::size_t f = 0; f < colours.size(); ++f)
      for (std::size_t k = 0; k < 3; ++k) colours[f][k] = mesh.vertex_colours[mesh.triangles[f][k].index()];
  }
  const auto tint = [&](sdk::FaceId face, const sdk::Colour& colour, double strength) {
    for (sdk::Colour& corner : colours[face.index()]) corner = mixed(corner, colour, strength);
  };
  // Over a map it is but a tint: both are to be seen. Blue is what maps are, too.
  constexpr double kTint = 0.35, kBlueTint = 0.55;
  const bool plainly = paint.map == MapKind::None;
  // The less alike, the paler: the scores of what is shown spread from faint to full.
  for (const sdk::Match& match : paint.like) {
    const double strength = 0.3 + 0.65 * std::clamp((match.score - 0.5) / 0.5, 0.0, 1.0);
    for (const sdk::FaceId face : match.faces) tint(face, kLike, plainly ? strength : kBlueTint);
  }
  for (const sdk::FaceId face : paint.selected) tint(face, kSelected, plainly ? 0.9 : kTint);
  for (const sdk::FaceId face : paint.drawn) tint(face, kDrawn, 0.8);
  return colours;
}

}  // namespace armature::viewer
