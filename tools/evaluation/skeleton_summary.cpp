#include "tools/evaluation/skeleton_summary.h"

#include <algorithm>
#include <numbers>

#include "tools/evaluation/statistics.h"

namespace armature::tools {
namespace {

constexpr float kFound_m = 0.10F;
constexpr double kDegrees = 180 / std::numbers::pi;

/// The samples of one joint.
struct JointRecord {
  std::vector<double> errors_m;
  std::vector<Detection> detections;
  std::size_t truths = 0;

  void add(const JointSample& sample) {
    ++truths;
    if (!sample.given) return;
    errors_m.push_back(static_cast<double>(sample.error_m));
    detections.push_back({static_cast<double>(sample.confidence), sample.error_m < kFound_m});
  }
  [[nodiscard]] JointAccuracy accuracy() {
    return {.mean_error_m = mean(errors_m),
            .median_error_m = percentile(errors_m, 50),
            .p90_error_m = percentile(errors_m, 90),
            .average_precision = average_precision(detections, truths)};
  }
};

/// The samples of all joints.
class JointRecords {
 public:
  void add(const JointSample& sample) {
    records_[index(sample.joint)].add(sample);
    ++samples_;
    given_ += sample.given ? 1 : 0;
  }
  [[nodiscard]] std::size_t samples() const { return samples_; }
  [[nodiscard]] double share_given() const {
    return samples_ == 0 ? 0 : static_cast<double>(given_) / static_cast<double>(samples_);
  }
  [[nodiscard]] std::array<JointAccuracy, kJointCount> joints() {
    std::array<JointAccuracy, kJointCount> out;
    for (std::size_t j = 0; j < kJointCount; ++j) out[j] = records_[j].accuracy();
    return out;
  }
  /// The mean over those joints that were ever inside the image.
  [[nodiscard]] JointAccuracy mean_over(std::span<const JointId> ids,
                                        const std::array<JointAccuracy, kJointCount>& joints) const {
    JointAccuracy sum;
    double count = 0;
    for (const JointId id : ids) {
      if (records_[index(id)].truths == 0) continue;
      const JointAccuracy& joint = joints[index(id)];
      ++count;
      sum.mean_error_m += joint.mean_error_m;
      sum.median_error_m += joint.median_error_m;
      sum.p90_error_m += joint.p90_error_m;
      sum.average_precision += joint.average_precision;
    }
    if (count == 0) return sum;
    return {sum.mean_error_m / count, sum.median_error_m / count, sum.p90_error_m / count,
            sum.average_precision / count};
  }

 private:
  std::array<JointRecord, kJointCount> records_;
  std::size_t samples_ = 0, given_ = 0;
};

std::array<JointId, kJointCount> all_joints() {
  std::array<JointId, kJointCount> all{};
  for (std::size_t j = 0; j < kJointCount; ++j) all[j] = static_cast<JointId>(j);
  return all;
}

AngleAccuracy accuracy_of(std::vector<double>& errors_rad) {
  return {kDegrees * mean(errors_rad), kDegrees * percentile(errors_rad, 95)};
}

double share(int part, int whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / whole;
}

}  // namespace

SkeletonSummary summarise(const std::vector<Scene>& scenes, std::span<const SceneRecord> records, System system,
                          const std::function<bool(const Scene&)>& wanted) {
  SkeletonSummary out;
  JointRecords joints;
  PerMotion<std::vector<double>> motions;
  std::vector<double> motion, frame_us;
  int tracked = 0, standing = 0;
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    if (!wanted(scenes[i])) continue;
    const SystemRecord& record = records[i][system];
    ++out.scenes;
    out.frames += record.frames;
    tracked += record.tracked;
    out.rest_frames += record.rest_frames;
    standing += record.standing;
    out.swaps += record.swaps;
    for (const JointSample& sample : record.joints) joints.add(sample);
    for (const MotionSample& sample : record.motions) {
      motions[index(sample.motion)].push_back(static_cast<double>(sample.error_rad));
      motion.push_back(static_cast<double>(sample.error_rad));
    }
    frame_us.insert(frame_us.end(), record.frame_us.begin(), record.frame_us.end());
  }
  out.frames_tracked = share(tracked, out.frames);
  out.joints_given = joints.share_given();
  out.joints = joints.joints();
  out.navigation = joints.mean_over(kNavigationJoints, out.joints);
  out.all = joints.mean_over(all_joints(), out.joints);
  for (std::size_t m = 0; m < kMotionCount; ++m) out.motions[m] = accuracy_of(motions[m]);
  out.motion = accuracy_of(motion);
  out.at_rest = share(standing, out.rest_frames);
  out.p50_us = percentile(frame_us, 50);
  out.p99_us = percentile(frame_us, 99);
  return out;
}

SkeletonSummary summarise(const std::vector<Scene>& scenes, std::span<const SceneRecord> records, System system) {
  return summarise(scenes, records, system, [](const Scene&) { return true; });
}

std::vector<DistanceRow> by_distance(std::span<const SceneRecord> records, System system) {
  constexpr float kNearest_m = 1.5F, kStep_m = 0.25F;
  constexpr int kSteps = 8;  // nearer and farther count with the first and the last
  std::array<JointRecords, kSteps> joints;
  for (const SceneRecord& record : records) {
    for (const JointSample& sample : record[system].joints) {
      const int step = static_cast<int>((sample.distance_m - kNearest_m) / kStep_m);
      joints[static_cast<std::size_t>(std::clamp(step, 0, kSteps - 1))].add(sample);
    }
  }
  std::vector<DistanceRow> rows;
  for (std::size_t step = 0; step < joints.size(); ++step) {
    if (joints[step].samples() == 0) continue;
    const double near = static_cast<double>(kNearest_m) + static_cast<double>(step) * static_cast<double>(kStep_m);
    const auto each = joints[step].joints();
    rows.push_back({near, near + static_cast<double>(kStep_m), joints[step].samples(),
                    joints[step].mean_over(kNavigationJoints, each), joints[step].mean_over(all_joints(), each)});
  }
  return rows;
}

std::vector<std::string> categories_of(const std::vector<Scene>& scenes) {
  std::vector<std::string> names;
  for (const Scene& scene : scenes) {
    if (std::find(names.begin(), names.end(), scene.category) == names.end()) names.push_back(scene.category);
  }
  return names;
}

}  // namespace armature::tools
