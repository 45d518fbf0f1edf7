#include <filesystem>
#include <stop_token>

#include <gtest/gtest.h>

#include "tests/tracker/forest/paper_doll.h"
#include "tests/tracker/forest/thread_ranks.h"
#include "tracker/forest/feature_bins.h"
#include "tracker/forest/split_search.h"
#include "tracker/forest/trainer.h"
#include "tracker/forest/training_set.h"

namespace armature {
namespace {

std::filesystem::path fresh_folder(const char* name) {
  const auto folder = std::filesystem::path(testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

std::vector<std::byte> train(const TrainerOptions& options, std::stop_token stop = {},
                             const std::function<void(double)>& progress = {}) {
  const auto forest = train_forest(options, paper_images(), progress, std::move(stop));
  return forest ? forest->serialize() : std::vector<std::byte>{};
}

TEST(ForestTraining, OneThreadAndTwoGrowTheSameTrees) {
  auto options = paper_training();
  const auto one = train(options);
  options.threads = 2;
  const auto two = train(options);
  ASSERT_FALSE(one.empty());
  EXPECT_EQ(one, two);
}

/// What each of several ranks returns: the forest, or nothing. `stop_after` is asked after each image that a rank made
/// and, of rank 0, with each progress.
struct RankState {
  int rank = 0;
  int images = 0;
  double progress = 0;
};
std::vector<std::vector<std::byte>> train_on_ranks(int count, const TrainerOptions& options,
                                                   const std::function<bool(const RankState&)>& stop_after = {}) {
  std::vector<std::vector<std::byte>> results(static_cast<std::size_t>(count));
  ThreadRanks(count).run([&](Ranks& ranks) {
    std::stop_source stop;
    RankState state{.rank = ranks.rank()};
    const auto counted = [&](int i) {
      ++state.images;
      if (stop_after && stop_after(state)) stop.request_stop();
      return paper_images()(i);
    };
    const auto progress = [&](double fraction) {
      state.progress = fraction;
      if (stop_after && stop_after(state)) stop.request_stop();
    };
    const auto forest = train_forest(options, counted, progress, stop.get_token(), ranks);
    if (forest) results[static_cast<std::size_t>(ranks.rank())] = forest->serialize();
  });
  return results;
}

TEST(ForestTraining, AnyNumberOfRanksGrowsTheSameTrees) {
  auto options = paper_training();
  for (const int node_samples : {2000, 300}) {  // of most nodes all samples, of most nodes few
    options.node_samples = node_samples;
    const auto one = train(options);
    ASSERT_FALSE(one.empty());
    for (const int count : {2, 5}) {
      for (const auto& result : train_on_ranks(count, options)) EXPECT_EQ(result, one) << count << " ranks";
    }
  }
  options.image_count = 2;  // one of three ranks has nothing
  for (const auto& result : train_on_ranks(3, options)) EXPECT_EQ(result, train(options));
}

TEST(ForestTraining, ARunOnRanksThatIsStoppedAnywhereIsResumedByAnotherNumberOfThem) {
  auto options = paper_training();
  const auto whole = train(options);
  options.checkpoint = fresh_folder("forest_training_ranks") / "run.checkpoint";
  const auto stopped = train_on_ranks(3, options, [](const RankState& at) { return at.progress > 0.6; });
  for (const auto& result : stopped) EXPECT_TRUE(result.empty());
  options.resume = true;
  const auto again = train_on_ranks(4, options, [](const RankState& at) { return at.rank == 2 && at.images > 5; });
  for (const auto& result : again) EXPECT_TRUE(result.empty());
  for (const auto& result : train_on_ranks(2, options)) EXPECT_EQ(result, whole);
}

TEST(ForestTraining, AFailureOfTheFirstRankIsTheErrorOfAll) {
  auto options = paper_training();
  options.checkpoint = fresh_folder("forest_training_failure") / "missing" / "run.checkpoint";
  std::vector<std::string> messages(3);
  ThreadRanks(3).run([&](Ranks& ranks) {
    const auto forest = train_forest(options, paper_images(), {}, {}, ranks);
    if (!forest) messages[static_cast<std::size_t>(ranks.rank())] = forest.error().message;
  });
  for (const std::string& message : messages) {
    EXPECT_EQ(message, options.checkpoint.string() + ": cannot write the checkpoint; is the folder there, with room?");
  }
}

TEST(ForestTraining, AnInterruptedRunThatIsResumedGrowsTheSameTrees) {
  auto options = paper_training();
  const auto whole = train(options);
  options.checkpoint = fresh_folder("forest_training_resume") / "run.checkpoint";
  for (const double stop_at : {0.1, 0.5, 0.9}) {
    options.resume = false;
    std::stop_source stop;
    const auto broken = train(options, stop.get_token(), [&](double fraction) {
      if (fraction >= stop_at) stop.request_stop();
    });
    EXPECT_TRUE(broken.empty()) << "stopped at " << stop_at;
    // As if it had been killed in the middle of writing a record.
    std::filesystem::resize_file(options.checkpoint, std::filesystem::file_size(options.checkpoint) - 3);
    if (stop_at < 0.3) continue;  // that cut the settings: nothing to resume from
    options.resume = true;
    EXPECT_EQ(train(options), whole) << "stopped at " << stop_at;
    EXPECT_FALSE(std::filesystem::exists(options.checkpoint));
  }
}

TEST(ForestTraining, ACheckpointOfOtherOptionsIsRefused) {
  auto options = paper_training();
  options.checkpoint = fresh_folder("forest_training_other") / "run.checkpoint";
  std::stop_source stop;
  (void)train(options, stop.get_token(), [&](double fraction) {
    if (fraction > 0.5) stop.request_stop();
  });
  options.resume = true;
  options.seed = 6;
  const auto forest = train_forest(options, paper_images(), {}, {});
  ASSERT_FALSE(forest.has_value());
  EXPECT_EQ(
      forest.error().message,
      options.checkpoint.string() + ": the checkpoint of a training run with other options; train without --resume");
}

TEST(ForestTraining, AStopIsAnErrorThatSaysHowToGoOn) {
  auto options = paper_training();
  options.checkpoint = fresh_folder("forest_training_stop") / "run.checkpoint";
  std::stop_source stop;
  stop.request_stop();
  const auto forest = train_forest(options, paper_images(), {}, stop.get_token());
  ASSERT_FALSE(forest.has_value());
  EXPECT_EQ(forest.error().message, "training was interrupted; --resume goes on from " + options.checkpoint.string());
}

TEST(ForestTraining, OptionsOutOfRangeAndImagesOfNobodyAreErrors) {
  auto options = paper_training();
  options.max_depth = 29;
  auto forest = train_forest(options, paper_images(), {}, {});
  ASSERT_FALSE(forest.has_value());
  EXPECT_EQ(forest.error().message, "training: the depth is 29, expected 0 to 28");

  options = paper_training();
  const auto nobody = [](int) {
    TrainingImage image;
    image.intrinsics = qvga();
    image.depth_mm.assign(320 * 240, 0);
    image.part_of_pixel.assign(320 * 240, kNoPart);
    image.user.assign(320 * 240, 1);
    return image;
  };
  forest = train_forest(options, nobody, {}, {});
  ASSERT_FALSE(forest.has_value());
  EXPECT_EQ(forest.error().message, "training: no image shows a pixel of a person");
}

TEST(ForestTraining, BinsOfFeaturesAreThoseOfTheFeatureItself) {
  // Dolls at every edge of the image, so that probes leave it on all sides.
  std::vector<TrainingPerson> persons;
  std::vector<TrainingSample> samples;
  for (const PaperDoll& doll : {PaperDoll{}, PaperDoll{-1.3F, -1.2F, 2.1F}, PaperDoll{1.7F, 0.2F, 3.5F}}) {
    const TrainingImage image = paper_image(doll, qvga());
    persons.push_back(cut_out_person(image));
    draw_samples(image, persons.back(), static_cast<std::uint32_t>(persons.size() - 1), 100, 8, samples);
  }
  TrainingRandom random(4);
  const auto probe = [&] { return static_cast<std::int16_t>(random.between(-kMaxProbe_mm, kMaxProbe_mm)); };
  std::vector<CandidateFeature> features;
  for (std::uint32_t number = 0; number < 203; ++number) {
    CandidateFeature feature{{}, random.between(3, 66), number};
    feature.node.u_mm = {probe(), probe()};
    if (number % 3 != 0) feature.node.v_mm = {probe(), probe()};
    features.push_back(feature);
  }
  FeatureBins bins;
  bins.assign(features);
  ASSERT_EQ(bins.features().size(), features.size());
  std::array<std::uint16_t, kPartCount> offset_of_part{};
  for (std::size_t part = 0; part < kPartCount; ++part) offset_of_part[part] = static_cast<std::uint16_t>(part);
  std::vector<std::uint16_t> rows(samples.size() * bins.stride());
  bins.find(persons, samples, 32, offset_of_part, rows.data());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const TrainingPerson& person = persons[samples[i].person];
    const PersonImage image = person.image();
    const ProbeScale scale = probe_scale(person.focal, image.depth_mm[samples[i].v * image.width + samples[i].u]);
    for (std::size_t f = 0; f < features.size(); ++f) {
      const CandidateFeature& feature = bins.features()[f];
      const int value = part_feature(image, samples[i].u, samples[i].v, scale, feature.node);
      int bin = 0;
      for (int k = -11; k <= 11; ++k) bin += value >= k * feature.step_mm ? 1 : 0;
      ASSERT_EQ(rows[i * bins.stride() + f], bin * 32 + samples[i].part) << "sample " << i << ", feature " << f;
    }
  }
}

TEST(ForestTraining, ASplitSeparatesTwoHalvesThatOneFeatureTellsApart) {
  // A board whose upper half is one part and whose lower half another.
  TrainingImage image = paper_image({}, qvga());
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const auto pixel = static_cast<std::size_t>(v * 320 + u);
      const bool inside = u >= 100 && u < 200 && v >= 60 && v < 160;
      image.depth_mm[pixel] = inside ? 2000 : 0;
      image.user[pixel] = inside ? 1 : 0;
      image.part_of_pixel[pixel] = !inside ? kNoPart : static_cast<std::uint8_t>(v < 110 ? 4 : 7);
    }
  }
  auto options = paper_training();
  options.features_per_node = 2000;
  const std::vector<TrainingPerson> persons = {cut_out_person(image)};
  std::vector<TrainingSample> samples;
  draw_samples(image, persons[0], 0, 1000, 3, samples);
  ASSERT_EQ(samples.size(), 1000U);
  SplitSearch search(options);
  const SearchedNode node{count_parts(samples), 1000, 9};
  std::vector<std::uint16_t> histograms(search.histogram_size(node));
  search.count(persons, samples, node, histograms);
  const auto split = search.best(node, histograms);
  ASSERT_TRUE(split.has_value());
  int wrong = 0;
  for (const TrainingSample& sample : samples) {
    const ProbeScale scale = probe_scale(persons[0].focal, 2000);
    const bool right = part_feature(persons[0].image(), sample.u, sample.v, scale, *split) >= split->threshold_mm;
    if (right != (sample.part == 7)) ++wrong;
  }
  // Either side may be the right one; a probe that reaches past the edge finds the border to within a few pixels.
  EXPECT_LE(std::min(wrong, 1000 - wrong), 40);
}

}  // namespace
}  // namespace armature
