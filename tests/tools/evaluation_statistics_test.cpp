#include <gtest/gtest.h>

#include "tools/evaluation/statistics.h"

namespace armature::tools {
namespace {

TEST(EvaluationStatistics, PercentilesAreValuesThatOccur) {
  std::vector<double> values = {5, 1, 4, 2, 3};
  EXPECT_EQ(percentile(values, 50), 3);
  EXPECT_EQ(percentile(values, 90), 5);
  EXPECT_EQ(percentile(values, 0), 1);
  std::vector<double> none;
  EXPECT_EQ(percentile(none, 50), 0);
}

TEST(EvaluationStatistics, CorrelationIgnoresOffsetAndScaleAndIsZeroForAConstant) {
  const std::vector<double> a = {1, 2, 3, 4};
  const std::vector<double> twice = {12, 14, 16, 18};
  const std::vector<double> reversed = {4, 3, 2, 1};
  const std::vector<double> constant = {7, 7, 7, 7};
  EXPECT_NEAR(correlation(a, twice), 1, 1e-12);
  EXPECT_NEAR(correlation(a, reversed), -1, 1e-12);
  EXPECT_EQ(correlation(a, constant), 0);
}

TEST(EvaluationStatistics, SlopeIsOfTheSecondOverTheFirst) {
  const std::vector<double> x = {1, 2, 3, 4}, y = {12, 14, 16, 18}, constant = {7, 7, 7, 7};
  EXPECT_NEAR(slope(x, y), 2, 1e-12);
  EXPECT_EQ(slope(constant, y), 0);
}

TEST(EvaluationStatistics, AveragePrecisionRewardsConfidenceInWhatIsRight) {
  std::vector<Detection> sure_of_the_right_one = {{0.2, false}, {0.9, true}};
  std::vector<Detection> sure_of_the_wrong_one = {{0.9, false}, {0.2, true}};
  EXPECT_NEAR(average_precision(sure_of_the_right_one, 1), 1, 1e-12);
  EXPECT_NEAR(average_precision(sure_of_the_wrong_one, 1), 0.5, 1e-12);
  EXPECT_NEAR(average_precision(sure_of_the_right_one, 2), 0.5, 1e-12);  // one was never found
  EXPECT_EQ(average_precision(sure_of_the_right_one, 0), 0);
}

}  // namespace
}  // namespace armature::tools
