#include "tools/evaluation/forest_evaluation.h"

#include <algorithm>
#include <filesystem>
#include <memory>

#include "tools/evaluation/paper_tracker.h"
#include "tools/evaluation/real_report.h"
#include "tools/evaluation/scene_report.h"
#include "tools/evaluation/skeleton_summary.h"
#include "tools/interrupt.h"
#include "tools/progress.h"
#include "tracker/installation.h"
#include "tracker/synth/training_images.h"

namespace armature::tools {
namespace {

Expected<std::vector<Scene>> chosen_scenes(const EvaluationOptions& options) {
  const auto file = installed_file("skeleton_scenes.txt");
  auto scenes = read_scenes(file);
  if (!scenes) return scenes;
  if (options.quick) *scenes = first_of_each_category(*scenes);
  if (options.categories.empty()) return scenes;
  const std::vector<std::string> known = categories_of(*scenes);
  for (const std::string& category : options.categories) {
    if (std::find(known.begin(), known.end(), category) != known.end()) continue;
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    return fail("no category '" + category + "' in " + file.string() + "; there are " + names);
  }
  std::erase_if(*scenes, [&](const Scene& scene) {
    return std::find(options.categories.begin(), options.categories.end(), scene.category) == options.categories.end();
  });
  return scenes;
}

Expected<void> evaluate_on_scenes(const std::shared_ptr<const Forest>& forest, const EvaluationOptions& options,
                                  bool json) {
  auto scenes = chosen_scenes(options);
  if (!scenes) return tl::unexpected(scenes.error());
  PlayedScenes played{
      .scenes = std::move(*scenes), .records = {}, .width = options.scenes.width, .height = options.scenes.height};
  const Interrupt interrupt;
  ProgressBar bar({.title = "frozen scenes", .total = static_cast<double>(played.scenes.size()), .unit = "scenes"});
  auto records = evaluate_scenes(forest, played.scenes, options.scenes, bar.callback(), interrupt.token());
  bar.finish();
  if (!records) return tl::unexpected(records.error());
  played.records = std::move(*records);
  if (!options.plots.empty()) {
    if (auto written = write_scene_plots(played, options.plots); !written) return written;
  }
  if (json) return write_scenes_json(played);
  print_scenes(played);
  return {};
}

Expected<void> evaluate_on_recordings(const std::shared_ptr<const Forest>& forest, const EvaluationOptions& options,
                                      bool json) {
  SkeletonTracker tracker(forest, options.scenes.stride);
  PaperTracker paper(std::make_shared<const Forest>(paper_forest_of(*forest)), options.scenes.stride);
  const auto evaluate = [&](const MaskedTracker& which, const char* title) {
    ProgressBar bar({.title = title});
    return evaluate_real(which, options.utd_folder, options.all_actions, bar.callback());
  };
  auto ours = evaluate(MaskedTracker::of(tracker), "real people");
  if (!ours) return tl::unexpected(ours.error());
  auto papers = evaluate(MaskedTracker::of(paper), "real people, just the paper");
  if (!papers) return tl::unexpected(papers.error());
  const RealComparison real{std::move(*ours), std::move(*papers)};
  if (!options.plots.empty()) {
    if (auto written = write_real_plots(real, options.plots); !written) return written;
  }
  if (json) return write_real_json(real);
  print_real(real);
  return {};
}

TrainingImage training_image(const LabelledImage& labelled) {
  return {labelled.intrinsics, labelled.depth_mm, labelled.user, labelled.part, labelled.joints};
}

}  // namespace

TrainingImage synthetic_image(std::uint64_t seed) {
  thread_local TrainingSampler sampler{TrainingOptions{}};
  thread_local LabelledImage labelled;
  sampler.sample(seed, labelled);
  return training_image(labelled);
}

PersonTwice synthetic_person(std::uint64_t seed) {
  // More of them are hidden than where parts are learned: that is where joints have to be guessed from others.
  const auto options_of_corrections = [] {
    TrainingOptions options;
    options.occluded = 0.32;
    options.company = 0.20;
    return options;
  };
  thread_local TrainingSampler sampler{options_of_corrections()};
  thread_local LabelledImage labelled, at_rest;
  sampler.sample(seed, labelled, &at_rest);
  return {training_image(labelled), training_image(at_rest)};
}

Expected<void> evaluate_forest(const EvaluationOptions& options, bool json) {
  auto loaded = Forest::load(options.model);
  if (!loaded) return tl::unexpected(loaded.error());
  const auto forest = std::make_shared<const Forest>(std::move(*loaded));
  if (!options.plots.empty()) {
    std::error_code error;
    std::filesystem::create_directories(options.plots, error);
    if (error) return fail(options.plots + ": no folder can be made there: " + error.message());
  }
  if (!options.real_only) {
    if (auto done = evaluate_on_scenes(forest, options, json); !done) return done;
  }
  if (options.utd_folder.empty()) return {};
  return evaluate_on_recordings(forest, options, json);
}

}  // namespace armature::tools
