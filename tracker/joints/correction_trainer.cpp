#include "tracker/joints/correction_trainer.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <thread>

#include "tracker/joints/joint_correction.h"
#include "tracker/joints/joint_estimator.h"

namespace armature {
namespace {

constexpr double kImageShare = 0.7;  // of the whole: looking at the images; the rest is learning

/// What the votes say of a person and of her mirror image, and where the joints are from there. Empty where nobody is
/// found.
struct Example {
  std::vector<float> known, offset_m;
};

/// Looks at images one by one. One a thread.
class Observer {
 public:
  explicit Observer(const std::shared_ptr<const Forest>& forest) : classifier_(forest), estimator_(forest) {}

  [[nodiscard]] Example look_at(const PersonTwice& person) {
    if (!find(person.at_rest)) return {};
    RestingBody resting;
    resting.add(found_);
    if (!find(person.image)) return {};
    Skeleton truth;
    for (std::size_t j = 0; j < kJointCount; ++j) truth.joints[j].position = person.image.joints[j];
    Example example;
    append(found_, truth, resting, example);
    append(mirrored(found_), mirrored(truth), resting.mirrored(), example);  // twice as many people for nothing
    return example;
  }

 private:
  /// What the votes say of an image; false: nothing.
  [[nodiscard]] bool find(const TrainingImage& image) {
    classifier_.reset(image.intrinsics);
    estimator_.reset();
    constexpr std::uint8_t kUser = 1;
    mask_.resize(image.user.size());
    std::transform(image.user.begin(), image.user.end(), mask_.begin(), [](std::uint8_t user) { return user != 0; });
    const DepthView frame{.depth_mm = image.depth_mm, .intrinsics = image.intrinsics, .sensor = {}, .host = {}};
    estimator_.estimate(classifier_.classify(frame, mask_, kUser), found_);
    return found_[JointId::Torso].state != JointState::Lost;
  }

  static void append(const Skeleton& found, const Skeleton& truth, const RestingBody& resting, Example& example) {
    const CorrectionFrame seen_from(found);
    std::array<float, kCorrectionInputs> inputs{};
    correction_inputs(found, resting, seen_from, inputs);
    example.known.insert(example.known.end(), inputs.begin(), inputs.end());
    for (std::size_t j = 0; j < kJointCount; ++j) {
      const Eigen::Vector3f offset = seen_from.turned(truth.joints[j].position - found.joints[j].position);
      example.offset_m.insert(example.offset_m.end(), offset.data(), offset.data() + 3);
    }
  }

  PartClassifier classifier_;
  JointEstimator estimator_;
  Skeleton found_;
  std::vector<std::uint8_t> mask_;
};

}  // namespace

Expected<Forest> learn_correction(const Forest& forest, const TrainingPersons& persons,
                                  const CorrectionOptions& options, const std::function<void(double)>& progress,
                                  std::stop_token stop) {
  const auto plain = std::make_shared<const Forest>(forest.uncorrected());
  const auto count = static_cast<std::size_t>(std::max(0, options.image_count));
  const unsigned threads =
      options.threads > 0 ? static_cast<unsigned>(options.threads) : std::max(1U, std::thread::hardware_concurrency());
  std::vector<Example> found(count);
  {
    std::atomic<std::size_t> next = 0, done = 0;
    std::mutex mutex;
    std::vector<std::jthread> observers;
    for (unsigned t = 0; t < threads; ++t) {
      observers.emplace_back([&] {
        Observer observer(plain);
        for (std::size_t i = next++; i < count && !stop.stop_requested(); i = next++) {
          found[i] = observer.look_at(persons(static_cast<int>(i)));
          const std::lock_guard lock(mutex);
          progress(kImageShare * static_cast<double>(++done) / static_cast<double>(count));
        }
      });
    }
  }
  OffsetExamples examples{.inputs = kCorrectionInputs, .points = kJointCount, .known = {}, .offset_m = {}};
  for (const Example& example : found) {
    examples.known.insert(examples.known.end(), example.known.begin(), example.known.end());
    examples.offset_m.insert(examples.offset_m.end(), example.offset_m.begin(), example.offset_m.end());
  }
  auto network = train_offsets(
      examples, options.network, [&](double share) { progress(kImageShare + (1 - kImageShare) * share); }, stop);
  if (!network) return tl::unexpected(network.error());
  return plain->corrected_by(std::move(*network));
}

}  // namespace armature
