#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include <Eigen/Core>

#include "firmware_host/depth_frame.h"
#include "tracker/forest/forest.h"

namespace armature {

/// What the forest says about one pixel of the person.
struct ClassifiedPixel {
  std::uint16_t u = 0, v = 0;                       ///< column and row
  Eigen::Vector3f point = Eigen::Vector3f::Zero();  ///< on the surface, metres, camera frame
  float area_m2 = 0;                                ///< of the fronto-parallel patch that this sample stands for
  std::array<const Leaf*, kMaxTrees> leaves{};      ///< where it ended in each tree; nullptr beyond the last tree
};

/// One person's pixels in one frame. The pixels belong to the classifier and are valid until its next call.
struct PartVotes {
  std::span<const ClassifiedPixel> pixels;  ///< every stride-th column of every stride-th row, row by row
  int stride = 1;
};

struct ClassifierOptions {
  int stride = 0;  ///< pixels between samples, both ways; 0: one sample per 160th of the image's width
};

/// The most likely label of a pixel by the mean over the trees, in whole 255ths; the first of equals.
[[nodiscard]] PartLabel most_likely_part(const ClassifiedPixel& pixel) noexcept;

/// Labels the pixels of one person (Shotton et al. 2011, section 3.3). All decisions are in integers: the same
/// result on every machine. Works at any resolution, since probes are lengths in space, scaled by the focal length.
/// Owns its memory. Thread-safe: no. Realtime-safe: classify() yes, after reset() to the frame's size.
class PartClassifier {
 public:
  explicit PartClassifier(std::shared_ptr<const Forest> forest, const ClassifierOptions& options = {});
  ~PartClassifier();
  PartClassifier(PartClassifier&&) noexcept;
  PartClassifier& operator=(PartClassifier&&) noexcept;

  /// Takes memory for images of this size.
  void reset(const Intrinsics& intrinsics);

  /// Pixels of `user` in `user_of_pixel` ([height][width], as Segmentation has it). A frame of another size than that
  /// of reset() gives no pixels.
  [[nodiscard]] const PartVotes& classify(DepthView frame, std::span<const std::uint8_t> user_of_pixel,
                                          std::uint8_t user) noexcept;

  [[nodiscard]] const Forest& forest() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace armature
