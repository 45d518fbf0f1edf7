#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware_host/error.h"
#include "tracker/body/body_parts.h"
#include "tracker/forest/perceptron.h"

namespace armature {

/// One decision of a tree (Shotton et al. 2011, section 3.2): f = d(x + u/d(x)) - d(x + v/d(x)) goes to child[0] where
/// f < threshold_mm, else to child[1]. Probes are offsets in the image plane at the depth of the pixel. A pixel outside
/// the person reads as kBackgroundDepth_mm.
struct SplitNode {
  std::array<std::int16_t, 2> u_mm{};   ///< x right, y down
  std::array<std::int16_t, 2> v_mm{};   ///< {0, 0} for a one-sided feature
  std::array<std::int32_t, 2> child{};  ///< a node behind this one, or ~leaf
  std::int16_t threshold_mm = 0;
};

/// A leaf's guess where a joint lies, relative to the surface point of the pixel, along the camera's axes.
struct LeafVote {
  static constexpr float kUnit_m = 0.008F;  ///< of `offset`
  static constexpr std::uint8_t kNone = 255;
  std::array<std::int8_t, 3> offset{};
  std::uint8_t joint = kNone;    ///< a JointId, or kNone: this and the following votes are absent
  std::uint8_t weight_code = 0;  ///< see vote_weight()
};
inline constexpr int kVotesPerLeaf = 8;

/// What the training pixels that ended in this leaf were.
struct Leaf {
  std::array<LeafVote, kVotesPerLeaf> votes{};  ///< strongest first
  std::array<std::uint8_t, 32> probability{};   ///< of each PartLabel, in 255ths; the last is unused and zero
};

inline constexpr std::array<float, 256> kVoteWeights = [] {
  std::array<float, 256> weights{};
  double weight = 1;
  for (float& w : weights) {
    w = static_cast<float>(weight);
    weight *= 0.95760328069857364694;  // 2^(-1/16)
  }
  return weights;
}();
/// A vote's weight in (0, 1]: 1 for code 0, halved every 16 codes.
[[nodiscard]] inline float vote_weight(std::uint8_t code) noexcept {
  return kVoteWeights[code];
}
/// The code whose weight is nearest below `weight`.
[[nodiscard]] std::uint8_t vote_weight_code(float weight) noexcept;

struct Tree {
  std::vector<SplitNode> nodes;  ///< nodes[0] is the root; empty: the tree is leaf 0 alone
  std::vector<Leaf> leaves;      ///< never empty
};

inline constexpr std::uint16_t kBackgroundDepth_mm = 20000;
inline constexpr std::uint16_t kMaxPersonDepth_mm = 10000;  ///< whatever is farther counts as background
inline constexpr int kMaxProbe_mm = 2000;
inline constexpr int kMaxTrees = 4;

/// The shape of the network that corrects joints (joints/joint_correction.h says what the numbers are).
inline constexpr int kCorrectionBones = 12;
inline constexpr int kCorrectionInputs = 7 * kJointCount + 2 + 2 * kCorrectionBones;
inline constexpr int kCorrectionOutputs = 4 * kJointCount;

/// A trained part forest, and the network that corrects the joints found with it. Immutable; every index in it was
/// checked when it was made, so that walking it stays inside. Thread-safe: yes, for reading.
class Forest {
 public:
  /// A child that points outside or backwards, a joint or probe out of range or an empty tree is an error.
  [[nodiscard]] static Expected<Forest> create(std::vector<Tree> trees, std::string command);
  /// The same forest with this correction; one of another shape than kCorrectionInputs by kCorrectionOutputs is an
  /// error.
  [[nodiscard]] Expected<Forest> corrected_by(Perceptron correction) const;
  [[nodiscard]] Forest uncorrected() const { return Forest(trees_, command_); }

  /// Reads a model file. Truncated, altered, of another version or no model at all: one line that says so.
  [[nodiscard]] static Expected<Forest> load(const std::filesystem::path& path);
  /// The same for bytes in memory; `name` stands for the file in messages.
  [[nodiscard]] static Expected<Forest> parse(std::span<const std::byte> bytes, const std::string& name);

  /// Writes the model through a temporary file that is renamed when complete.
  [[nodiscard]] Expected<void> save(const std::filesystem::path& path) const;
  [[nodiscard]] std::vector<std::byte> serialize() const;

  [[nodiscard]] std::span<const Tree> trees() const noexcept { return trees_; }
  /// What makes better joints of those that the votes agree on (joints/joint_correction.h); null: nothing does.
  [[nodiscard]] const Perceptron* correction() const noexcept { return correction_ ? &*correction_ : nullptr; }
  /// The command that trained this forest, for the record.
  [[nodiscard]] const std::string& command() const noexcept { return command_; }
  /// CRC-32 (IEEE 802.3) of the model file's contents, as stored in it.
  [[nodiscard]] std::uint32_t checksum() const;
  /// Decisions on the longest path of a tree.
  [[nodiscard]] int depth() const;

 private:
  Forest(std::vector<Tree> trees, std::string command);
  std::vector<Tree> trees_;
  std::optional<Perceptron> correction_;
  std::string command_;
};

}  // namespace armature
