#include "viewer/scene/shading.h"

#include <cmath>

#include <gtest/gtest.h>

namespace armature::viewer {
namespace {

using Eigen::Vector3d;
using sdk::VertexId;

/// Two unit squares that share the edge x = 0, folded by `fold_rad` there; two triangles each.
sdk::Mesh folded(double fold_rad) {
  sdk::Mesh mesh;
  const double x = std::cos(fold_rad), z = -std::sin(fold_rad);
  mesh.positions = {{-1, 0, 0}, {-1, 1, 0}, {0, 0, 0}, {0, 1, 0}, {x, 0, z}, {x, 1, z}};
  for (const std::array<int, 3>& t : {std::array{0, 2, 3}, {0, 3, 1}, {2, 4, 5}, {2, 5, 3}})
    mesh.triangles.push_back({VertexId(t[0]), VertexId(t[1]), VertexId(t[2])});
  return mesh;
}

TEST(CornerNormals, AreSmoothAcrossAGentleFold) {
  const auto normals = corner_normals(folded(0.4), 0.6);
  const Vector3d between(std::sin(0.2), 0, std::cos(0.2));
  EXPECT_LT((normals[2][0] - between).norm(), 1e-12);  // vertex 2: a right angle on either side of the fold
  EXPECT_LT((normals[0][0] - Vector3d::UnitZ()).norm(), 1e-12);
}

TEST(CornerNormals, KeepASharpFoldSharp) {
  const auto normals = corner_normals(folded(1.2), 0.6);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT((normals[0][k] - Vector3d::UnitZ()).norm(), 1e-12);
    EXPECT_LT((normals[2][k] - Vector3d(std::sin(1.2), 0, std::cos(1.2))).norm(), 1e-12);
  }
}

TEST(CornerNormals, SurviveFacesWithoutArea) {
  sdk::Mesh mesh = folded(0);
  mesh.triangles.push_back({VertexId(0), VertexId(0), VertexId(2)});
  mesh.positions.emplace_back(9, 9, 9);
  mesh.triangles.push_back({VertexId(6), VertexId(6), VertexId(6)});
  const auto normals = corner_normals(mesh, 0.6);
  EXPECT_LT((normals[4][0] - Vector3d::UnitZ()).norm(), 1e-12) << "that of the faces around it";
  EXPECT_TRUE(normals[5][0].isZero());
}

}  // namespace
}  // namespace armature::viewer
