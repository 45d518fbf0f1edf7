#include "tools/evaluation/real_report.h"

#include <array>
#include <cstdio>
#include <numbers>
#include <span>

#include "tools/evaluation/chart.h"
#include "tools/output_file.h"

namespace armature::tools {
namespace {

constexpr double kCentimetres = 100;
constexpr double kDegrees = 180 / std::numbers::pi;

std::string name(JointId joint) {
  return std::string(kJointNames[index(joint)]);
}

Json to_json(const JointDeviation& d) {
  return {{"median_m", number(d.median_m)}, {"p90_m", number(d.p90_m)}};
}

Json to_json(const AngleCorrelation& c) {
  return {{"mean", number(c.mean)}, {"median", number(c.median)}, {"sequences", c.sequences}};
}

Json to_json(const SurfaceAgreement& agreement) {
  return {{"ours", to_json(agreement.ours)},
          {"sdk", to_json(agreement.sdk)},
          {"share_of_ours", number(agreement.share_of_ours)},
          {"share_of_sdk", number(agreement.share_of_sdk)}};
}

Json to_json(const RealAgreement& agreement) {
  Json joints, motions;
  for (std::size_t j = 0; j < kNavigationJoints.size(); ++j) {
    joints[name(kNavigationJoints[j])] = to_json(agreement.joints[j]);
  }
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    motions[std::string(kMotionNames[m])] = to_json(agreement.correlation[m]);
  }
  return {{"all", to_json(agreement.all)},
          {"knees", to_json(agreement.knees)},
          {"within_15_cm", number(agreement.within_15_cm)},
          {"joints", joints},
          {"correlation", motions}};
}

Json to_json(const RealEvaluation& real, const char* system) {
  return {{"data", "real"},
          {"system", system},
          {"sequences", real.sequences.size()},
          {"frames", real.frames},
          {"frames_tracked", number(real.frames_tracked)},
          {"joints_observed", number(real.joints_observed)},
          {"frame_us", {{"p50", number(real.p50_us)}, {"p99", number(real.p99_us)}}},
          {"as_is", to_json(real.as_is)},
          {"sdk_delayed", to_json(real.delayed)},
          {"filtered", to_json(real.filtered)},
          {"filtered_sdk_delayed", to_json(real.filtered_delayed)},
          {"imitating", to_json(real.imitating)},
          {"imitating_filtered_sdk_delayed", to_json(real.imitating_filtered_delayed)},
          {"surface", {{"shoulders", to_json(real.shoulders_surface)}, {"hips", to_json(real.hips_surface)}}}};
}

Json to_json(const SequenceAgreement& sequence, const char* system) {
  Json motions;
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    motions[std::string(kMotionNames[m])] = {{"sdk_span_deg", number(kDegrees * sequence.sdk_span_rad[m])},
                                             {"our_span_deg", number(kDegrees * sequence.our_span_rad[m])},
                                             {"correlation", number(sequence.correlation[m])},
                                             {"correlation_delayed", number(sequence.correlation_delayed[m])}};
  }
  return {{"data", "real_sequence"},
          {"system", system},
          {"name", sequence.name},
          {"frames", sequence.frames},
          {"median_m", number(sequence.median_m)},
          {"motions", motions}};
}

/// What is printed beside one another.
struct Column {
  const char* title;
  const RealAgreement& agreement;
};

template <class Of>
void print_deviation(const std::string& title, std::span<const Column> columns, const Of& deviation_of) {
  std::printf("  %-18s", title.c_str());
  for (const Column& column : columns) {
    const JointDeviation d = deviation_of(column.agreement);
    std::printf("   %6.2f /%6.2f", kCentimetres * d.median_m, kCentimetres * d.p90_m);
  }
  std::printf("\n");
}

}  // namespace

void print_real(const RealComparison& real) {
  const RealEvaluation &ours = real.ours, &paper = real.paper;
  std::printf(
      "\n%zu recordings of real people, %d frames, given their pixels, against the Kinect SDK's joints\n"
      "  frames tracked %.3f (paper %.3f), navigation joints observed %.3f (%.3f)\n"
      "  forest and joints, ms a frame: p50 %.2f p99 %.2f (paper: p50 %.2f p99 %.2f)\n",
      ours.sequences.size(), ours.frames, ours.frames_tracked, paper.frames_tracked, ours.joints_observed,
      paper.joints_observed, ours.p50_us / 1000, ours.p99_us / 1000, paper.p50_us / 1000, paper.p99_us / 1000);
  const std::array<Column, 8> columns = {{{"ours as is", ours.as_is},
                                          {"SDK delayed", ours.delayed},
                                          {"ours filtered", ours.filtered},
                                          {"SDK delayed", ours.filtered_delayed},
                                          {"paper as is", paper.as_is},
                                          {"SDK delayed", paper.delayed},
                                          {"imitating *", ours.imitating},
                                          {"filt., delayed *", ours.imitating_filtered_delayed}}};
  const auto head = [&](const char* row, const auto& cell) {
    std::printf("  %-18s", row);
    for (const Column& column : columns) std::printf("%17s", cell(column));
  };
  head("", [](const Column& column) { return column.title; });
  std::printf("\n");
  head("deviation, cm", [](const Column&) { return "p50 /  p90"; });
  std::printf("\n");
  for (std::size_t j = 0; j < kNavigationJoints.size(); ++j) {
    print_deviation(name(kNavigationJoints[j]), columns, [j](const RealAgreement& a) { return a.joints[j]; });
  }
  print_deviation("knees", columns, [](const RealAgreement& a) { return a.knees; });
  print_deviation("all", columns, [](const RealAgreement& a) { return a.all; });
  std::printf("  %-18s", "within 15 cm");
  for (const Column& column : columns) std::printf("%17.3f", column.agreement.within_15_cm);
  std::printf("\n");
  head("correlation", [](const Column&) { return "mean / median"; });
  std::printf("   sequences\n");
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    std::printf("  %-18s", std::string(kMotionNames[m]).c_str());
    for (const Column& column : columns) {
      const AngleCorrelation& c = column.agreement.correlation[m];
      std::printf("     %5.2f / %4.2f", c.mean, c.median);
    }
    std::printf("%12d\n", ours.as_is.correlation[m].sequences);
  }
  std::printf(
      "  * moved by a regression that learned from the SDK's joints of the other people how it sees ours: what "
      "imitating\n"
      "    the SDK would give, as is, and filtered with the SDK delayed; nothing like it is part of the model\n");
  std::printf(
      "  turn of the surface itself, which knows no joints: correlation, mean / median, and its share of the turn\n");
  const auto print_surface = [](const char* row, const SurfaceAgreement& surface) {
    const auto side = [](const char* whose, const AngleCorrelation& c, double share) {
      std::printf("   %s %5.2f / %4.2f, share %4.2f", whose, c.mean, c.median, share);
    };
    std::printf("  %-18s", row);
    side("ours", surface.ours, surface.share_of_ours);
    side("the SDK", surface.sdk, surface.share_of_sdk);
    std::printf("%12d\n", surface.ours.sequences);
  };
  print_surface("shoulders", ours.shoulders_surface);
  print_surface("hips", ours.hips_surface);
}

Expected<void> write_real_json(const RealComparison& real) {
  const auto write = [](const RealEvaluation& one, const char* system) -> Expected<void> {
    if (auto written = write_json_line(stdout, to_json(one, system)); !written) return written;
    for (const SequenceAgreement& sequence : one.sequences) {
      if (auto written = write_json_line(stdout, to_json(sequence, system)); !written) return written;
    }
    return {};
  };
  if (auto written = write(real.ours, "mask"); !written) return written;
  return write(real.paper, "paper");
}

Expected<void> write_real_plots(const RealComparison& real, const std::filesystem::path& folder) {
  std::vector<std::string> joints, motions;
  std::vector<Series> deviation = {{.name = "ours", .values = {}, .colour = 1},
                                   {.name = "just the paper", .values = {}, .colour = 2}},
                      correlation = deviation;
  const auto add = [](const RealAgreement& agreement, Series& deviations, Series& correlations) {
    for (const JointDeviation& joint : agreement.joints) deviations.values.push_back(kCentimetres * joint.p90_m);
    for (const AngleCorrelation& motion : agreement.correlation) {
      correlations.values.push_back(std::max(0.0, motion.median));
    }
  };
  add(real.ours.delayed, deviation[0], correlation[0]);
  add(real.paper.delayed, deviation[1], correlation[1]);
  for (const JointId joint : kNavigationJoints) joints.push_back(name(joint));
  for (const std::string_view motion : kMotionNames) motions.emplace_back(motion);
  const auto saved = write_file((folder / "real_deviation.svg").string(),
                                bar_chart({.title = "Deviation from the Kinect SDK on real people",
                                           .x_axis = "90th percentile, cm, SDK joints delayed by 1.5 frames",
                                           .y_axis = ""},
                                          joints, deviation));
  if (!saved) return saved;
  return write_file((folder / "real_correlation.svg").string(),
                    bar_chart({.title = "Correlation of motion angles with the Kinect SDK's on real people",
                               .x_axis = "median over sequences, SDK joints delayed by 1.5 frames",
                               .y_axis = ""},
                              motions, correlation));
}

}  // namespace armature::tools
