#include "tools/evaluation/scene_report.h"

#include <cstdio>

#include "tools/evaluation/chart.h"
#include "tools/evaluation/skeleton_summary.h"
#include "tools/output_file.h"

namespace armature::tools {
namespace {

constexpr double kCentimetres = 100;
constexpr std::array kSystems = {System::Whole, System::Mask, System::Paper};

template <class T>
using PerSystem = std::array<T, kSystemCount>;

PerSystem<SkeletonSummary> summaries(const PlayedScenes& played, const std::function<bool(const Scene&)>& wanted) {
  PerSystem<SkeletonSummary> out;
  for (std::size_t s = 0; s < kSystemCount; ++s) {
    out[s] = summarise(played.scenes, played.records, kSystems[s], wanted);
  }
  return out;
}
PerSystem<SkeletonSummary> summaries(const PlayedScenes& played) {
  return summaries(played, [](const Scene&) { return true; });
}
PerSystem<SkeletonSummary> summaries(const PlayedScenes& played, const std::string& category) {
  return summaries(played, [&](const Scene& scene) { return scene.category == category; });
}

double pixels_right(const PlayedScenes& played) {
  std::size_t pixels = 0, right = 0;
  for (const SceneRecord& record : played.records) {
    pixels += record.pixels;
    right += record.pixels_right;
  }
  return pixels == 0 ? 0 : static_cast<double>(right) / static_cast<double>(pixels);
}

/// What a table says of a joint, of one system after the other.
void print_joint(const std::string& title, const PerSystem<JointAccuracy>& a) {
  std::printf("  %-17s", title.c_str());
  for (const JointAccuracy& one : a) std::printf("  %6.3f", one.average_precision);
  std::printf("  ");
  for (const JointAccuracy& one : a) std::printf("  %6.1f", kCentimetres * one.mean_error_m);
  std::printf("  ");
  for (const JointAccuracy& one : a) std::printf("  %6.1f", kCentimetres * one.p90_error_m);
  std::printf("\n");
}

template <class Pick>
PerSystem<JointAccuracy> picked(const PerSystem<SkeletonSummary>& all, const Pick& pick) {
  PerSystem<JointAccuracy> out;
  for (std::size_t s = 0; s < kSystemCount; ++s) out[s] = pick(all[s]);
  return out;
}

void print_joints(const PerSystem<SkeletonSummary>& all) {
  std::printf("\n  %-17s%24s  %24s  %24s\n  %-17s", "", "mAP at 10 cm", "mean error, cm", "p90 error, cm", "");
  for (int i = 0; i < 3; ++i) std::printf("   whole    mask   paper  ");
  std::printf("\n");
  for (std::size_t j = 0; j < kJointCount; ++j) {
    print_joint(std::string(kJointNames[j]), picked(all, [&](const SkeletonSummary& s) { return s.joints[j]; }));
  }
  print_joint("navigation joints", picked(all, [](const SkeletonSummary& s) { return s.navigation; }));
  print_joint("all joints", picked(all, [](const SkeletonSummary& s) { return s.all; }));
}

void print_distances(const PlayedScenes& played) {
  PerSystem<std::vector<DistanceRow>> rows;
  for (std::size_t s = 0; s < kSystemCount; ++s) rows[s] = by_distance(played.records, kSystems[s]);
  std::printf("\n  navigation joints by distance\n");
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    std::array<char, 32> title{};
    std::snprintf(title.data(), title.size(), "%.2f to %.2f m", rows[0][i].near_m, rows[0][i].far_m);
    print_joint(title.data(), {rows[0][i].navigation, rows[1][i].navigation, rows[2][i].navigation});
  }
}

void print_category(const std::string& title, const PerSystem<SkeletonSummary>& s) {
  const SkeletonSummary& whole = s[0];
  std::printf("  %-17s%7d%9.3f", title.c_str(), whole.scenes, whole.frames_tracked);
  std::printf("  %6.3f %6.3f %6.3f", whole.navigation.average_precision, s[1].navigation.average_precision,
              s[2].navigation.average_precision);
  std::printf("%8.1f%8.3f%8.1f", kCentimetres * whole.navigation.mean_error_m, whole.all.average_precision,
              kCentimetres * whole.all.mean_error_m);
  std::printf("%8.1f%7.1f%7d", whole.motion.mean_deg, whole.motion.p95_deg, whole.swaps);
  if (whole.rest_frames > 0) std::printf("   %.4f", whole.at_rest);
  std::printf("\n");
}

void print_categories(const PlayedScenes& played, const PerSystem<SkeletonSummary>& all) {
  std::printf("\n  %-17s%7s%9s%22s%8s%8s%8s%8s%7s%7s%9s\n", "", "scenes", "tracked", "mAP of navigation", "error",
              "mAP of", "error", "angles", "p95", "swaps", "at rest");
  std::printf("  %-17s%16s   whole   mask  paper%8s%8s%8s%8s%7s\n", "", "", "cm", "all", "cm", "deg", "deg");
  for (const std::string& category : categories_of(played.scenes)) {
    print_category(category, summaries(played, category));
  }
  print_category("all", all);
}

void print_motions(const PerSystem<SkeletonSummary>& all) {
  std::printf("\n  %-17s%24s  %24s\n  %-17s", "", "mean error, degrees", "95th percentile", "");
  for (int i = 0; i < 2; ++i) std::printf("   whole    mask   paper  ");
  std::printf("\n");
  const auto row = [&](std::string_view title, const auto& pick) {
    std::printf("  %-17s", std::string(title).c_str());
    for (const SkeletonSummary& s : all) std::printf("  %6.1f", pick(s).mean_deg);
    std::printf("  ");
    for (const SkeletonSummary& s : all) std::printf("  %6.1f", pick(s).p95_deg);
    std::printf("\n");
  };
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    if (static_cast<MotionId>(m) == MotionId::RotateBust) continue;
    row(kMotionNames[m], [&](const SkeletonSummary& s) { return s.motions[m]; });
  }
  row("all seven", [](const SkeletonSummary& s) { return s.motion; });
}

Json to_json(const JointAccuracy& a) {
  return {{"average_precision", number(a.average_precision)},
          {"mean_error_m", number(a.mean_error_m)},
          {"median_error_m", number(a.median_error_m)},
          {"p90_error_m", number(a.p90_error_m)}};
}

Json to_json(const AngleAccuracy& a) {
  return {{"mean_deg", number(a.mean_deg)}, {"p95_deg", number(a.p95_deg)}};
}

Json to_json(const SkeletonSummary& s) {
  return {{"scenes", s.scenes},
          {"frames", s.frames},
          {"frames_tracked", number(s.frames_tracked)},
          {"joints_given", number(s.joints_given)},
          {"navigation", to_json(s.navigation)},
          {"all", to_json(s.all)},
          {"motion", to_json(s.motion)},
          {"at_rest", {{"frames", s.rest_frames}, {"both_velocities_zero", number(s.at_rest)}}},
          {"swaps", s.swaps}};
}

Json system_json(const PlayedScenes& played, System system) {
  const SkeletonSummary all = summarise(played.scenes, played.records, system);
  Json out = {{"data", "scenes"},
              {"system", kSystemNames[static_cast<std::size_t>(system)]},
              {"width", played.width},
              {"height", played.height}};
  if (system == System::Mask) out["pixels_right"] = number(pixels_right(played));
  out.update(to_json(all));
  out["frame_us"] = {{"p50", number(all.p50_us)}, {"p99", number(all.p99_us)}};
  for (std::size_t j = 0; j < kJointCount; ++j) out["joints"][std::string(kJointNames[j])] = to_json(all.joints[j]);
  for (std::size_t m = 0; m < kMotionCount; ++m) {
    if (static_cast<MotionId>(m) == MotionId::RotateBust) continue;
    out["motions"][std::string(kMotionNames[m])] = to_json(all.motions[m]);
  }
  for (const DistanceRow& row : by_distance(played.records, system)) {
    out["distances"].push_back({{"near_m", number(row.near_m)},
                                {"far_m", number(row.far_m)},
                                {"navigation", to_json(row.navigation)},
                                {"all", to_json(row.all)}});
  }
  for (const std::string& category : categories_of(played.scenes)) {
    out["categories"][category] = to_json(summarise(played.scenes, played.records, system,
                                                    [&](const Scene& scene) { return scene.category == category; }));
  }
  return out;
}

/// One scene, to find the one that fails.
Json scene_json(const PlayedScenes& played, std::size_t i, System system) {
  const Scene& scene = played.scenes[i];
  Json out = {{"data", "scene"},
              {"system", kSystemNames[static_cast<std::size_t>(system)]},
              {"number", scene.number},
              {"category", scene.category},
              {"activity", scene.activity},
              {"distance_m", number(scene.synth.distance_m)},
              {"turned_deg", number(scene.synth.turned_deg)}};
  out.update(to_json(summarise({scene}, std::span(played.records).subspan(i, 1), system)));
  return out;
}

/// What charts call the systems.
constexpr PerSystem<const char*> kLegend = {"whole pipeline", "given the true mask", "just the paper, true mask"};

}  // namespace

void print_scenes(const PlayedScenes& played) {
  const auto all = summaries(played);
  std::printf(
      "%d scenes of synthetic people whom no training run can meet, %dx%d, %d frames measured\n"
      "  whole: depth in, joints out, as a user gets it; mask: the same, given the true mask; paper: 3 trees, hard\n"
      "  votes and mean shift (Shotton et al. 2011) given the true mask, motions unfiltered. Errors are of joints with "
      "a\n"
      "  position; a joint without one counts as not found in the mAP.\n",
      all[0].scenes, played.width, played.height, all[0].frames);
  print_joints(all);
  print_distances(played);
  print_categories(played, all);
  print_motions(all);
  std::printf("\n  %-44s%10s%10s%10s\n", "", "whole", "mask", "paper");
  const auto row = [&](const char* title, const char* format, const auto& pick) {
    std::printf("  %-44s", title);
    for (const SkeletonSummary& s : all) std::printf(format, pick(s));
    std::printf("\n");
  };
  row("frames tracked", "%10.4f", [](const SkeletonSummary& s) { return s.frames_tracked; });
  row("joints with a position", "%10.4f", [](const SkeletonSummary& s) { return s.joints_given; });
  row("at rest: both velocities exactly zero", "%10.4f", [](const SkeletonSummary& s) { return s.at_rest; });
  row("  of frames", "%10d", [](const SkeletonSummary& s) { return s.rest_frames; });
  row("left and right swapped for over two frames", "%10d", [](const SkeletonSummary& s) { return s.swaps; });
  row("time a frame, ms, p50", "%10.2f", [](const SkeletonSummary& s) { return s.p50_us / 1000; });
  row("time a frame, ms, p99", "%10.2f", [](const SkeletonSummary& s) { return s.p99_us / 1000; });
  std::printf("  parts right in %.3f of the user's pixels\n", pixels_right(played));
}

Expected<void> write_scenes_json(const PlayedScenes& played) {
  for (const System system : kSystems) {
    if (const auto written = write_json_line(stdout, system_json(played, system)); !written) return written;
  }
  for (std::size_t i = 0; i < played.scenes.size(); ++i) {
    for (const System system : kSystems) {
      if (const auto written = write_json_line(stdout, scene_json(played, i, system)); !written) return written;
    }
  }
  return {};
}

Expected<void> write_scene_plots(const PlayedScenes& played, const std::filesystem::path& folder) {
  const auto all = summaries(played);

  std::vector<std::string> joints;
  std::vector<Series> errors(kSystemCount), precision(kSystemCount), categories(kSystemCount);
  for (const std::string_view name : kJointNames) joints.emplace_back(name);
  std::vector<double> distances;
  for (std::size_t s = 0; s < kSystemCount; ++s) {
    errors[s].name = precision[s].name = categories[s].name = kLegend[s];
    errors[s].colour = precision[s].colour = categories[s].colour = s;
    for (const JointAccuracy& joint : all[s].joints) errors[s].values.push_back(kCentimetres * joint.mean_error_m);
    distances.clear();
    for (const DistanceRow& row : by_distance(played.records, kSystems[s])) {
      distances.push_back(0.5 * (row.near_m + row.far_m));
      precision[s].values.push_back(row.navigation.average_precision);
    }
  }
  const std::vector<std::string> names = categories_of(played.scenes);
  for (const std::string& name : names) {
    const auto summary = summaries(played, name);
    for (std::size_t s = 0; s < kSystemCount; ++s) {
      categories[s].values.push_back(summary[s].navigation.average_precision);
    }
  }
  const auto save = [&](const char* name, const std::string& svg) { return write_file((folder / name).string(), svg); };
  if (const auto saved = save(
          "joint_errors.svg",
          bar_chart({.title = "Error of each joint on the frozen scenes", .x_axis = "mean error, cm", .y_axis = ""},
                    joints, errors));
      !saved) {
    return saved;
  }
  if (const auto saved =
          save("map_over_distance.svg", line_chart({.title = "Navigation joints within 10 cm, by distance",
                                                    .x_axis = "distance of the user, m",
                                                    .y_axis = "mAP at 10 cm"},
                                                   distances, precision, 0, 1));
      !saved) {
    return saved;
  }
  return save(
      "map_of_categories.svg",
      bar_chart({.title = "Navigation joints within 10 cm, by category", .x_axis = "mAP at 10 cm", .y_axis = ""}, names,
                categories));
}

}  // namespace armature::tools
