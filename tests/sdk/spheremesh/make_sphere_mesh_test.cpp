#include <vector>

#include <armature/sdk/spheremesh/make_sphere_mesh.h>
#include <gtest/gtest.h>

namespace armature::sdk {
namespace {

SpherePair pair(int a, int b) {
  return {SphereId(a), SphereId(b)};
}

SphereTriple triple(int a, int b, int c) {
  return {SphereId(a), SphereId(b), SphereId(c)};
}

SphereMesh make(const std::vector<SpherePair>& edges, const std::vector<SphereTriple>& triangles) {
  return make_sphere_mesh(std::vector<Sphere>(6), edges, triangles);
}

TEST(MakingASphereMesh, SortsAndKeepsEachOnce) {
  const SphereMesh shape = make({pair(5, 4), pair(4, 5), pair(1, 0)}, {triple(3, 2, 1), triple(1, 3, 2)});
  EXPECT_EQ(shape.edges, (std::vector<SpherePair>{pair(0, 1), pair(4, 5)}));
  EXPECT_EQ(shape.triangles, (std::vector<SphereTriple>{triple(1, 2, 3)}));
  EXPECT_EQ(shape.spheres.size(), 6U);
}

TEST(MakingASphereMesh, KeepsNoEdgeOfATriangle) {
  EXPECT_TRUE(make({pair(1, 2), pair(3, 2), pair(3, 1)}, {triple(1, 2, 3)}).edges.empty());
}

TEST(MakingASphereMesh, ATriangleThatNamesASphereTwiceIsAnEdgeAndThriceNothing) {
  const SphereMesh shape = make({pair(3, 3)}, {triple(4, 2, 4), triple(5, 5, 5)});
  EXPECT_EQ(shape.edges, (std::vector<SpherePair>{pair(2, 4)}));
  EXPECT_TRUE(shape.triangles.empty());
}

TEST(MakingASphereMesh, AFlattenedTriangleBesideAWholeOneLeavesNoEdge) {
  EXPECT_TRUE(make({}, {triple(0, 1, 1), triple(0, 1, 2)}).edges.empty());
}

}  // namespace
}  // namespace armature::sdk
