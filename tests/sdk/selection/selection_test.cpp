#include <limits>

#include <armature/sdk/selection/selection.h>
#include <armature/sdk/selection/surface.h>
#include <gtest/gtest.h>

#include "tests/sdk/mesh/surfaces.h"

namespace armature::sdk {
namespace {

std::vector<FaceId> faces(std::initializer_list<int> numbers) {
  std::vector<FaceId> result;
  for (const int number : numbers) result.emplace_back(number);
  return result;
}

TEST(Selection, AddsSubtractsAndIntersectsFacesInAnyOrder) {
  Selection selection(faces({5, 1, 5, 3}));
  EXPECT_EQ(selection.faces(), faces({1, 3, 5}));
  selection.combine(faces({4, 3}), Combine::Add);
  EXPECT_EQ(selection.faces(), faces({1, 3, 4, 5}));
  selection.combine(faces({9, 1}), Combine::Subtract);
  EXPECT_EQ(selection.faces(), faces({3, 4, 5}));
  selection.combine(faces({9, 4, 5}), Combine::Intersect);
  EXPECT_EQ(selection.faces(), faces({4, 5}));
  EXPECT_TRUE(selection.contains(FaceId(4)));
  EXPECT_FALSE(selection.contains(FaceId(3)));
}

TEST(Selection, EveryStepCanBeUndoneAndRedoneUntilAnotherIsTaken) {
  Selection selection;
  selection.combine(faces({1, 2}), Combine::Replace);
  selection.combine(faces({2}), Combine::Subtract);
  selection.combine(faces({7}), Combine::Replace);
  EXPECT_TRUE(selection.undo());
  EXPECT_EQ(selection.faces(), faces({1}));
  EXPECT_TRUE(selection.undo());
  EXPECT_EQ(selection.faces(), faces({1, 2}));
  EXPECT_TRUE(selection.redo());
  EXPECT_EQ(selection.faces(), faces({1}));
  selection.combine(faces({8}), Combine::Add);
  EXPECT_FALSE(selection.redo());
  EXPECT_TRUE(selection.undo() && selection.undo() && selection.undo());
  EXPECT_TRUE(selection.faces().empty());
  EXPECT_FALSE(selection.undo());
}

TEST(Selection, CountsItsPieces) {
  // A strip of four triangles, each beside the next.
  Mesh mesh;
  for (int i = 0; i < 6; ++i) mesh.positions.emplace_back(i / 2, i % 2, 0);
  for (std::size_t i = 0; i < 4; ++i) mesh.triangles.push_back({VertexId(i), VertexId(i + 1), VertexId(i + 2)});
  const Adjacency adjacency(mesh);
  const auto pieces = [&](const std::vector<FaceId>& faces) { return count_pieces(adjacency, faces); };
  EXPECT_EQ(pieces({}), 0U);
  EXPECT_EQ(pieces({FaceId(0), FaceId(1), FaceId(2), FaceId(3)}), 1U);
  EXPECT_EQ(pieces({FaceId(0), FaceId(1), FaceId(3)}), 2U);
  EXPECT_EQ(pieces({FaceId(0), FaceId(2)}), 2U) << "a vertex in common is not enough";
}

TEST(ProjectStroke, GoesToTheSurfaceAndRefusesWhatIsFarFromIt) {
  const Mesh sphere = surfaces::icosphere(3);
  const Surface surface(sphere);
  const auto near = project_stroke(surface, {{0, 0, 1.1}, {0.05, 0, 1.05}}, "stroke 0");
  ASSERT_TRUE(near);
  EXPECT_NEAR((*near)[0].point.norm(), 1, 0.02);
  const auto far = project_stroke(surface, {{0, 0, 1}, {0, 0, 1.3}}, "stroke 0");
  ASSERT_FALSE(far);
  EXPECT_NE(far.error().message.find("stroke 0, point 1"), std::string::npos) << far.error().message;
  EXPECT_FALSE(project_stroke(surface, {{std::numeric_limits<double>::quiet_NaN(), 0, 0}}, "stroke 0"));
}

}  // namespace
}  // namespace armature::sdk
