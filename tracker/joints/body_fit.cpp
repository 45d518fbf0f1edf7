#include "tracker/joints/body_fit.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include <Eigen/Geometry>

namespace armature {
namespace {

using Eigen::Vector3f;
using Points = BodyFit::Points;

constexpr std::array<JointId, BodyFit::kMoved> kJoints = {
    JointId::Neck,     JointId::Waist,    JointId::LeftShoulder, JointId::RightShoulder, JointId::LeftHip,
    JointId::RightHip, JointId::LeftKnee, JointId::RightKnee,    JointId::LeftAnkle,     JointId::RightAnkle};

struct Limb {
  std::array<std::size_t, 2> ends;
  std::array<PartLabel, 2> parts;
};
constexpr std::array<Limb, 4> kLimb = {{
    {{BodyFit::LeftHip, BodyFit::LeftKnee}, {PartLabel::LeftThigh, PartLabel::LeftKnee}},
    {{BodyFit::RightHip, BodyFit::RightKnee}, {PartLabel::RightThigh, PartLabel::RightKnee}},
    {{BodyFit::LeftKnee, BodyFit::LeftAnkle}, {PartLabel::LeftShin, PartLabel::LeftKnee}},
    {{BodyFit::RightKnee, BodyFit::RightAnkle}, {PartLabel::RightShin, PartLabel::RightKnee}},
}};

/// The corners of the trunk's patch: left and right above, left and right below.
constexpr std::array<std::size_t, 4> kCorners = {BodyFit::LeftShoulder, BodyFit::RightShoulder, BodyFit::LeftHip,
                                                 BodyFit::RightHip};
constexpr bool of_trunk(PartLabel part) noexcept {
  return is_torso(part) || part == PartLabel::LeftShoulder || part == PartLabel::RightShoulder;
}

/// Pairs of joints that keep their distance: bones, and what holds the trunk together.
struct Length {
  std::array<std::size_t, 2> ends;
  float error_m;
};
constexpr float kBone_m = 0.02F, kTrunk_m = 0.04F;
constexpr std::array<Length, 13> kLength = {{
    {{BodyFit::LeftHip, BodyFit::LeftKnee}, kBone_m},
    {{BodyFit::RightHip, BodyFit::RightKnee}, kBone_m},
    {{BodyFit::LeftKnee, BodyFit::LeftAnkle}, kBone_m},
    {{BodyFit::RightKnee, BodyFit::RightAnkle}, kBone_m},
    {{BodyFit::LeftShoulder, BodyFit::RightShoulder}, kTrunk_m},
    {{BodyFit::LeftHip, BodyFit::RightHip}, kTrunk_m},
    {{BodyFit::Neck, BodyFit::LeftShoulder}, kTrunk_m},
    {{BodyFit::Neck, BodyFit::RightShoulder}, kTrunk_m},
    {{BodyFit::Waist, BodyFit::LeftHip}, kTrunk_m},
    {{BodyFit::Waist, BodyFit::RightHip}, kTrunk_m},
    {{BodyFit::LeftShoulder, BodyFit::LeftHip}, kTrunk_m},
    {{BodyFit::RightShoulder, BodyFit::RightHip}, kTrunk_m},
    {{BodyFit::Neck, BodyFit::Waist}, kTrunk_m},
}};

/// Joints that go along with the mean of some that are moved.
struct Carried {
  JointId joint;
  std::array<std::size_t, 2> with;
};
constexpr std::array<Carried, 8> kCarried = {{
    {JointId::LeftThigh, {BodyFit::LeftHip, BodyFit::LeftKnee}},
    {JointId::RightThigh, {BodyFit::RightHip, BodyFit::RightKnee}},
    {JointId::LeftFoot, {BodyFit::LeftAnkle, BodyFit::LeftAnkle}},
    {JointId::RightFoot, {BodyFit::RightAnkle, BodyFit::RightAnkle}},
    {JointId::LeftCollar, {BodyFit::Neck, BodyFit::LeftShoulder}},
    {JointId::RightCollar, {BodyFit::Neck, BodyFit::RightShoulder}},
    {JointId::Chest, {BodyFit::LeftShoulder, BodyFit::RightShoulder}},
    {JointId::Torso, {BodyFit::Neck, BodyFit::Waist}},
}};

// How much things count: by the inverse square of these.
constexpr float kMove_m = 0.015F;          // of a joint with confidence 1
constexpr float kLeastConfidence = 0.02F;  // of a joint that has a place
constexpr float kFixed = 1000;             // the confidence of one that has none
constexpr float kSurface_m = 0.01F;        // of a pixel
constexpr float kFar_m = 0.03F;            // whose pixel is farther off belongs to something else
constexpr float kLimbPixels = 6;           // neighbours err alike: so many count, however many there are
constexpr float kTrunkPixels = 24;
constexpr int kSteps = 2;

constexpr std::size_t kMostPixels = 700;
constexpr float kMostOff_m = 0.25F;   // of its bone or patch, whose surface it is
constexpr float kLeastPixels = 4;     // that a place is known by
constexpr float kBeyond = 0.15F;      // of a bone's length
constexpr float kMargin = 0.2F;       // beside the patch, of its sides
constexpr float kLeastFacing = 0.3F;  // the cosine of the angle at which a patch can be seen

/// A point beside something that `n` joints carry.
template <std::size_t n>
struct Beside {
  std::array<float, n> shares;  // of the joints in what it lies beside
  Vector3f outwards;
  float off_m = 0;
  std::size_t place = 0;  // of the surface there
  bool near = false;      // whether it may belong to it
};

std::size_t place_of(float share, std::size_t places) noexcept {
  return std::min(places - 1, static_cast<std::size_t>(std::max(0.0F, share * static_cast<float>(places))));
}

class Bone {
 public:
  Bone(const Points& joints, const std::array<std::size_t, 2>& ends) noexcept
      : from_(joints[ends[0]]), bone_(joints[ends[1]] - from_) {}

  [[nodiscard]] Beside<2> at(const Vector3f& point) const noexcept {
    const float along = (point - from_).dot(bone_) / std::max(bone_.squaredNorm(), 1e-6F);
    const float t = std::clamp(along, 0.0F, 1.0F);
    const Vector3f off = point - from_ - t * bone_;
    const float off_m = off.norm();
    return {.shares = {1 - t, t},
            .outwards = off / std::max(off_m, 1e-6F),
            .off_m = off_m,
            .place = place_of(t, BodyFit::kBins),
            .near = along > -kBeyond && along < 1 + kBeyond && off_m < kMostOff_m};
  }

 private:
  Vector3f from_, bone_;
};

/// The bilinear patch between shoulders and hips.
class Patch {
 public:
  Patch(const Points& joints, const std::array<std::size_t, 4>& corners) noexcept {
    for (std::size_t c = 0; c < 4; ++c) corners_[c] = joints[corners[c]];
    const Vector3f middle = 0.25F * (corners_[0] + corners_[1] + corners_[2] + corners_[3]);
    facing_ = -across(0.5F).cross(down(0.5F)).normalized().dot(middle.normalized());
  }
  /// Whether it is not seen from the side.
  [[nodiscard]] bool seen() const noexcept { return std::abs(facing_) > kLeastFacing; }

  [[nodiscard]] Beside<4> at(const Vector3f& point) const noexcept {
    float s = 0.5F, t = 0.5F;
    Vector3f off, ds, dt;
    const auto look = [&] {
      ds = across(t);
      dt = down(s);
      off = point - corners_[0] - s * (corners_[1] - corners_[0]) - t * dt;
    };
    for (int i = 0; i < 3; ++i) {
      look();
      const float a = ds.squaredNorm(), b = ds.dot(dt), c = dt.squaredNorm();
      const float det = std::max(a * c - b * b, 1e-9F);
      const float x = ds.dot(off), y = dt.dot(off);
      s = std::clamp(s + (c * x - b * y) / det, -0.5F, 1.5F);
      t = std::clamp(t + (a * y - b * x) / det, -0.5F, 1.5F);
    }
    look();
    const auto share = [](float along) { return (along + kMargin) / (1 + 2 * kMargin); };
    const auto within = [](float along) { return along > -kMargin && along < 1 + kMargin; };
    const Vector3f outwards = (facing_ < 0 ? -1.0F : 1.0F) * ds.cross(dt).normalized();
    const float off_m = off.dot(outwards);
    return {.shares = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t},
            .outwards = outwards,
            .off_m = off_m,
            .place = place_of(share(s), BodyFit::kCells) * BodyFit::kCells + place_of(share(t), BodyFit::kCells),
            .near = within(s) && within(t) && std::abs(off_m) < kMostOff_m};
  }

 private:
  [[nodiscard]] Vector3f across(float t) const noexcept {
    return (1 - t) * (corners_[1] - corners_[0]) + t * (corners_[3] - corners_[2]);
  }
  [[nodiscard]] Vector3f down(float s) const noexcept {
    return (1 - s) * (corners_[2] - corners_[0]) + s * (corners_[3] - corners_[1]);
  }
  std::array<Vector3f, 4> corners_;
  float facing_ = 1;  // the sensor, by what is right of across x down: the cosine
};

/// Least squares in how far the joints move. Sums and the factorisation go element by element: the same bits on every
/// processor, which a library's vectorised one does not promise.
class NormalEquations {
 public:
  /// The sum of shares of joints' moves along `direction` should be `wanted`.
  template <std::size_t n>
  void add(const std::array<std::size_t, n>& joints, const std::array<float, n>& shares, const Vector3f& direction,
           float wanted, float weight) noexcept {
    for (std::size_t i = 0; i < n; ++i) {
      const Vector3f by = weight * shares[i] * direction;
      for (int r = 0; r < 3; ++r) right_[3 * joints[i] + static_cast<std::size_t>(r)] += by[r] * wanted;
      for (std::size_t j = 0; j < n; ++j) {
        if (joints[j] > joints[i]) continue;  // the left side is symmetric: below its diagonal is enough
        for (int r = 0; r < 3; ++r) {
          for (int c = 0; c < 3; ++c) {
            left_[3 * joints[i] + static_cast<std::size_t>(r)][3 * joints[j] + static_cast<std::size_t>(c)] +=
                by[r] * shares[j] * direction[c];
          }
        }
      }
    }
  }
  /// The moves, by Cholesky's factorisation.
  [[nodiscard]] std::optional<Points> solve() noexcept {
    for (std::size_t i = 0; i < kSize; ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        double sum = left_[i][j];
        for (std::size_t k = 0; k < j; ++k) sum -= left_[i][k] * left_[j][k];
        if (i == j && !(sum > 0)) return std::nullopt;
        left_[i][j] = i == j ? std::sqrt(sum) : sum / left_[j][j];
      }
    }
    for (std::size_t i = 0; i < kSize; ++i) {
      for (std::size_t k = 0; k < i; ++k) right_[i] -= left_[i][k] * right_[k];
      right_[i] /= left_[i][i];
    }
    for (std::size_t i = kSize; i-- > 0;) {
      for (std::size_t k = i + 1; k < kSize; ++k) right_[i] -= left_[k][i] * right_[k];
      right_[i] /= left_[i][i];
    }
    Points moves;
    for (std::size_t j = 0; j < BodyFit::kMoved; ++j) {
      moves[j] = Eigen::Vector3d(right_[3 * j], right_[3 * j + 1], right_[3 * j + 2]).cast<float>();
      if (!moves[j].allFinite()) return std::nullopt;
    }
    return moves;
  }

 private:
  static constexpr std::size_t kSize = 3 * BodyFit::kMoved;
  std::array<std::array<double, kSize>, kSize> left_{};
  std::array<double, kSize> right_{};
};

/// How much a pixel counts that lies so far off the surface.
float trust(float off_m) noexcept {
  const float far = off_m / kFar_m;
  const float denominator = 1 + far * far;
  return 1 / (kSurface_m * kSurface_m * denominator * denominator);
}

Points points_of(const Skeleton& skeleton) noexcept {
  Points out;
  for (std::size_t j = 0; j < out.size(); ++j) out[j] = skeleton[kJoints[j]].position;
  return out;
}

bool lost(const Skeleton& skeleton, std::span<const std::size_t> joints) noexcept {
  return std::ranges::any_of(joints, [&](std::size_t j) { return skeleton[kJoints[j]].state == JointState::Lost; });
}

}  // namespace

void BodyFit::Mean::age() noexcept {
  constexpr float kKept = 1 - 1.0F / kFrames;
  sum *= kKept;
  weight *= kKept;
}

BodyFit::BodyFit() {
  for (auto& pixels : seen_.limbs) pixels.reserve(kMostPixels);
  seen_.trunk.reserve(kMostPixels);
}

void BodyFit::reset() noexcept {
  limbs_ = {};
  trunk_ = {};
  lengths_m_ = {};
  frames_ = 0;
}

void BodyFit::sort(const PartVotes& votes) noexcept {
  for (auto& pixels : seen_.limbs) pixels.clear();
  seen_.trunk.clear();
  const std::size_t every = std::max<std::size_t>(2, (votes.pixels.size() + kMostPixels - 1) / kMostPixels);
  for (std::size_t i = 0; i < votes.pixels.size(); i += every) {
    const ClassifiedPixel& pixel = votes.pixels[i];
    const PartLabel part = most_likely_part(pixel);
    if (of_trunk(part)) seen_.trunk.push_back(pixel.point);
    for (std::size_t l = 0; l < kLimbs; ++l) {
      if (part == kLimb[l].parts[0] || part == kLimb[l].parts[1]) seen_.limbs[l].push_back(pixel.point);
    }
  }
}

template <std::size_t n>
template <class Part>
void BodyFit::Surface<n>::learn(const Part& part, std::span<const Vector3f> pixels) noexcept {
  for (Mean& place : off_m) place.age();
  float count = 0;
  for (const Vector3f& point : pixels) {
    const auto beside = part.at(point);
    if (!beside.near) continue;
    off_m[beside.place].add(beside.off_m);
    ++count;
  }
  pixels_a_frame.age();
  pixels_a_frame.add(count);
}

void BodyFit::learn(const PartVotes& votes, const Skeleton& skeleton) noexcept {
  sort(votes);
  ++frames_;
  const Points joints = points_of(skeleton);
  for (std::size_t l = 0; l < kLengths; ++l) {
    const auto& ends = kLength[l].ends;
    if (lost(skeleton, ends)) continue;
    lengths_m_[l].age();
    lengths_m_[l].add((joints[ends[1]] - joints[ends[0]]).norm());
  }
  for (std::size_t l = 0; l < kLimbs; ++l) {
    const auto& ends = kLimb[l].ends;
    if (!lost(skeleton, ends)) limbs_[l].learn(Bone(joints, ends), seen_.limbs[l]);
  }
  if (!lost(skeleton, kCorners)) trunk_.learn(Patch(joints, kCorners), seen_.trunk);
}

/// Pixels should lie on the surface; they count as much as `worth` of them where as many are seen as at rest.
template <std::size_t n>
template <class Part, std::size_t m, class Equations>
void BodyFit::Surface<n>::fit(const Part& part, std::span<const Vector3f> pixels, float worth,
                              const std::array<std::size_t, m>& joints, Equations& equations) const noexcept {
  const float each = worth / std::max(pixels_a_frame.value(), static_cast<float>(pixels.size()));
  for (const Vector3f& point : pixels) {
    const auto beside = part.at(point);
    const Mean& here = off_m[beside.place];
    if (!beside.near || here.weight < kLeastPixels) continue;
    const float off = beside.off_m - here.value();
    equations.add(joints, beside.shares, beside.outwards, off, each * trust(off));
  }
}

void BodyFit::apply(const PartVotes& votes, Skeleton& skeleton) noexcept {
  if (!settled()) return;
  sort(votes);
  const Points before = points_of(skeleton);
  Points joints = before;
  for (int step = 0; step < kSteps; ++step) {
    NormalEquations equations;
    for (std::size_t j = 0; j < kMoved; ++j) {
      const Joint& joint = skeleton[kJoints[j]];
      const float trusted = joint.state == JointState::Lost ? kFixed : std::max(joint.confidence, kLeastConfidence);
      for (int axis = 0; axis < 3; ++axis) {
        equations.add<1>({j}, {1}, Vector3f::Unit(axis), (before[j] - joints[j])[axis], trusted / (kMove_m * kMove_m));
      }
    }
    for (std::size_t l = 0; l < kLengths; ++l) {
      const auto& [ends, error_m] = kLength[l];
      if (lost(skeleton, ends) || lengths_m_[l].weight == 0) continue;
      const Vector3f between = joints[ends[1]] - joints[ends[0]];
      const float length = std::max(between.norm(), 1e-6F);
      equations.add<2>(ends, {-1, 1}, between / length, lengths_m_[l].value() - length, 1 / (error_m * error_m));
    }
    for (std::size_t l = 0; l < kLimbs; ++l) {
      const auto& ends = kLimb[l].ends;
      if (!lost(skeleton, ends)) limbs_[l].fit(Bone(joints, ends), seen_.limbs[l], kLimbPixels, ends, equations);
    }
    const Patch patch(joints, kCorners);
    if (!lost(skeleton, kCorners) && patch.seen()) {
      trunk_.fit(patch, seen_.trunk, kTrunkPixels, kCorners, equations);
    }
    const auto moves = equations.solve();
    if (!moves) return;
    for (std::size_t j = 0; j < kMoved; ++j) joints[j] += (*moves)[j];
  }
  for (std::size_t j = 0; j < kMoved; ++j) {
    Joint& joint = skeleton[kJoints[j]];
    if (joint.state != JointState::Lost) joint.position = joints[j];
  }
  for (const auto& [joint, with] : kCarried) {
    if (skeleton[joint].state == JointState::Lost || lost(skeleton, with)) continue;
    skeleton[joint].position += 0.5F * (joints[with[0]] - before[with[0]] + joints[with[1]] - before[with[1]]);
  }
}

}  // namespace armature
