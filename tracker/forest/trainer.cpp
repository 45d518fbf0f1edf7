#include "tracker/forest/trainer.h"

#include <algorithm>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include "tracker/forest/tree_training.h"

namespace armature {
namespace {

/// The share of the progress that making the images takes.
constexpr double kImageShare = 0.25;

Error interrupted(const TrainerOptions& options) {
  return {options.checkpoint.empty()
              ? "training was interrupted"
              : "training was interrupted; --resume goes on from " + options.checkpoint.string()};
}

Expected<void> check(const TrainerOptions& options) {
  const auto in_range = [](int value, int low, int high, const char* what) -> Expected<void> {
    if (value >= low && value <= high) return {};
    return fail(std::string("training: ") + what + " is " + std::to_string(value) + ", expected " +
                std::to_string(low) + " to " + std::to_string(high));
  };
  for (const auto& checked : {in_range(options.image_count, 1, 1'000'000, "the number of images"),
                              in_range(options.tree_count, 1, kMaxTrees, "the number of trees"),
                              in_range(options.max_depth, 0, 28, "the depth"),
                              in_range(options.pixels_per_image, 1, 100'000, "the number of pixels an image"),
                              in_range(options.features_per_node, 1, 100'000, "the number of features a node"),
                              in_range(options.node_samples, 2, kMaxNodeSamples, "the number of samples a node"),
                              in_range(options.min_leaf_samples, 1, 1'000'000, "the number of samples a leaf"),
                              in_range(options.max_probe_mm, 1, kMaxProbe_mm, "the longest probe in mm"),
                              in_range(options.threads, 0, 1024, "the number of threads")}) {
    if (!checked) return checked;
  }
  return {};
}

/// What decides about the result, and nothing else.
std::string settings_of(const TrainerOptions& o) {
  std::ostringstream out;
  out << "images " << o.image_count << " trees " << o.tree_count << " depth " << o.max_depth << " pixels "
      << o.pixels_per_image << " features " << o.features_per_node << " node " << o.node_samples << " leaf "
      << o.min_leaf_samples << " probe " << o.max_probe_mm << " seed " << o.seed << " command " << o.command;
  return out.str();
}

/// What a rank holds: its share of the images, and for each tree the pixels drawn from them.
struct TrainingSet {
  std::vector<TrainingPerson> persons;
  std::vector<std::vector<TrainingSample>> samples_of_tree;
};

TrainingSet make_training_set(const TrainerOptions& options, const TrainingImages& images, int threads,
                              TrainingProgress& progress, const std::stop_token& stop, const Ranks& ranks) {
  const auto first = static_cast<std::size_t>(ranks.rank());
  const auto step = static_cast<std::size_t>(ranks.count());
  const auto all = static_cast<std::size_t>(options.image_count);
  const std::size_t count = all > first ? (all - first - 1) / step + 1 : 0;
  const auto trees = static_cast<std::size_t>(options.tree_count);
  TrainingSet set;
  set.persons.resize(count);
  set.samples_of_tree.resize(trees);
  std::vector<std::vector<TrainingSample>> drawn(count * trees);
  for_each_in_parallel(
      count, threads, [&] { return stop.stop_requested(); },
      [&](std::size_t person, std::size_t) {
        const std::size_t i = first + person * step;
        const TrainingImage image = images(static_cast<int>(i));
        set.persons[person] = cut_out_person(image);
        for (std::size_t t = 0; t < trees; ++t) {
          draw_samples(image, set.persons[person], static_cast<std::uint32_t>(person), options.pixels_per_image,
                       derive_seed(options.seed, i * kMaxTrees + t), drawn[person * trees + t]);
        }
        progress.add(kImageShare / static_cast<double>(count));
      });
  for (std::size_t person = 0; person < count; ++person) {
    for (std::size_t t = 0; t < trees; ++t) {
      auto& samples = set.samples_of_tree[t];
      auto& part = drawn[person * trees + t];
      samples.insert(samples.end(), part.begin(), part.end());
      part = {};
    }
  }
  return set;
}

}  // namespace

Expected<Forest> train_forest(const TrainerOptions& options, const TrainingImages& images,
                              const std::function<void(double)>& report, std::stop_token stop, Ranks& ranks) {
  if (const auto checked = check(options); !checked) return tl::unexpected(checked.error());
  const int cores = ranks.count() > 1 ? 1 : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const int threads = options.threads > 0 ? options.threads : cores;

  auto checkpoint = SharedCheckpoint::open(options.checkpoint, options.resume, settings_of(options), ranks);
  if (!checkpoint) return tl::unexpected(checkpoint.error());
  TrainingProgress progress(ranks.rank() == 0 ? report : nullptr);
  TrainingSet set = make_training_set(options, images, threads, progress, stop, ranks);
  std::vector<Tree> trees;
  for (std::size_t t = 0; t < set.samples_of_tree.size(); ++t) {
    if (any_rank(ranks, stop.stop_requested())) return tl::unexpected(interrupted(options));
    // Ranks go through the nodes together, so each is of one thread.
    TreeTraining training(options, set.persons, std::move(set.samples_of_tree[t]), static_cast<std::uint32_t>(t),
                          ranks.count() > 1 ? 1 : threads, ranks);
    auto tree = training.run(*checkpoint, progress, (1 - kImageShare) / static_cast<double>(options.tree_count), stop);
    if (!tree) return tl::unexpected(tree.error());
    if (!*tree) return tl::unexpected(interrupted(options));
    trees.push_back(std::move(**tree));
  }
  if (!options.checkpoint.empty() && !options.keep_checkpoint && ranks.rank() == 0) {
    std::error_code ignored;
    std::filesystem::remove(options.checkpoint, ignored);
  }
  return Forest::create(std::move(trees), options.command);
}

Expected<Forest> train_forest(const TrainerOptions& options, const TrainingImages& images,
                              const std::function<void(double)>& progress, std::stop_token stop) {
  OneRank alone;
  return train_forest(options, images, progress, std::move(stop), alone);
}

}  // namespace armature
