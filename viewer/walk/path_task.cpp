#include "viewer/walk/path_task.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace armature::viewer {
namespace {

/// How near to the end is there, and how far from the start is gone, metres.
constexpr double kArrived = 1.0;
constexpr double kLeft = 0.3;
/// How much further along the path the closest point may jump, metres: across a bend is no short cut.
constexpr double kReach = 8;

}  // namespace

PathTask::PathTask(std::vector<Eigen::Vector2d> path) : path_(std::move(path)), starts_{0}, last_(path_.front()) {
  for (std::size_t i = 1; i < path_.size(); ++i) starts_.push_back(starts_.back() + (path_[i] - path_[i - 1]).norm());
}

void PathTask::update(const Eigen::Vector2d& at, std::chrono::duration<double> step) {
  double nearest = std::numeric_limits<double>::infinity();
  double along = along_m_;
  for (std::size_t i = 1; i < path_.size(); ++i) {
    const Eigen::Vector2d side = path_[i] - path_[i - 1];
    const double length = starts_[i] - starts_[i - 1];
    if (!(length > 0) || starts_[i - 1] > along_m_ + kReach) continue;
    const double share = std::clamp((at - path_[i - 1]).dot(side) / (length * length), 0.0, 1.0);
    const double distance = (at - path_[i - 1] - share * side).norm();
    if (distance < nearest) nearest = distance, along = starts_[i - 1] + share * length;
  }
  distance_m_ = nearest;
  if (finished_) return;
  along_m_ = std::max(along_m_, along);
  started_ = started_ || (at - path_.front()).norm() > kLeft;
  if (started_) {
    time_ += step;
    const double walked = (at - last_).norm();
    walked_m_ += walked;
    sum_ += walked * nearest;
    square_sum_ += walked * nearest * nearest;
    finished_ = length_m() - along_m_ < kArrived;
  }
  last_ = at;
}

}  // namespace armature::viewer
