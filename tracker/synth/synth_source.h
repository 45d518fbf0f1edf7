#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "firmware_host/backends/pacer.h"
#include "firmware_host/depth_source.h"
#include "tracker/body/skeleton.h"
#include "tracker/motions/motion_options.h"
#include "tracker/motions/receptors.h"
#include "tracker/synth/actor.h"
#include "tracker/synth/kinect_noise.h"
#include "tracker/synth/render.h"

namespace armature {

/// How a script is shown. In a URI: `synth:NAME?seed=7&size=640x480&fps=30&...`.
struct SynthOptions {
  std::uint64_t seed = 1;  ///< person, clothes, room, camera, noise
  int width = 640;         ///< size=WxH
  int height = 480;
  double fps = 30;
  double turned_deg = 0;  ///< the user faces so far to her left of the camera
  double distance_m = 0;  ///< 0: such that she is wholly in view
  double noise = 1;       ///< strength; 0 = an ideal camera
  Outfit::Bag carry = Outfit::Bag::None;
  Side carry_side = Side::Right;
  PersonWish wish = {};        ///< who the user is
  bool furnished = true;       ///< the room
  double occluded = 0;         ///< share of the user that furniture before her hides, in [0, 0.6]
  bool occluded_below = true;  ///< by a counter, from below; otherwise by a pillar, from one side
};

/// What is true in a frame.
struct FrameTruth {
  bool present = false;  ///< the user is in the room
  Skeleton skeleton;     ///< camera frame; confidence 1; state Observed where the joint's place is seen, Inferred where
                         ///< it is hidden or outside the image, Lost where the user is not present
  MotionAngles motions;  ///< by motion_angles() from the true joints against the true rest pose
  PerMotion<float> normalized{};        ///< angle over range (MotionOptions), clamped to [-1, 1]
  std::span<const std::uint8_t> part;   ///< [height][width], PartLabel of the user's pixels or kNoPart
  std::span<const std::uint8_t> owner;  ///< [height][width], 1 = the user (and what she carries), 2... = others
};

/// A named script, played by a synthetic person in a room with furniture before a Kinect v1. The same options give the
/// same bytes. Thread-safe: no. Realtime-safe: no.
class SynthSource final : public DepthSource {
 public:
  /// `name_and_options` is the URI without `synth:`. Fails with one line for an unknown name or a wrong option.
  [[nodiscard]] static Expected<std::unique_ptr<SynthSource>> open(std::string_view name_and_options,
                                                                   const OpenOptions& options = {});
  [[nodiscard]] static Expected<std::unique_ptr<SynthSource>> open(const Script& script, const SynthOptions& synth,
                                                                   const OpenOptions& options = {});

  [[nodiscard]] const SourceInfo& info() const noexcept override { return info_; }
  [[nodiscard]] Expected<ReadStatus> read(DepthFrame& frame, std::chrono::milliseconds timeout) override;

  /// Of the frame that was read last; valid until the next read.
  [[nodiscard]] const FrameTruth& truth() const noexcept { return truth_; }
  [[nodiscard]] const RestPose& rest() const noexcept { return rest_; }
  [[nodiscard]] const Script& script() const noexcept { return script_; }
  [[nodiscard]] const Person& user() const noexcept { return actors_.front().person(); }

 private:
  SynthSource(const Script& script, const SynthOptions& synth, const OpenOptions& options);
  void place_actors();
  void place_room(Random& random, double stature, double distance, double camera_height);
  void place_seat(const Actor& actor, Posture posture, const RigidTransform& where);
  void calibrate();
  /// The joints of a body in the camera frame, all of them observed.
  [[nodiscard]] Skeleton true_skeleton(const PosedBody& body, const RigidTransform& camera_from_body) const;
  void render_actor(const Actor& actor, const Pose& pose, const RigidTransform& world_from_body, std::uint8_t owner);
  [[nodiscard]] Eigen::Vector3f torso_centre() const;
  void judge_visibility();

  Script script_;
  SynthOptions synth_;
  SourceInfo info_;
  std::shared_ptr<Clock> clock_;
  Pacer pacer_;
  std::vector<Actor> actors_;
  RigidTransform camera_from_world_, where_;
  RestPose rest_;
  MotionOptions motion_options_;
  SurfaceImage empty_room_, image_;
  KinectSensor sensor_;
  SensedImage sensed_;
  std::vector<SurfaceEdge> edges_;
  std::vector<std::uint8_t> part_, owner_;
  FrameTruth truth_;
  long next_frame_ = 0;
};

/// One line a script and one an option, for --help.
[[nodiscard]] std::string describe_scripts();

}  // namespace armature
