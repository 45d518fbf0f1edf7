#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "firmware_host/depth_frame.h"
#include "tracker/body/body_parts.h"
#include "tracker/synth/kinect_noise.h"
#include "tracker/synth/random_poses.h"
#include "tracker/synth/render.h"

namespace armature {

struct TrainingOptions {
  int width = 320;
  int height = 240;
  double nearest_m = 1.2;
  double farthest_m = 4.0;
  double turned_deg = 60;         ///< people face the camera within +- this
  double occluded = 0.16;         ///< share of images in which furniture stands before the person
  double company = 0.12;          ///< share in which somebody else stands beside, before or behind her
  double wheelchair = 0.3;        ///< share of those who sit
  double vary_intrinsics = 0.04;  ///< focal lengths vary by this share
  bool carries = true;            ///< bags, backpacks, mugs
  SensorOptions sensor;
};

/// One labelled person. Arrays [height][width].
struct LabelledImage {
  Intrinsics intrinsics;
  std::vector<std::uint16_t> depth_mm;  ///< all that the sensor saw, 0 = no return
  std::vector<std::uint8_t> user;       ///< 1 where a segmentation would see the user: body, what it carries, and some
                                        ///< of the floor at the feet, of which it misses a little
  std::vector<std::uint8_t> part;       ///< PartLabel, or kNoPart where the pixel is no part of the body
  std::array<Eigen::Vector3f, kJointCount> joints;  ///< camera frame, metres; also those that are hidden or outside
  Activity activity = Activity::Stand;
  int person_pixels = 0;  ///< pixels with a part
};

/// Draws labelled images of people, each from its own seed: person, pose, camera, occluders and noise. The domain:
/// standing, the seven motions, walking, jogging, lunges, squats, sitting, reaching; arms doing anything; children;
/// bags; wheelchairs; somebody else beside, before or behind; turned up to 60 degrees; 1.2 to 4 m. Deterministic: the
/// image depends on options and seed (without its bit kHeldOut) alone. Holds buffers: one sampler a thread.
class TrainingSampler {
 public:
  explicit TrainingSampler(const TrainingOptions& options) : options_(options) {}

  /// `at_rest`, where wanted, gets the same person before the same camera, but at rest: behind the same furniture, on
  /// the same kind of seat, and beside the same company or not.
  void sample(std::uint64_t seed, LabelledImage& out, LabelledImage* at_rest = nullptr);

 private:
  bool try_sample(Random& random, std::uint64_t seed, bool at_rest, LabelledImage& out);
  void render_somebody(const Person& person, const PosedBody& body, const RigidTransform& camera_from_body,
                       std::uint8_t owner);

  TrainingOptions options_;
  KinectSensor sensor_;
  SurfaceImage image_;
  SensedImage sensed_;
  std::vector<SurfaceEdge> edges_;
};

/// Where segmentation errs: keeps the person's pixels except some blocks of the lowest centimetres of the feet, adds
/// blocks of floor around them. `floor_up` and `floor_offset`: the floor's plane in the camera frame. Mask values are
/// 0 and 1.
void mask_with_ragged_feet(const SurfaceImage& image, const SensedImage& sensed, std::uint8_t owner,
                           const Eigen::Vector3d& floor_up, double floor_offset,
                           const std::array<Eigen::Vector3d, 2>& feet, std::uint64_t seed,
                           std::vector<std::uint8_t>& mask);

}  // namespace armature
