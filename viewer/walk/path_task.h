#pragma once

#include <chrono>
#include <vector>

#include <Eigen/Core>

namespace armature::viewer {

/// A path to be followed as closely and as fast as one can (thesis, section 3.5.3).
class PathTask {
 public:
  /// How far from the path is still close, metres.
  static constexpr double kClose = 1.0;

  /// At least two points, metres.
  explicit PathTask(std::vector<Eigen::Vector2d> path);

  /// Where the walker is now. Time runs from leaving the start until the end is reached.
  void update(const Eigen::Vector2d& at, std::chrono::duration<double> step);

  [[nodiscard]] const std::vector<Eigen::Vector2d>& path() const noexcept { return path_; }
  [[nodiscard]] double length_m() const noexcept { return starts_.back(); }
  [[nodiscard]] bool started() const noexcept { return started_; }
  [[nodiscard]] bool finished() const noexcept { return finished_; }
  [[nodiscard]] bool close() const noexcept { return distance_m_ <= kClose; }
  [[nodiscard]] double distance_m() const noexcept { return distance_m_; }  ///< from the path, now
  [[nodiscard]] double along_m() const noexcept { return along_m_; }        ///< of the path, at most so far
  [[nodiscard]] std::chrono::duration<double> time() const noexcept { return time_; }
  /// The mean distance from the path over the way walked so far, metres.
  [[nodiscard]] double mean_deviation_m() const noexcept { return walked_m_ > 0 ? sum_ / walked_m_ : 0; }
  /// The thesis's measure: the mean of the squared distance, in percent of the path's length.
  [[nodiscard]] double deviation_percent() const noexcept {
    return walked_m_ > 0 ? 100 * (square_sum_ / walked_m_) / length_m() : 0;
  }

 private:
  std::vector<Eigen::Vector2d> path_;
  std::vector<double> starts_;  // of each point along the path
  bool started_ = false, finished_ = false;
  Eigen::Vector2d last_;
  double distance_m_ = 0, along_m_ = 0, walked_m_ = 0, sum_ = 0, square_sum_ = 0;
  std::chrono::duration<double> time_{0};
};

}  // namespace armature::viewer
