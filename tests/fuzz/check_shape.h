#pragma once

#include <cstdlib>
#include <variant>

#include <armature/sdk/hierarchy/build.h>
#include <armature/sdk/io/read_mesh.h>
#include <armature/sdk/io/write_mesh.h>
#include <armature/sdk/mesh/report.h>

/// What a reader accepts must hold what every function relies on, and be safe to analyse; points must be safe to
/// decimate, and come back from a file.
inline void check_shape(const armature::sdk::Expected<armature::sdk::MeshOrPoints>& read) {
  using namespace armature::sdk;
  if (!read) return;
  if (const auto* mesh = std::get_if<Mesh>(&*read)) {
    if (!validate(*mesh) || !analyse(*mesh)) std::abort();
    return;
  }
  const auto& points = std::get<PointSet>(*read);
  if (points.positions.empty() || !validate(points)) std::abort();
  const auto bytes = encode_points(points, MeshFormat::Xyz);
  if (!bytes || !parse_mesh_or_points(*bytes, MeshFormat::Xyz, "fuzz")) std::abort();
  if (const auto build = build_hierarchy(points); build && build->hierarchy.leaf_count() != points.positions.size())
    std::abort();
}
