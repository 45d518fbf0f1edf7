#include "tools/evaluation/forest_evaluation.h"

#include <cstdio>
#include <memory>

#include "tools/evaluation/real_evaluation.h"
#include "tools/evaluation/synthetic_evaluation.h"
#include "tools/json_lines.h"
#include "tools/progress.h"
#include "tracker/synth/training_images.h"

namespace armature::tools {
namespace {

constexpr double kCentimetres = 100;

std::string name(JointId joint) {
  return std::string(kJointNames[index(joint)]);
}

Json to_json(const JointAccuracy& a) {
  return {{"mean_error_m", number(a.mean_error_m)},
          {"median_error_m", number(a.median_error_m)},
          {"p90_error_m", number(a.p90_error_m)},
          {"average_precision", number(a.average_precision)}};
}

Json to_json(const SyntheticAccuracy& accuracy) {
  Json joints;
  for (std::size_t j = 0; j < kJointCount; ++j) joints[std::string(kJointNames[j])] = to_json(accuracy.joints[j]);
  return {{"data", "synthetic"},
          {"images", accuracy.images},
          {"pixels_right", number(accuracy.pixels_right)},
          {"navigation", to_json(accuracy.navigation)},
          {"all", to_json(accuracy.all)},
          {"joints", joints}};
}

Json to_json(const JointDeviation& d) {
  return {{"median_m", number(d.median_m)}, {"p90_m", number(d.p90_m)}};
}

Json to_json(const RealAgreement& agreement) {
  Json joints, motions;
  for (std::size_t j = 0; j < kNavigationJoints.size(); ++j) {
    joints[name(kNavigationJoints[j])] = to_json(agreement.joints[j]);
  }
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    motions[std::string(kMotionNames[m])] = number(agreement.correlation[m]);
  }
  return {{"all", to_json(agreement.all)},
          {"knees", to_json(agreement.knees)},
          {"within_15_cm", number(agreement.within_15_cm)},
          {"joints", joints},
          {"correlation", motions}};
}

Json to_json(const RealEvaluation& real) {
  return {{"data", "real"},
          {"sequences", real.sequences},
          {"frames", real.frames},
          {"frames_tracked", number(real.frames_tracked)},
          {"joints_observed", number(real.joints_observed)},
          {"frame_us", {{"p50", number(real.p50_us)}, {"p99", number(real.p99_us)}}},
          {"as_is", to_json(real.as_is)},
          {"sdk_delayed", to_json(real.delayed)}};
}

void print_row(const std::string& title, const JointAccuracy& a) {
  std::printf("  %-16s %8.1f %8.1f %8.1f %8.3f\n", title.c_str(), kCentimetres * a.mean_error_m,
              kCentimetres * a.median_error_m, kCentimetres * a.p90_error_m, a.average_precision);
}

void print(const SyntheticAccuracy& accuracy) {
  std::printf("%d synthetic people, single frames; parts right in %.3f of pixels\n", accuracy.images,
              accuracy.pixels_right);
  std::printf("  %-16s %8s %8s %8s %8s\n", "error, cm", "mean", "median", "p90", "AP@10");
  for (std::size_t j = 0; j < kJointCount; ++j) print_row(std::string(kJointNames[j]), accuracy.joints[j]);
  print_row("navigation", accuracy.navigation);
  print_row("all", accuracy.all);
}

void print(const RealEvaluation& real) {
  std::printf(
      "%d recordings of real people, %d frames against the Kinect SDK's joints\n"
      "  frames tracked %.3f, navigation joints observed %.3f, forest and joints %.2f ms (p99 %.2f)\n",
      real.sequences, real.frames, real.frames_tracked, real.joints_observed, real.p50_us / 1000, real.p99_us / 1000);
  std::printf("  %-18s %18s %18s\n", "deviation, cm", "as is  p50/p90", "delayed  p50/p90");
  const auto row = [](const std::string& title, const JointDeviation& a, const JointDeviation& b) {
    std::printf("  %-18s %10.2f / %5.2f %10.2f / %5.2f\n", title.c_str(), kCentimetres * a.median_m,
                kCentimetres * a.p90_m, kCentimetres * b.median_m, kCentimetres * b.p90_m);
  };
  for (std::size_t j = 0; j < kNavigationJoints.size(); ++j) {
    row(name(kNavigationJoints[j]), real.as_is.joints[j], real.delayed.joints[j]);
  }
  row("knees", real.as_is.knees, real.delayed.knees);
  row("all", real.as_is.all, real.delayed.all);
  std::printf("  %-18s %18.3f %18.3f\n", "within 15 cm", real.as_is.within_15_cm, real.delayed.within_15_cm);
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    std::printf("  r %-16s %18.2f %18.2f\n", std::string(kMotionNames[m]).c_str(), real.as_is.correlation[m],
                real.delayed.correlation[m]);
  }
}

}  // namespace

TrainingImage synthetic_image(std::uint64_t seed) {
  thread_local TrainingSampler sampler{TrainingOptions{}};
  thread_local LabelledImage labelled;
  sampler.sample(seed, labelled);
  return {labelled.intrinsics, labelled.depth_mm, labelled.user, labelled.part, labelled.joints};
}

Expected<void> evaluate_forest(const EvaluationOptions& options, bool json) {
  auto forest = Forest::load(options.model);
  if (!forest) return tl::unexpected(forest.error());
  SkeletonTracker tracker(std::make_shared<const Forest>(std::move(*forest)), options.stride);
  if (options.image_count > 0) {
    ProgressBar bar({.title = "synthetic people"});
    const auto accuracy = evaluate_synthetic(tracker, options.image_count, bar.callback());
    bar.finish();
    if (!json) {
      print(accuracy);
    } else if (const auto written = write_json_line(stdout, to_json(accuracy)); !written) {
      return written;
    }
  }
  if (options.utd_folder.empty()) return {};
  ProgressBar bar({.title = "real people"});
  const auto real = evaluate_real(tracker, options.utd_folder, options.all_actions, bar.callback());
  bar.finish();
  if (!real) return tl::unexpected(real.error());
  if (json) return write_json_line(stdout, to_json(*real));
  print(*real);
  return {};
}

}  // namespace armature::tools
