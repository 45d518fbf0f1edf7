#include "tools/evaluation/sdk_imitation.h"

#include <Eigen/Dense>

#include "tools/evaluation/skeleton_tracker.h"
#include "tracker/joints/joint_correction.h"

namespace armature::tools {
namespace {

constexpr Eigen::Index kInputs = 3 * kJointCount, kOutputs = 3 * kNavigationJoints.size();
constexpr float kUnit_m = 0.1F;
constexpr double kRidge = 30;  // agreement hardly depends on it

/// Of one recording, a row a frame, each column less its mean: where our joints are as seen from the torso, and by how
/// much the SDK's are elsewhere.
struct Rows {
  Eigen::MatrixXd known, offset;
};

Rows rows_of(const SeenTwice& seen) {
  const auto frames = static_cast<Eigen::Index>(seen.ours.size());
  Rows rows{.known = Eigen::MatrixXd(frames, kInputs), .offset = Eigen::MatrixXd(frames, kOutputs)};
  for (Eigen::Index t = 0; t < frames; ++t) {
    const Skeleton &ours = seen.ours[static_cast<std::size_t>(t)], &sdk = seen.sdk[static_cast<std::size_t>(t)];
    const CorrectionFrame frame(ours);
    for (std::size_t j = 0; j < kJointCount; ++j) {
      const Eigen::Vector3f p = frame.seen(ours.joints[j].position) / kUnit_m;
      rows.known.block<1, 3>(t, static_cast<Eigen::Index>(3 * j)) = p.cast<double>().transpose();
    }
    for (std::size_t j = 0; j < kNavigationJoints.size(); ++j) {
      const JointId id = kNavigationJoints[j];
      const Eigen::Vector3f d = frame.turned(sdk[id].position - ours[id].position);
      rows.offset.block<1, 3>(t, static_cast<Eigen::Index>(3 * j)) = d.cast<double>().transpose();
    }
  }
  for (Eigen::MatrixXd* columns : {&rows.known, &rows.offset}) {
    columns->rowwise() -= columns->colwise().mean().eval();
  }
  return rows;
}

}  // namespace

std::vector<std::vector<Skeleton>> imitate_sdk(std::span<const SeenTwice> recordings) {
  std::vector<Rows> rows;
  for (const SeenTwice& seen : recordings) rows.push_back(rows_of(seen));
  std::vector<std::vector<Skeleton>> out;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    Eigen::MatrixXd normal = kRidge * Eigen::MatrixXd::Identity(kInputs, kInputs);
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(kInputs, kOutputs);
    for (std::size_t other = 0; other < recordings.size(); ++other) {
      if (recordings[other].person == recordings[i].person) continue;
      normal.noalias() += rows[other].known.transpose() * rows[other].known;
      right.noalias() += rows[other].known.transpose() * rows[other].offset;
    }
    const Eigen::MatrixXd offset = rows[i].known * normal.ldlt().solve(right);
    std::vector<Skeleton>& moved = out.emplace_back(recordings[i].ours);
    for (std::size_t t = 0; t < moved.size(); ++t) {
      const CorrectionFrame frame(recordings[i].ours[t]);
      for (std::size_t j = 0; j < kNavigationJoints.size(); ++j) {
        const auto row = static_cast<Eigen::Index>(t), column = static_cast<Eigen::Index>(3 * j);
        const Eigen::Vector3f d = offset.block<1, 3>(row, column).transpose().cast<float>();
        moved[t][kNavigationJoints[j]].position += frame.turned_back(d);
      }
    }
  }
  return out;
}

}  // namespace armature::tools
