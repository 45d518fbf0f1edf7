#include <numbers>

#include <armature/sdk/mesh/measures.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Vector3d;

constexpr double kExact = 1e-12;  // of unit-sized shapes

TEST(Measures, OfACube) {
  const Mesh cube = surfaces::cube();
  EXPECT_NEAR(surface_area(cube), 6, kExact);
  EXPECT_NEAR(bounding_box_diagonal(cube), std::sqrt(3), kExact);
  EXPECT_EQ(face_normals(cube)[0], Vector3d(0, 0, -1));
  double cells = 0;
  for (const double area : barycentric_areas(cube)) cells += area;
  EXPECT_NEAR(cells, 6, kExact);
}

TEST(Measures, AngleWeightedNormalsOfACubePointAlongItsDiagonalsHoweverItIsCut) {
  const Mesh cube = surfaces::cube();
  const auto normals = vertex_normals(cube);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vector3d diagonal = (cube.positions[i] - Vector3d::Constant(0.5)).normalized();
    EXPECT_LT((normals[i] - diagonal).norm(), kExact);
  }
}

TEST(Measures, NormalsDoNotDependOnTheUnitOfLength) {
  for (const double scale : {1e-200, 1e-3, 1e6, 1e200}) {
    const Mesh sphere = surfaces::icosphere(2, scale);
    const auto normals = vertex_normals(sphere);
    for (std::size_t i = 0; i < normals.size(); ++i)
      EXPECT_LT((normals[i] - sphere.positions[i] / scale).norm(), 0.02) << scale;
  }
}

TEST(Measures, WhatHasNoAreaHasNoNormal) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}};
  mesh.triangles = {surfaces::triangle(0, 1, 2), surfaces::triangle(0, 0, 1)};
  for (const Vector3d& normal : face_normals(mesh)) EXPECT_TRUE(normal.isZero());
  for (const Vector3d& normal : vertex_normals(mesh)) EXPECT_TRUE(normal.isZero());
  EXPECT_EQ(surface_area(mesh), 0);
}

TEST(Measures, ACellHoldsTheVertexTheMidpointsAndTheCentroids) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {6, 0, 0}, {0, 6, 0}};
  mesh.triangles = {surfaces::triangle(0, 1, 2)};
  std::vector<Vector3d> points;
  append_cell_points(mesh, Adjacency(mesh), VertexId(0), points);
  EXPECT_EQ(points, (std::vector<Vector3d>{{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {2, 2, 0}}));
}

}  // namespace
}  // namespace armature::sdk
