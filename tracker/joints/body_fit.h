#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "tracker/body/skeleton.h"
#include "tracker/forest/part_classifier.h"

namespace armature {

/// Moves the joints of trunk and legs to where the surface that a person had at rest fits the one that is seen now:
/// votes and their correction know what a part looks like, not exactly how far away it is.
///
/// The surface is what each pixel of the trunk and the legs lies off the joints at rest: of the trunk a height over the
/// patch between shoulders and hips, of a thigh or a shin the distance from its bone, both by place. A few Gauss-Newton
/// steps then balance, in least squares, how far pixels lie off it, how far joints move from where they were, the
/// less confident the farther, and how far lengths change from those at rest.
/// Owns its memory. Deterministic. Thread-safe: no. Realtime-safe: everything but the constructor.
class BodyFit {
 public:
  BodyFit();

  /// Forgets the person.
  void reset() noexcept;

  /// Somebody at rest, as classified and corrected: a mean, in which the last 15 frames weigh most.
  void learn(const PartVotes& votes, const Skeleton& skeleton) noexcept;
  /// Whether it is a mean of enough frames.
  [[nodiscard]] bool settled() const noexcept { return frames_ >= kFrames; }

  /// Positions of `skeleton`, of the person who was learned; a lost joint stays where it is, and all do before
  /// settled().
  void apply(const PartVotes& votes, Skeleton& skeleton) noexcept;

  /// The joints that surfaces say something about.
  enum Moved : std::size_t {
    Neck,
    Waist,
    LeftShoulder,
    RightShoulder,
    LeftHip,
    RightHip,
    LeftKnee,
    RightKnee,
    LeftAnkle,
    RightAnkle
  };
  static constexpr std::size_t kMoved = 10;
  using Points = std::array<Eigen::Vector3f, kMoved>;
  static constexpr std::size_t kBins = 6;   ///< places of a surface along a bone
  static constexpr std::size_t kCells = 8;  ///< and of the trunk's, a side

 private:
  static constexpr int kFrames = 15;
  static constexpr std::size_t kLimbs = 4;
  static constexpr std::size_t kLengths = 13;

  /// A mean of the last frames.
  struct Mean {
    float sum = 0, weight = 0;
    void age() noexcept;
    void add(float value) noexcept {
      sum += value;
      weight += 1;
    }
    [[nodiscard]] float value() const noexcept { return weight > 0 ? sum / weight : 0; }
  };
  /// How far pixels of a part lie off its joints at rest, by place.
  template <std::size_t n>
  struct Surface {
    std::array<Mean, n> off_m;
    Mean pixels_a_frame;

    template <class Part>
    void learn(const Part& part, std::span<const Eigen::Vector3f> pixels) noexcept;
    template <class Part, std::size_t m, class Equations>
    void fit(const Part& part, std::span<const Eigen::Vector3f> pixels, float worth,
             const std::array<std::size_t, m>& joints, Equations& equations) const noexcept;
  };

  /// The pixels of each of them, of a frame.
  struct Seen {
    std::array<std::vector<Eigen::Vector3f>, kLimbs> limbs;
    std::vector<Eigen::Vector3f> trunk;
  };
  void sort(const PartVotes& votes) noexcept;

  Seen seen_;
  std::array<Surface<kBins>, kLimbs> limbs_;
  Surface<kCells * kCells> trunk_;
  std::array<Mean, kLengths> lengths_m_;
  int frames_ = 0;
};

}  // namespace armature
