#include "tools/evaluation/scene_evaluation.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>

#include "tools/elapsed.h"
#include "tools/evaluation/paper_tracker.h"
#include "tracker/joints/skeleton_filter.h"
#include "tracker/pipeline.h"

namespace armature::tools {
namespace {

constexpr std::uint8_t kUser = 1;  // FrameTruth::owner

bool in_view(const Eigen::Vector3f& joint, const Intrinsics& k) noexcept {
  const double u = k.centre_x_px + k.focal_x_px * static_cast<double>(joint.x() / joint.z());
  const double v = k.centre_y_px + k.focal_y_px * static_cast<double>(joint.y() / joint.z());
  return joint.z() > 0 && u >= 0 && v >= 0 && u < k.width && v < k.height;
}

/// The true skeleton with whatever lies outside the image lost.
Skeleton truth_in_view(const Skeleton& truth, const Intrinsics& k) noexcept {
  Skeleton out = truth;
  for (Joint& joint : out.joints) {
    if (!in_view(joint.position, k)) joint.state = JointState::Lost;
  }
  return out;
}

/// What a system says of a frame.
struct Answer {
  const Skeleton* skeleton = nullptr;      ///< null where nobody is tracked
  const Navigation* navigation = nullptr;  ///< null before the rest pose is known
  double us = 0;
};

/// Gathers what one system says in one scene.
class Recorder {
 public:
  Recorder(const Scene& scene, SystemRecord& out) : resting_(scene.activity == "still"), out_(out) {}

  void add(const FrameTruth& truth, const Skeleton& visible, const Answer& answer) {
    ++out_.frames;
    out_.frame_us.push_back(answer.us);
    if (answer.skeleton != nullptr) ++out_.tracked;
    add_joints(visible, answer.skeleton);
    swaps_.add(visible, answer.skeleton);
    out_.swaps = swaps_.count();
    if (answer.skeleton == nullptr || answer.navigation == nullptr) return;
    for (std::size_t m = 0; m < kMotionCount; ++m) {
      const auto motion = static_cast<MotionId>(m);
      if (motion == MotionId::RotateBust || weakest_state(visible, motion) == JointState::Lost) continue;
      const float error = answer.navigation->motions[m].angle_rad - truth.motions.angle_rad[m];
      out_.motions.push_back({motion, std::abs(error)});
    }
    if (!resting_) return;
    ++out_.rest_frames;
    const CameraVelocity& velocity = answer.navigation->velocity;
    out_.standing += velocity.linear_m_s == 0 && velocity.angular_rad_s == 0 ? 1 : 0;
  }

 private:
  void add_joints(const Skeleton& visible, const Skeleton* found) {
    const float distance = visible[JointId::Torso].position.z();
    for (std::size_t j = 0; j < kJointCount; ++j) {
      const auto id = static_cast<JointId>(j);
      if (visible[id].state == JointState::Lost) continue;
      JointSample sample{.joint = id, .distance_m = distance};
      if (found != nullptr && (*found)[id].state != JointState::Lost) {
        sample.given = true;
        sample.error_m = ((*found)[id].position - visible[id].position).norm();
        sample.confidence = (*found)[id].confidence;
      }
      out_.joints.push_back(sample);
    }
  }

  bool resting_;
  SystemRecord& out_;
  SwapCounter swaps_;
};

NavigationOptions unfiltered() {
  NavigationOptions options;
  options.motions = of_true_joints(options.motions);
  options.motions.filter = {.min_cutoff_hz = 1e6F, .speed_coefficient = 0, .derivative_cutoff_hz = 1};
  return options;
}

RestOptions automatic_rest() {
  RestOptions options;
  options.mode = RestMode::Auto;
  return options;
}

TrackerOptions pipeline_options(const SceneOptions& options) {
  TrackerOptions out;
  out.forest.stride = options.stride;
  out.rest = automatic_rest();
  return out;
}

/// Forest and joints given the true mask, with what the pipeline does after them.
template <class Tracker>
struct MaskedTracker {
  Tracker tracker;
  Navigator navigator;
  std::optional<SkeletonFilter> filter;  ///< of the skeleton that is published
  Skeleton published = {};

  void reset(const Intrinsics& k) {
    tracker.reset(k);
    navigator.start_over();
    if (filter) filter->reset();
  }

  Answer process(DepthView frame, std::span<const std::uint8_t> mask, const Eigen::Vector3f& up) {
    const auto start = std::chrono::steady_clock::now();
    published = tracker.track(frame, mask);
    const double us = 1000 * milliseconds_since(start);
    if (!tracked(published)) {
      navigator.stop();
      return {nullptr, nullptr, us};
    }
    const Navigation& navigation = navigator.process(published, up, frame.sensor.time);
    if (filter) filter->filter(published, frame.sensor.time);
    return {&published, navigator.rest().rest() ? &navigation : nullptr, us};
  }
};

/// All systems, fresh for one scene.
class Bench {
 public:
  Bench(const std::shared_ptr<const Forest>& forest, const std::shared_ptr<const Forest>& paper_forest,
        const SceneOptions& options)
      : pipeline_(forest, pipeline_options(options)),
        ours_{{forest, options.stride}, {NavigationOptions{}, automatic_rest()}, SkeletonFilter{}},
        paper_{{paper_forest, options.stride}, {unfiltered(), automatic_rest()}, std::nullopt} {}

  Expected<SceneRecord> play(const Scene& scene, SynthSource& source) {
    const Intrinsics k = source.info().intrinsics;
    const Eigen::Vector3f up = source.rest().frame.up;
    pipeline_.reset(k);
    ours_.reset(k);
    paper_.reset(k);
    SceneRecord record;
    std::array<Recorder, kSystemCount> recorders = {
        Recorder(scene, record.systems[0]), Recorder(scene, record.systems[1]), Recorder(scene, record.systems[2])};
    DepthFrame frame;
    while (true) {
      const auto status = source.read(frame, std::chrono::milliseconds(0));
      if (!status) return tl::unexpected(status.error());
      if (*status != ReadStatus::Frame) return record;
      const FrameTruth& truth = source.truth();
      mask_.assign(truth.owner.size(), 0);
      for (std::size_t i = 0; i < mask_.size(); ++i) mask_[i] = truth.owner[i] == kUser ? 1 : 0;

      const std::array<Answer, kSystemCount> answers = {whole(frame.view()), ours_.process(frame.view(), mask_, up),
                                                        paper_.process(frame.view(), mask_, up)};
      if (frame.sensor.time < std::chrono::duration<double>(Scene::kRest_s)) continue;
      const Skeleton visible = truth_in_view(truth.skeleton, k);
      for (std::size_t s = 0; s < kSystemCount; ++s) recorders[s].add(truth, visible, answers[s]);
      count_pixels(truth, k.width, record);
    }
  }

 private:
  Answer whole(DepthView frame) {
    const auto start = std::chrono::steady_clock::now();
    const TrackerOutput& out = pipeline_.process(frame);
    return {out.tracking ? &out.skeleton : nullptr, out.state == EngagementState::Engaged ? &out.navigation : nullptr,
            1000 * milliseconds_since(start)};
  }

  void count_pixels(const FrameTruth& truth, int width, SceneRecord& record) const {
    for (const ClassifiedPixel& pixel : ours_.tracker.votes().pixels) {
      const std::uint8_t part = truth.part[pixel.v * static_cast<std::size_t>(width) + pixel.u];
      if (part == kNoPart) continue;
      ++record.pixels;
      record.pixels_right += index(most_likely_part(pixel)) == part ? 1 : 0;
    }
  }

  Pipeline pipeline_;
  MaskedTracker<SkeletonTracker> ours_;
  MaskedTracker<PaperTracker> paper_;
  std::vector<std::uint8_t> mask_;
};

}  // namespace

void SwapCounter::add(const Skeleton& truth, const Skeleton* found) noexcept {
  constexpr std::array<JointId, 3> kLeft = {JointId::LeftShoulder, JointId::LeftHip, JointId::LeftKnee};
  constexpr float kApart_m = 0.10F;
  constexpr int kLonger = 2;
  for (std::size_t i = 0; i < kLeft.size(); ++i) {
    const JointId left = kLeft[i], right = mirrored(left);
    const auto known = [&](const Skeleton& s) {
      return s[left].state != JointState::Lost && s[right].state != JointState::Lost;
    };
    bool exchanged = false;
    if (found != nullptr && known(truth) && known(*found)) {
      const auto apart = [&](JointId a, JointId b) { return ((*found)[a].position - truth[b].position).squaredNorm(); };
      exchanged = (truth[left].position - truth[right].position).norm() >= kApart_m &&
                  apart(left, right) + apart(right, left) < apart(left, left) + apart(right, right);
    }
    run_[i] = exchanged ? run_[i] + 1 : 0;
    if (run_[i] == kLonger + 1) ++count_;
  }
}

Expected<std::vector<SceneRecord>> evaluate_scenes(std::shared_ptr<const Forest> forest,
                                                   const std::vector<Scene>& scenes, const SceneOptions& options,
                                                   const std::function<void(double)>& progress,
                                                   const std::stop_token& stop) {
  std::vector<SceneRecord> records(scenes.size());
  std::atomic<std::size_t> next = 0, done = 0;
  std::mutex mutex;
  std::optional<Error> failure;
  const auto paper_forest = std::make_shared<const Forest>(paper_forest_of(*forest));
  const auto play = [&](const Scene& scene) -> Expected<SceneRecord> {
    auto source = open_scene(scene, options.width, options.height);
    if (!source) return tl::unexpected(source.error());
    return Bench(forest, paper_forest, options).play(scene, **source);
  };
  const auto work = [&] {
    for (std::size_t i = next++; i < scenes.size() && !stop.stop_requested(); i = next++) {
      auto record = play(scenes[i]);
      const std::scoped_lock lock(mutex);
      if (!record) {
        failure = record.error();
        return;
      }
      records[i] = std::move(*record);
      progress(static_cast<double>(++done) / static_cast<double>(scenes.size()));
    }
  };
  {
    std::vector<std::jthread> others;
    for (int i = 1; i < options.threads; ++i) others.emplace_back(work);
    work();
  }
  if (failure) return tl::unexpected(*failure);
  if (stop.stop_requested()) return fail("stopped after " + std::to_string(done) + " scenes; nothing was measured");
  return records;
}

}  // namespace armature::tools
