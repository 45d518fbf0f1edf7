#include "tracker/forest/trainer.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>
#include <optional>
#include <sstream>
#include <system_error>
#include <thread>
#include <utility>

#include "tracker/forest/checkpoint.h"
#include "tracker/forest/tree_grower.h"

namespace armature {
namespace {

/// Below this depth each node's subtree is one piece of work.
constexpr int kTopDepth = 7;
/// The share of the progress that making the images takes.
constexpr double kImageShare = 0.25;

/// Calls work(i, thread) for every i in [0, count); which thread gets which i is left to chance.
template <class Work>
void for_each_in_parallel(std::size_t count, int threads, const std::stop_token& stop, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto run = [&](std::size_t thread) {
    for (std::size_t i = next++; i < count && !stop.stop_requested(); i = next++) work(i, thread);
  };
  std::vector<std::jthread> helpers;
  for (int thread = 1; thread < threads; ++thread) helpers.emplace_back(run, static_cast<std::size_t>(thread));
  run(0);
}

class Progress {
 public:
  explicit Progress(const std::function<void(double)>& report) : report_(report) {}
  void add(double part) {
    const std::lock_guard lock(mutex_);
    done_ += part;
    if (report_) report_(std::min(done_, 1.0));
  }

 private:
  const std::function<void(double)>& report_;
  std::mutex mutex_;
  double done_ = 0;
};

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

/// Moves a subtree's indices behind what `tree` holds already and hangs it there; returns its root.
std::int32_t append_subtree(Tree& tree, const Tree& subtree) {
  const auto nodes = static_cast<std::int32_t>(tree.nodes.size());
  const auto leaves = static_cast<std::int32_t>(tree.leaves.size());
  for (SplitNode node : subtree.nodes) {
    for (std::int32_t& child : node.child) child += child >= 0 ? nodes : -leaves;
    tree.nodes.push_back(node);
  }
  tree.leaves.insert(tree.leaves.end(), subtree.leaves.begin(), subtree.leaves.end());
  return subtree.nodes.empty() ? ~leaves : nodes;
}

class TreeTraining {
 public:
  TreeTraining(const TrainerOptions& options, std::span<const TrainingPerson> persons,
               std::vector<TrainingSample> samples, std::uint32_t tree, int threads)
      : options_(options), samples_(std::move(samples)), tree_index_(tree), threads_(threads) {
    for (int thread = 0; thread < threads; ++thread) {
      growers_.emplace_back(options, persons, derive_seed(options.seed, 1'000'000'000ULL + tree));
    }
  }

  [[nodiscard]] Expected<Tree> run(Checkpoint* checkpoint, Progress& progress, double share,
                                   const std::stop_token& stop) {
    grow_top(stop);
    if (stop.stop_requested()) return tl::unexpected(interrupted(options_));
    std::vector<Tree> subtrees(open_.size());
    // The largest first, so that no thread is left with one at the end.
    std::vector<std::size_t> order(open_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return open_[a].node.samples.size() > open_[b].node.samples.size();
    });
    std::mutex mutex;
    Expected<void> written;
    for_each_in_parallel(order.size(), threads_, stop, [&](std::size_t i, std::size_t thread) {
      const GrowingNode& node = open_[order[i]].node;
      Tree& subtree = subtrees[order[i]];
      const SubtreeId id{tree_index_, static_cast<std::uint32_t>(node.path)};
      if (checkpoint != nullptr && checkpoint->finished().contains(id)) {
        subtree = checkpoint->finished().at(id);
      } else {
        subtree = growers_[thread].grow(node, stop);
        if (stop.stop_requested()) return;
        const std::lock_guard lock(mutex);
        if (checkpoint != nullptr && written) written = checkpoint->append(id, subtree);
      }
      progress.add(share * static_cast<double>(node.samples.size()) / static_cast<double>(samples_.size()));
    });
    if (stop.stop_requested()) return tl::unexpected(interrupted(options_));
    if (!written) return tl::unexpected(written.error());
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const std::int32_t root = append_subtree(tree_, subtrees[i]);
      if (open_[i].parent) tree_.nodes[*open_[i].parent].child[open_[i].side] = root;
    }
    return std::move(tree_);
  }

 private:
  struct Open {
    GrowingNode node;
    std::optional<std::size_t> parent;
    std::size_t side = 0;
  };

  void grow_top(const std::stop_token& stop) {
    open_ = {{GrowingNode{samples_}, {}, 0}};
    for (int depth = 0; depth < kTopDepth; ++depth) {
      std::vector<std::optional<GrownSplit>> splits(open_.size());
      for_each_in_parallel(open_.size(), threads_, stop, [&](std::size_t i, std::size_t thread) {
        if (open_[i].node.depth == depth) splits[i] = growers_[thread].split(open_[i].node);
      });
      std::vector<Open> next;
      for (std::size_t i = 0; i < open_.size(); ++i) {
        if (!splits[i]) {
          next.push_back(open_[i]);  // a leaf: its subtree is that leaf
          continue;
        }
        const std::size_t self = tree_.nodes.size();
        if (open_[i].parent) {
          tree_.nodes[*open_[i].parent].child[open_[i].side] = static_cast<std::int32_t>(self);
        }
        tree_.nodes.push_back(splits[i]->node);
        for (std::size_t side = 0; side < 2; ++side) next.push_back({splits[i]->children[side], self, side});
      }
      open_ = std::move(next);
    }
  }

  const TrainerOptions& options_;
  std::vector<TrainingSample> samples_;
  std::uint32_t tree_index_;
  int threads_;
  std::vector<TreeGrower> growers_;
  std::vector<Open> open_;
  Tree tree_;
};

struct TrainingSet {
  std::vector<TrainingPerson> persons;
  std::vector<std::vector<TrainingSample>> samples_of_tree;
};

TrainingSet make_training_set(const TrainerOptions& options, const TrainingImages& images, int threads,
                              Progress& progress, const std::stop_token& stop) {
  const auto count = static_cast<std::size_t>(options.image_count);
  const auto trees = static_cast<std::size_t>(options.tree_count);
  TrainingSet set;
  set.persons.resize(count);
  set.samples_of_tree.resize(trees);
  std::vector<std::vector<TrainingSample>> drawn(count * trees);
  for_each_in_parallel(count, threads, stop, [&](std::size_t i, std::size_t) {
    const TrainingImage image = images(static_cast<int>(i));
    set.persons[i] = cut_out_person(image);
    for (std::size_t t = 0; t < trees; ++t) {
      draw_samples(image, set.persons[i], static_cast<std::uint32_t>(i), options.pixels_per_image,
                   derive_seed(options.seed, i * kMaxTrees + t), drawn[i * trees + t]);
    }
    progress.add(kImageShare / static_cast<double>(count));
  });
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t t = 0; t < trees; ++t) {
      auto& samples = set.samples_of_tree[t];
      auto& part = drawn[i * trees + t];
      samples.insert(samples.end(), part.begin(), part.end());
      part = {};
    }
  }
  return set;
}

}  // namespace

Expected<Forest> train_forest(const TrainerOptions& options, const TrainingImages& images,
                              const std::function<void(double)>& report, std::stop_token stop) {
  if (const auto checked = check(options); !checked) return tl::unexpected(checked.error());
  const int threads =
      options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));

  std::optional<Checkpoint> checkpoint;
  if (!options.checkpoint.empty()) {
    auto opened = options.resume ? Checkpoint::resume(options.checkpoint, settings_of(options))
                                 : Checkpoint::create(options.checkpoint, settings_of(options));
    if (!opened) return tl::unexpected(opened.error());
    checkpoint = std::move(*opened);
  }

  Progress progress(report);
  TrainingSet set = make_training_set(options, images, threads, progress, stop);
  if (stop.stop_requested()) return tl::unexpected(interrupted(options));
  std::vector<Tree> trees;
  for (std::size_t t = 0; t < set.samples_of_tree.size(); ++t) {
    auto& samples = set.samples_of_tree[t];
    if (samples.empty()) return fail("training: no image shows a pixel of a person");
    TreeTraining training(options, set.persons, std::move(samples), static_cast<std::uint32_t>(t), threads);
    auto tree = training.run(checkpoint ? &*checkpoint : nullptr, progress,
                             (1 - kImageShare) / static_cast<double>(options.tree_count), stop);
    if (!tree) return tl::unexpected(tree.error());
    trees.push_back(std::move(*tree));
  }
  if (checkpoint) {
    std::error_code ignored;
    std::filesystem::remove(options.checkpoint, ignored);
  }
  return Forest::create(std::move(trees), options.command);
}

}  // namespace armature
