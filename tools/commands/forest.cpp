#include <charconv>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "tools/commands/commands.h"
#include "tools/evaluation/forest_evaluation.h"
#include "tools/interrupt.h"
#include "tools/json_lines.h"
#include "tools/progress.h"
#include "tools/training_ranks.h"
#include "tracker/forest/trainer.h"
#include "tracker/joints/correction_trainer.h"

namespace armature::tools {
namespace {

struct TrainArguments {
  std::string out;
  TrainerOptions options;
  CorrectionOptions correction;
};

/// The command that repeats a training run: what decides about the result, nothing else.
std::string command_of(const TrainerOptions& o, const CorrectionOptions& correction) {
  return "armature forest train OUT.forest --images " + std::to_string(o.image_count) + " --trees " +
         std::to_string(o.tree_count) + " --depth " + std::to_string(o.max_depth) + " --pixels " +
         std::to_string(o.pixels_per_image) + " --features " + std::to_string(o.features_per_node) + " --min-leaf " +
         std::to_string(o.min_leaf_samples) + " --correction-images " + std::to_string(correction.image_count) +
         " --seed " + std::to_string(o.seed);
}

Expected<void> train(const TrainArguments& arguments, Ranks& ranks) {
  TrainerOptions options = arguments.options;
  options.command = command_of(options, arguments.correction);
  options.checkpoint = arguments.out + ".checkpoint";
  options.keep_checkpoint = true;  // until the model is written
  const Interrupt interrupt;
  const auto image = [&](int i) { return synthetic_image(training_seed(options.seed, static_cast<std::uint64_t>(i))); };
  auto forest = [&] {
    ProgressBar bar({.title = "growing trees", .silent = ranks.rank() != 0});
    return train_forest(options, image, bar.callback(), interrupt.token(), ranks);
  }();
  if (!forest) return tl::unexpected(forest.error());
  if (ranks.rank() != 0) return {};
  if (arguments.correction.image_count > 0) {
    CorrectionOptions correction = arguments.correction;
    correction.threads = options.threads;
    correction.network.seed = options.seed;
    ProgressBar bar({.title = "learning to correct joints"});
    // Images that the trees have not seen.
    const auto person = [&](int i) {
      return synthetic_person(training_seed(options.seed, static_cast<std::uint64_t>(options.image_count + i)));
    };
    forest = learn_correction(*forest, person, correction, bar.callback(), interrupt.token());
    if (!forest && interrupt.requested()) {
      return fail("training was interrupted; --resume goes on from " + options.checkpoint.string());
    }
    if (!forest) return tl::unexpected(forest.error());
  }
  auto saved = forest->save(arguments.out);
  std::error_code ignored;
  if (saved) std::filesystem::remove(options.checkpoint, ignored);
  return saved;
}

Expected<void> print_info(const std::string& path, bool json) {
  const auto forest = Forest::load(path);
  if (!forest) return tl::unexpected(forest.error());
  std::size_t nodes = 0, leaves = 0;
  for (const Tree& tree : forest->trees()) {
    nodes += tree.nodes.size();
    leaves += tree.leaves.size();
  }
  std::array<char, 9> checksum{};
  std::snprintf(checksum.data(), checksum.size(), "%08x", forest->checksum());
  const std::size_t bytes = forest->serialize().size();
  if (json) {
    return write_json_line(stdout, {{"model", path},
                                    {"bytes", bytes},
                                    {"checksum", checksum.data()},
                                    {"trees", forest->trees().size()},
                                    {"depth", forest->depth()},
                                    {"splits", nodes},
                                    {"leaves", leaves},
                                    {"command", forest->command()}});
  }
  std::printf("%s\n  %zu trees, %d deep, %zu splits, %zu leaves, %.1f MB\n  checksum %s (CRC-32)\n  made by: %s\n",
              path.c_str(), forest->trees().size(), forest->depth(), nodes, leaves, static_cast<double>(bytes) / 1e6,
              checksum.data(), forest->command().c_str());
  return {};
}

void add_train(CLI::App& forest, Run& run) {
  auto* command = forest.add_subcommand("train", "Train a part forest on synthetic people.");
  command->footer(
      "The same options give the same file, whatever the number of threads or processes. Ctrl-C stops; what was\n"
      "finished stays in OUT.forest.checkpoint and --resume goes on from there. Under OpenMPI's mpirun the processes\n"
      "share the images: start one a core.\n\n"
      "Example: armature forest train person.forest --images 4000 --trees 3 --depth 17\n"
      "Example: mpirun -n 64 --hostfile machines armature forest train person.forest --images 100000");
  auto arguments = std::make_shared<TrainArguments>();
  TrainerOptions& o = arguments->options;
  command->add_option("OUT", arguments->out, "the model to write")->required();
  command->add_option("--images", o.image_count, "synthetic people to learn from")->capture_default_str();
  command->add_option("--trees", o.tree_count, "trees")->capture_default_str();
  command->add_option("--depth", o.max_depth, "decisions on a path, at most")->capture_default_str();
  command->add_option("--pixels", o.pixels_per_image, "pixels of each image that a tree sees")->capture_default_str();
  command->add_option("--features", o.features_per_node, "random features tried at each split")->capture_default_str();
  command->add_option("--min-leaf", o.min_leaf_samples, "pixels in a leaf, at least")->capture_default_str();
  command
      ->add_option("--correction-images", arguments->correction.image_count,
                   "more people, to learn how to correct joints from (the first rank alone does); 0: no correction")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("--seed", o.seed, "of the images and the trees")->capture_default_str();
  command->add_option("--threads", o.threads, "0: one a core, under mpirun one a process")->capture_default_str();
  command->add_flag("--resume", o.resume, "go on with an interrupted run of the same options");
  command->callback([arguments, &run] {
    run = [arguments] { return run_on_ranks([&](Ranks& ranks) { return train(*arguments, ranks); }); };
  });
}

void add_evaluate(CLI::App& forest, Run& run) {
  auto* command = forest.add_subcommand("evaluate", "Measure a part forest on people it was not trained on.");
  command->footer(
      "On the frozen scenes (synthetic people, share/armature/skeleton_scenes.txt), whose first second is not "
      "measured:\n"
      "mAP at 10 cm and error of each joint, by distance and by category; the seven motions, filtered; how often both\n"
      "velocities are zero at rest; swaps of left and right. Of the whole pipeline, of forest and joints given the "
      "true\n"
      "mask, and of just the paper (Shotton et al. 2011).\n"
      "On real people (--utd, recordings with the joints of the Kinect SDK): deviation after removing one constant "
      "offset\n"
      "a sequence, and the correlation of motion angles; as is and with the SDK's joints delayed by 1.5 frames.\n\n"
      "Example: armature forest evaluate person.forest --utd recordings/utd --plots pictures");
  auto options = std::make_shared<EvaluationOptions>();
  auto json = std::make_shared<bool>(false);
  command->add_option("MODEL", options->model, "a model of `armature forest train`")->required();
  command->add_flag("--quick", options->quick, "the first scene of each category alone");
  command->add_option("--category", options->categories, "scenes of this category alone; may be repeated");
  command
      ->add_option_function<std::string>(
          "--size",
          [options](const std::string& size) {
            options->scenes.width = size == "640x480" ? 640 : 320;
            options->scenes.height = size == "640x480" ? 480 : 240;
          },
          "of the scenes' images: 320x240 or 640x480")
      ->check(CLI::IsMember({"320x240", "640x480"}))
      ->default_str("320x240");
  command->add_option("--stride", options->scenes.stride, "pixels between samples; 0: the tracker's own choice")
      ->capture_default_str();
  command->add_option("--threads", options->scenes.threads, "scenes at a time; times mean something with 1 only")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
  CLI::Option* utd = command->add_option("--utd", options->utd_folder, "a folder of aA_sS_tT.u16.zst and .joints.csv");
  command->add_flag("--real-only", options->real_only, "no scenes, --utd alone")->needs(utd);
  command->add_flag("--all", options->all_actions, "every action in --utd, not only 1-4, 22, 23, 26 and 27");
  command->add_option("--plots", options->plots, "a folder for pictures (SVG): errors, mAP over distance");
  command->add_flag("--json", *json, "one JSON object a line");
  command->callback([options, json, &run] {
    run = [options, json]() -> Expected<void> { return evaluate_forest(*options, *json); };
  });
}

void add_info(CLI::App& forest, Run& run) {
  auto* command = forest.add_subcommand("info", "Say what a model file holds and how it was made.");
  command->footer("Example: armature forest info person.forest");
  auto path = std::make_shared<std::string>();
  auto json = std::make_shared<bool>(false);
  command->add_option("MODEL", *path, "a model of `armature forest train`")->required();
  command->add_flag("--json", *json, "one JSON object a line");
  command->callback([path, json, &run] { run = [path, json] { return print_info(*path, *json); }; });
}

}  // namespace

void add_forest(CLI::App& app, Run& run) {
  auto* forest = app.add_subcommand("forest", "Train, measure and describe the forest that labels body parts.");
  forest->require_subcommand(1);
  add_train(*forest, run);
  add_evaluate(*forest, run);
  add_info(*forest, run);
}

}  // namespace armature::tools
