#include "tools/evaluation/synthetic_evaluation.h"

#include "tools/evaluation/forest_evaluation.h"
#include "tools/evaluation/statistics.h"

namespace armature::tools {
namespace {

constexpr double kFound_m = 0.10;

struct JointRecord {
  std::vector<double> errors_m;
  std::vector<Detection> detections;
};

bool in_view(const Eigen::Vector3f& joint, const Intrinsics& k) {
  const double u = k.centre_x_px + k.focal_x_px * joint.x() / joint.z();
  const double v = k.centre_y_px + k.focal_y_px * joint.y() / joint.z();
  return u >= 0 && v >= 0 && u < k.width && v < k.height;
}

JointAccuracy summary(JointRecord& record) {
  return {.mean_error_m = mean(record.errors_m),
          .median_error_m = percentile(record.errors_m, 50),
          .p90_error_m = percentile(record.errors_m, 90),
          .average_precision = average_precision(record.detections, record.errors_m.size())};
}

JointAccuracy mean_over(const SyntheticAccuracy& accuracy, std::span<const JointId> joints) {
  JointAccuracy sum;
  const auto share = 1 / static_cast<double>(joints.size());
  for (const JointId id : joints) {
    const JointAccuracy& joint = accuracy.joints[index(id)];
    sum.mean_error_m += share * joint.mean_error_m;
    sum.median_error_m += share * joint.median_error_m;
    sum.p90_error_m += share * joint.p90_error_m;
    sum.average_precision += share * joint.average_precision;
  }
  return sum;
}

}  // namespace

SyntheticAccuracy evaluate_synthetic(SkeletonTracker& tracker, int image_count,
                                     const std::function<void(double)>& progress) {
  SyntheticAccuracy accuracy;
  accuracy.images = image_count;
  std::array<JointRecord, kJointCount> records;
  std::size_t pixels = 0, right = 0;
  for (int i = 0; i < image_count; ++i) {
    const TrainingImage image = synthetic_image(training_seed(0x7FFFFFFFU, static_cast<std::uint64_t>(i)));
    tracker.reset(image.intrinsics);
    const Skeleton& skeleton = tracker.track(
        {.depth_mm = image.depth_mm, .intrinsics = image.intrinsics, .sensor = {}, .host = {}}, image.user);
    for (const ClassifiedPixel& pixel : tracker.votes().pixels) {
      const std::uint8_t truth =
          image.part_of_pixel[pixel.v * static_cast<std::size_t>(image.intrinsics.width) + pixel.u];
      if (truth == kNoPart) continue;
      ++pixels;
      if (index(most_likely_part(pixel)) == truth) ++right;
    }
    for (std::size_t j = 0; j < kJointCount; ++j) {
      if (!in_view(image.joints[j], image.intrinsics)) continue;
      const Joint& found = skeleton.joints[j];
      const auto error_m = static_cast<double>((found.position - image.joints[j]).norm());
      records[j].errors_m.push_back(error_m);
      if (found.state == JointState::Observed) records[j].detections.push_back({found.confidence, error_m < kFound_m});
    }
    progress((i + 1.0) / image_count);
  }
  accuracy.pixels_right = pixels == 0 ? 0 : static_cast<double>(right) / static_cast<double>(pixels);
  std::array<JointId, kJointCount> all{};
  for (std::size_t j = 0; j < kJointCount; ++j) {
    accuracy.joints[j] = summary(records[j]);
    all[j] = static_cast<JointId>(j);
  }
  accuracy.navigation = mean_over(accuracy, kNavigationJoints);
  accuracy.all = mean_over(accuracy, all);
  return accuracy;
}

}  // namespace armature::tools
