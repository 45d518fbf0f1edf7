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
