#include <Eigen/Geometry>
#include <armature/sdk/expansion/component_index.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;

/// A wedge without any symmetry.
Mesh wedge(int cuts = 0) {
  Mesh mesh =
      surfaces::mesh_of({{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0.4, 0.3, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  for (int i = 0; i < cuts; ++i) {
    const Mesh whole = mesh;
    mesh.triangles.clear();
    for (const auto& [a, b, c] : whole.triangles) {  // each into three, around its middle
      const VertexId middle(mesh.positions.size());
      mesh.positions.emplace_back((whole.position(a) + whole.position(b) + whole.position(c)) / 3);
      mesh.triangles.insert(mesh.triangles.end(), {{a, b, middle}, {b, c, middle}, {c, a, middle}});
    }
  }
  return mesh;
}

Mesh moved(Mesh mesh, const Matrix4d& T) {
  for (Vector3d& p : mesh.positions) p = (T * p.homogeneous()).head<3>();
  return T.determinant() < 0 ? surfaces::inside_out(std::move(mesh)) : mesh;
}

Matrix4d motion(const Vector3d& axis, double angle, double scale, const Vector3d& shift) {
  Eigen::Affine3d T = Eigen::Translation3d(shift) * Eigen::AngleAxisd(angle, axis.normalized()) * Eigen::Scaling(scale);
  return T.matrix();
}

Expansion expand(const Mesh& mesh, int face) {
  const Adjacency adjacency(mesh);
  const auto index = ComponentIndex::build(mesh, adjacency);
  EXPECT_TRUE(index);
  const auto expansion = index->expand(FaceId(face));
  EXPECT_TRUE(expansion);
  return *expansion;
}

TEST(ComponentIndex, AClickSelectsAComponent) {
  const Mesh mesh = surfaces::together(surfaces::cube(), surfaces::moved(wedge(), {5, 0, 0}));
  const Adjacency adjacency(mesh);
  const auto index = ComponentIndex::build(mesh, adjacency);
  ASSERT_TRUE(index);
  EXPECT_EQ(index->size(), 2);
  EXPECT_EQ(*index->select(FaceId(13)), (std::vector{FaceId(12), FaceId(13), FaceId(14), FaceId(15)}));
  EXPECT_FALSE(index->select(FaceId(16)));
}

TEST(ComponentIndex, CopiesComeFirstWithTheirMotion) {
  const Matrix4d there = motion({1, 2, 3}, 1.2, 1.7, {9, 1, 0});
  Mesh mesh = surfaces::together(wedge(), moved(wedge(), there));
  mesh = surfaces::together(mesh, surfaces::moved(surfaces::cube(), {-9, 0, 0}));
  const Expansion expansion = expand(mesh, 0);
  ASSERT_EQ(expansion.size(), 2);
  const Match& best = expansion.first(1)[0];
  EXPECT_EQ(best.faces.front(), FaceId(4));
  EXPECT_NEAR(best.score, 1, 1e-5);
  EXPECT_FALSE(best.mirrored);
  EXPECT_LT((best.reference_from_match - there.inverse()).norm(), 1e-9) << best.reference_from_match;
  EXPECT_LT(expansion.first(2)[1].score, 0.9);
}

TEST(ComponentIndex, FindsWhatIsLikeAComponentOfAnotherMesh) {
  const Matrix4d there = motion({1, 2, 3}, 1.2, 1.7, {9, 1, 0});
  const Mesh other = surfaces::together(surfaces::cube(), wedge());
  const Mesh mesh = surfaces::together(moved(wedge(), there), surfaces::cube());
  const auto of = ComponentIndex::build(other, Adjacency(other)).value();
  const auto index = ComponentIndex::build(mesh, Adjacency(mesh)).value();
  const auto expansion = index.expand(of, FaceId(12));
  ASSERT_TRUE(expansion);
  EXPECT_EQ(expansion->reference(), *of.select(FaceId(12)));
  ASSERT_EQ(expansion->size(), 2U);
  const auto matches = expansion->first(2);
  EXPECT_EQ(matches[0].faces, *index.select(FaceId(0)));
  EXPECT_GT(matches[0].score, 0.999);
  EXPECT_LT((matches[0].reference_from_match * there - Matrix4d::Identity()).norm(), 1e-9);
  EXPECT_LT(matches[1].score, 0.9);
  EXPECT_FALSE(index.expand(of, FaceId(16)));
}

TEST(ComponentIndex, TheSameShapeInOtherTrianglesIsFoundByItsAxes) {
  const Matrix4d there = motion({1, -1, 0.5}, 2.5, 0.5, {9, 1, 0});
  const Expansion expansion = expand(surfaces::together(wedge(), moved(wedge(2), there)), 0);
  const Match& match = expansion.first(1)[0];
  EXPECT_GT(match.score, 0.98);
  EXPECT_FALSE(match.mirrored);
  EXPECT_LT((match.reference_from_match - there.inverse()).norm(), 0.05) << match.reference_from_match;
}

TEST(ComponentIndex, MirrorImagesAreFoundAndSaid) {
  Matrix4d there = motion({0, 1, 1}, 0.7, 1, {0, 8, 0});
  there.col(0) *= -1;
  for (const int cuts : {0, 2}) {
    const Expansion expansion = expand(surfaces::together(wedge(), moved(wedge(cuts), there)), 0);
    const Match& match = expansion.first(1)[0];
    EXPECT_TRUE(match.mirrored);
    EXPECT_NE(match.reason.find("mirrored"), std::string::npos);
    EXPECT_LT((match.reference_from_match - there.inverse()).norm(), 0.05) << match.reference_from_match;
  }
}

TEST(ComponentIndex, ComponentsWithoutAreaAreRejectedAndFacesWithoutEdgesRefused) {
  Mesh mesh = surfaces::together(wedge(), surfaces::mesh_of({{9, 0, 0}, {9, 1, 0}, {9, 2, 0}}, {{0, 1, 2}, {0, 0, 1}}));
  const Expansion expansion = expand(mesh, 0);
  EXPECT_EQ(expansion.size(), 0);
  ASSERT_EQ(expansion.rejected().size(), 1);
  EXPECT_EQ(expansion.rejected()[0].face, FaceId(4));
  const Adjacency adjacency(mesh);
  EXPECT_FALSE(ComponentIndex::build(mesh, adjacency)->expand(FaceId(5)));
  EXPECT_EQ(expand(mesh, 4).size(), 0);
}

}  // namespace
}  // namespace armature::sdk
