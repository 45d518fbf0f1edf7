#pragma once

#include <array>
#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "firmware_host/error.h"
#include "tools/evaluation/scenes.h"
#include "tools/evaluation/skeleton_tracker.h"
#include "tracker/motions/motion.h"

namespace armature::tools {

/// What is held against the truth of the scenes.
enum class System : std::uint8_t {
  Whole,  ///< depth in, joints and filtered motions out, segmentation included: what a user gets
  Mask,   ///< the same forest, joints and filters, given the user's true pixels
  Paper,  ///< Shotton et al. 2011, given the user's true pixels (paper_tracker.h); motions unfiltered
};
inline constexpr std::size_t kSystemCount = 3;
inline constexpr std::array<std::string_view, kSystemCount> kSystemNames = {"whole", "mask", "paper"};

/// A true joint inside the image in one frame, and what a system said of it.
struct JointSample {
  JointId joint = JointId::Head;
  bool given = false;    ///< with a position, observed or inferred
  float distance_m = 0;  ///< of the user's torso from the sensor, along its axis
  float error_m = 0;     ///< where given
  float confidence = 0;
};

struct MotionSample {
  MotionId motion = MotionId::RotateShoulders;
  float error_rad = 0;
};

/// What one system did in one scene after its first second.
struct SystemRecord {
  std::vector<JointSample> joints;
  std::vector<MotionSample> motions;  ///< of the seven motions whose joints are all inside the image, where measured
  int frames = 0;
  int tracked = 0;      ///< frames with a skeleton
  int rest_frames = 0;  ///< frames of somebody who does nothing and whose rest pose is known
  int standing = 0;     ///< of those, both velocities exactly zero
  int swaps = 0;        ///< times that a navigation joint and its mirror image are exchanged for more than two frames
  std::vector<double> frame_us;
};

struct SceneRecord {
  std::array<SystemRecord, kSystemCount> systems;
  std::size_t pixels = 0, pixels_right = 0;  ///< pixels with a true part; with it as their most likely one

  [[nodiscard]] const SystemRecord& operator[](System system) const {
    return systems[static_cast<std::size_t>(system)];
  }
};

struct SceneOptions {
  int width = 320;
  int height = 240;
  int stride = 0;   ///< pixels between samples; 0: the tracker's own choice
  int threads = 1;  ///< scenes at a time; times of frames mean something with one only
};

/// Plays every scene to all systems. Deterministic but for frame_us. Stopped: an error.
[[nodiscard]] Expected<std::vector<SceneRecord>> evaluate_scenes(std::shared_ptr<const Forest> forest,
                                                                 const std::vector<Scene>& scenes,
                                                                 const SceneOptions& options,
                                                                 const std::function<void(double)>& progress,
                                                                 const std::stop_token& stop);

/// Counts exchanges of left and right that last longer than two frames, one sequence at a time.
class SwapCounter {
 public:
  /// Exchanged: the found pair fits the true one better crosswise, by squared distances, while the true ones are at
  /// least 10 cm apart. A pair that is not found ends an exchange.
  void add(const Skeleton& truth, const Skeleton* found) noexcept;
  [[nodiscard]] int count() const noexcept { return count_; }

 private:
  std::array<int, 3> run_{};  // shoulders, hips, knees
  int count_ = 0;
};

}  // namespace armature::tools
