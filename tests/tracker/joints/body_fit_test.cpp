#include "tracker/joints/body_fit.h"

#include <cmath>
#include <map>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/support/count_allocations.h"

namespace armature {
namespace {

using Eigen::Vector3f;
using enum JointId;

/// A doll of which everything moved by the fit is known: a board between shoulders and hips, round legs, seen from the
/// front at 2.5 m.
struct Doll {
  float turn_rad = 0;              // of the whole, about the vertical
  Vector3f left_knee = {0, 0, 0};  // moved by

  [[nodiscard]] Vector3f placed(const Vector3f& p) const {
    return Eigen::AngleAxisf(turn_rad, Vector3f::UnitY()) * p + Vector3f(0, 0, 2.5F);
  }
  [[nodiscard]] Skeleton skeleton() const {
    Skeleton out;
    const auto set = [&](JointId joint, const Vector3f& at) {
      out[joint] = {.position = placed(at), .confidence = 0.9F, .state = JointState::Observed};
    };
    set(Neck, {0, -0.55F, 0});
    set(Waist, {0, -0.10F, 0});
    for (const float side : {-1.0F, 1.0F}) {  // a person's left is to the camera's right
      const bool left = side > 0;
      set(left ? LeftShoulder : RightShoulder, {0.19F * side, -0.5F, 0});
      set(left ? LeftHip : RightHip, {0.10F * side, 0, 0});
      set(left ? LeftThigh : RightThigh, {0.10F * side, 0.2F, 0});
      set(left ? LeftKnee : RightKnee, {0.10F * side, 0.42F, 0});
      set(left ? LeftAnkle : RightAnkle, {0.10F * side, 0.84F, 0});
    }
    out[LeftKnee].position += left_knee;
    return out;
  }

  struct Seen {
    std::vector<ClassifiedPixel> pixels;
    [[nodiscard]] PartVotes votes() const { return {.pixels = pixels, .stride = 1}; }
    void add(const Vector3f& point, PartLabel part) {
      static const std::map<PartLabel, Leaf> leaves = [] {
        std::map<PartLabel, Leaf> all;
        for (int p = 0; p < kPartCount; ++p) {
          const auto label = static_cast<PartLabel>(p);
          all[label].probability[index(label)] = 255;
        }
        return all;
      }();
      pixels.push_back({.point = point, .area_m2 = 1e-4F, .leaves = {&leaves.at(part)}});
    }
  };
  [[nodiscard]] Seen seen() const {
    const Skeleton truth = skeleton();
    Seen out;
    for (float s = 0.05F; s < 1; s += 0.1F) {
      for (float t = 0.05F; t < 1; t += 0.1F) {
        const float half = 0.19F - 0.09F * t;
        out.add(placed({half * (1 - 2 * s), -0.5F * (1 - t), -0.11F}),
                s < 0.5F ? PartLabel::LeftClavicle : PartLabel::RightClavicle);
      }
    }
    const auto bone = [&](JointId from, JointId to, PartLabel part) {
      const Vector3f a = truth[from].position, b = truth[to].position;
      const Vector3f along = (b - a).normalized();
      const Vector3f sideways = along.cross(Vector3f::UnitZ()).normalized(), ahead = sideways.cross(along).normalized();
      for (float t = 0.02F; t < 1; t += 0.04F) {
        for (float angle = -1.2F; angle < 1.3F; angle += 0.3F) {
          const Vector3f outwards = std::sin(angle) * sideways + std::cos(angle) * (ahead.z() < 0 ? ahead : -ahead);
          out.add(a + t * (b - a) + 0.07F * outwards, part);
        }
      }
    };
    bone(LeftHip, LeftKnee, PartLabel::LeftThigh);
    bone(LeftKnee, LeftAnkle, PartLabel::LeftShin);
    bone(RightHip, RightKnee, PartLabel::RightThigh);
    bone(RightKnee, RightAnkle, PartLabel::RightShin);
    return out;
  }
};

BodyFit learned() {
  BodyFit fit;
  const Doll doll;
  const Doll::Seen seen = doll.seen();
  for (int i = 0; i < 15; ++i) fit.learn(seen.votes(), doll.skeleton());
  return fit;
}

float worst(const Skeleton& a, const Skeleton& b) {
  float most = 0;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    most = std::max(most, (a.joints[j].position - b.joints[j].position).norm());
  }
  return most;
}

TEST(BodyFit, MovesNobodyWhoStandsAsAtRest) {
  BodyFit fit = learned();
  const Doll doll;
  Skeleton skeleton = doll.skeleton();
  fit.apply(doll.seen().votes(), skeleton);
  EXPECT_LT(worst(skeleton, doll.skeleton()), 0.002F);
}

TEST(BodyFit, TurnsATrunkAsFarAsItsSurfaceIsTurned) {
  BodyFit fit = learned();
  const Doll turned{.turn_rad = 0.35F}, said{.turn_rad = 0.25F};
  Skeleton skeleton = said.skeleton();
  fit.apply(turned.seen().votes(), skeleton);
  const auto turn = [&](JointId left, JointId right) {
    const Vector3f across = skeleton[left].position - skeleton[right].position;
    return std::atan2(-across.z(), across.x());
  };
  EXPECT_NEAR(turn(LeftShoulder, RightShoulder), 0.35F, 0.03F);
  EXPECT_NEAR(turn(LeftHip, RightHip), 0.35F, 0.03F);
}

TEST(BodyFit, BringsAKneeForwardWithItsShinAndThighAndWhatLiesBetween) {
  BodyFit fit = learned();
  const Doll lifted{.left_knee = {0, -0.01F, -0.10F}}, said{.left_knee = {0, -0.01F, -0.06F}};
  Skeleton skeleton = said.skeleton();
  fit.apply(lifted.seen().votes(), skeleton);
  EXPECT_NEAR(skeleton[LeftKnee].position.z(), 2.5F - 0.10F, 0.012F);
  EXPECT_NEAR(skeleton[RightKnee].position.z(), 2.5F, 0.003F);
  EXPECT_NEAR(skeleton[LeftThigh].position.z() - said.skeleton()[LeftThigh].position.z(),
              0.5F * (skeleton[LeftKnee].position.z() - said.skeleton()[LeftKnee].position.z() +
                      skeleton[LeftHip].position.z() - said.skeleton()[LeftHip].position.z()),
              1e-5F);
}

TEST(BodyFit, BelievesNoPixelsThatLieFarOffTheSurface) {
  BodyFit fit = learned();
  const Doll doll;
  Doll::Seen seen = doll.seen();
  for (int i = 0; i < 100; ++i) {  // something held before a thigh
    const auto at = static_cast<float>(i) / 100;
    seen.add(doll.placed({0.10F, 0.1F + 0.2F * at, -0.22F}), PartLabel::LeftThigh);
  }
  Skeleton skeleton = doll.skeleton();
  fit.apply(seen.votes(), skeleton);
  EXPECT_LT(worst(skeleton, doll.skeleton()), 0.006F);
}

TEST(BodyFit, DoubtsJointsThatAreLittleTrustedFirst) {
  const auto knee_after = [](float confidence) {
    BodyFit fit = learned();
    const Doll lifted{.left_knee = {0, -0.01F, -0.10F}}, said{.left_knee = {0, -0.01F, -0.04F}};
    Skeleton skeleton = said.skeleton();
    skeleton[LeftKnee].confidence = confidence;
    fit.apply(lifted.seen().votes(), skeleton);
    return skeleton[LeftKnee].position.z();
  };
  EXPECT_LT(knee_after(0.1F), knee_after(0.9F));
}

TEST(BodyFit, LeavesLostJointsAndThosePeopleWhomItDoesNotKnow) {
  BodyFit fit = learned();
  const Doll turned{.turn_rad = 0.35F}, said{.turn_rad = 0.25F};
  Skeleton skeleton = said.skeleton();
  skeleton[LeftKnee].state = skeleton[RightHip].state = JointState::Lost;
  const Skeleton before = skeleton;
  fit.apply(turned.seen().votes(), skeleton);
  EXPECT_EQ(skeleton[LeftKnee].position, before[LeftKnee].position);
  EXPECT_EQ(skeleton[RightHip].position, before[RightHip].position);
  fit.reset();
  EXPECT_FALSE(fit.settled());
  Skeleton stranger = said.skeleton();
  fit.apply(turned.seen().votes(), stranger);
  EXPECT_EQ(worst(stranger, said.skeleton()), 0);
}

TEST(BodyFit, IsNotHeldByWhatIsLost) {
  BodyFit fit = learned();
  const Doll doll;
  Skeleton skeleton = doll.skeleton();
  skeleton[LeftAnkle].state = JointState::Lost;
  skeleton[LeftAnkle].position += Vector3f(0.5F, 0, 0);
  const Vector3f knee = skeleton[LeftKnee].position;
  fit.apply(doll.seen().votes(), skeleton);
  EXPECT_LT((skeleton[LeftKnee].position - knee).norm(), 0.003F);
}

TEST(BodyFit, KnowsALengthHoweverLongItCouldNotBeMeasured) {
  BodyFit fit = learned();
  const Doll doll;
  const Doll::Seen seen = doll.seen();
  Skeleton hidden = doll.skeleton();
  hidden[LeftAnkle].state = hidden[RightAnkle].state = JointState::Lost;
  for (int i = 0; i < 3000; ++i) fit.learn(seen.votes(), hidden);
  Skeleton skeleton = doll.skeleton();
  fit.apply(seen.votes(), skeleton);
  EXPECT_LT(worst(skeleton, doll.skeleton()), 0.002F);
}

TEST(BodyFit, StaysFiniteWhereNothingIsSeenOrAllJointsAreOne) {
  BodyFit fit = learned();
  Skeleton skeleton = Doll{}.skeleton();
  fit.apply({}, skeleton);
  EXPECT_LT(worst(skeleton, Doll{}.skeleton()), 0.002F);
  const Doll::Seen seen = Doll{}.seen();
  for (Joint& joint : skeleton.joints) joint.position = {0, 0, 2.5F};
  fit.apply(seen.votes(), skeleton);
  for (const Joint& joint : skeleton.joints) EXPECT_TRUE(joint.position.allFinite());
}

TEST(BodyFit, AllocatesNothing) {
  BodyFit fit = learned();
  const Doll doll;
  const Doll::Seen seen = doll.seen();
  Skeleton skeleton = doll.skeleton();
  const std::size_t before = test::allocations;
  fit.learn(seen.votes(), skeleton);
  fit.apply(seen.votes(), skeleton);
  EXPECT_EQ(test::allocations, before);
}

}  // namespace
}  // namespace armature
