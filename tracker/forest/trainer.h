#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "firmware_host/depth_frame.h"
#include "tracker/forest/forest.h"
#include "tracker/forest/ranks.h"

namespace armature {

/// A person with the truth about it.
struct TrainingImage {
  Intrinsics intrinsics;
  std::vector<std::uint16_t> depth_mm;                ///< [height][width], 0 = no return
  std::vector<std::uint8_t> user;                     ///< [height][width], not 0 where segmentation sees the user
  std::vector<std::uint8_t> part_of_pixel;            ///< [height][width], a PartLabel, or kNoPart: bags, bits of floor
  std::array<Eigen::Vector3f, kJointCount> joints{};  ///< metres, camera frame
};

/// The i-th image, always the same for the same i. Called from several threads at once.
using TrainingImages = std::function<TrainingImage(int i)>;

struct TrainerOptions {
  int image_count = 4000;
  int tree_count = 3;
  int max_depth = 18;
  int pixels_per_image = 500;  ///< drawn afresh for each tree
  int features_per_node = 320;
  int node_samples = 20000;  ///< that a split is chosen on; at most kMaxNodeSamples
  int min_leaf_samples = 40;
  int max_probe_mm = 1000;
  std::uint64_t seed = 1;
  int threads = 0;                   ///< 0: as many as there are cores, or one for each of several ranks
  std::string command;               ///< recorded in the model
  std::filesystem::path checkpoint;  ///< where finished subtrees are kept; empty: nowhere
  bool keep_checkpoint = false;      ///< also when all is done: the caller has more to do, and removes it
  bool resume = false;               ///< take what the checkpoint holds instead of training it again
};
inline constexpr int kMaxNodeSamples = 32768;

/// Trains a part forest (Shotton et al. 2011, section 3.3; offset votes in the leaves after Girshick et al. 2011).
/// Breadth-first for the first levels, then each subtree depth-first; a node's randomness comes from its place in the
/// tree, so the result depends on the options and images alone, not on threads, ranks or interruptions: what ranks add
/// up are integers, and which samples are looked at depends on each sample alone. Every rank returns the same forest or
/// the same error; checkpoint and progress are of rank 0. `progress` gets fractions in [0, 1], from any thread, one at
/// a time. A stop is an error that says how to go on; the checkpoint then holds what was finished.
[[nodiscard]] Expected<Forest> train_forest(const TrainerOptions& options, const TrainingImages& images,
                                            const std::function<void(double)>& progress, std::stop_token stop,
                                            Ranks& ranks);
/// The same in this process alone.
[[nodiscard]] Expected<Forest> train_forest(const TrainerOptions& options, const TrainingImages& images,
                                            const std::function<void(double)>& progress, std::stop_token stop);

}  // namespace armature
