#include "tracker/forest/part_classifier.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <tuple>
#include <vector>

#include "tracker/forest/part_feature.h"
#include "tracker/forest/tree_walk.h"

namespace armature {
namespace {

struct Box {
  int left = 0, top = 0, right = 0, bottom = 0;  // right and bottom exclusive
};

/// `columns` is [width], for its own use.
Box bounding_box(std::span<const std::uint8_t> mask, std::uint8_t user, int height,
                 std::span<std::uint8_t> columns) noexcept {
  const auto width = columns.size();
  std::ranges::fill(columns, std::uint8_t{0});
  int top = height, bottom = 0;
  for (int v = 0; v < height; ++v) {
    const std::uint8_t* row = mask.data() + static_cast<std::size_t>(v) * width;
    if (std::memchr(row, user, width) == nullptr) continue;
    for (std::size_t u = 0; u < width; ++u) columns[u] |= static_cast<std::uint8_t>(row[u] == user);
    top = std::min(top, v);
    bottom = v + 1;
  }
  if (bottom == 0) return {};
  const auto first = std::ranges::find(columns, std::uint8_t{1});
  const auto last = std::find(columns.rbegin(), columns.rend(), std::uint8_t{1});
  return {static_cast<int>(first - columns.begin()), top, static_cast<int>(columns.rend() - last), bottom};
}

}  // namespace

PartLabel most_likely_part(const ClassifiedPixel& pixel) noexcept {
  std::array<std::uint16_t, std::tuple_size_v<decltype(Leaf::probability)>> mean{};
  std::uint16_t trees = 0;
  for (const Leaf* leaf : pixel.leaves) {
    if (leaf == nullptr) break;
    for (std::size_t part = 0; part < mean.size(); ++part) {
      mean[part] = static_cast<std::uint16_t>(mean[part] + leaf->probability[part]);
    }
    ++trees;
  }
  if (trees == 0) return PartLabel{0};
  for (std::uint16_t& part : mean) part = static_cast<std::uint16_t>(part / trees);
  return static_cast<PartLabel>(std::max_element(mean.begin(), mean.begin() + kPartCount) - mean.begin());
}

struct PartClassifier::State {
  std::shared_ptr<const Forest> forest;
  ClassifierOptions options;
  Intrinsics intrinsics;
  std::vector<std::uint16_t> person;  // the person image, with room for the whole frame and its border
  std::vector<std::uint8_t> columns;  // [width], scratch
  std::vector<TreeWalk> walks;        // one a tree
  std::vector<ClassifiedPixel> pixels;
  std::vector<WalkStart> starts;      // of each pixel
  std::vector<std::uint32_t> leaves;  // of each pixel, in the tree at hand
  PartVotes votes;

  [[nodiscard]] int stride() const noexcept {
    return options.stride > 0 ? options.stride : std::max(1, (intrinsics.width + 80) / 160);
  }
  [[nodiscard]] PersonImage cut_out(DepthView frame, std::span<const std::uint8_t> mask, std::uint8_t user,
                                    const Box& box) noexcept;
  std::size_t sample_pixels(const PersonImage& image, const Box& box) noexcept;
  void classify(const PersonImage& image, const Box& box, std::size_t count) noexcept;
};

PersonImage PartClassifier::State::cut_out(DepthView frame, std::span<const std::uint8_t> mask, std::uint8_t user,
                                           const Box& box) noexcept {
  const int width = box.right - box.left + 2;
  const int height = box.bottom - box.top + 2;
  const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  std::fill_n(person.begin(), size, kBackgroundDepth_mm);
  for (int v = box.top; v < box.bottom; ++v) {
    const std::size_t from =
        static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width()) + static_cast<std::size_t>(box.left);
    std::uint16_t* out =
        person.data() + static_cast<std::size_t>(v - box.top + 1) * static_cast<std::size_t>(width) + 1;
    for (std::size_t i = 0; i < static_cast<std::size_t>(width) - 2; ++i) {
      const std::uint16_t depth = frame.depth_mm[from + i];
      const bool inside = mask[from + i] == user && depth != 0 && depth <= kMaxPersonDepth_mm;
      out[i] = inside ? depth : kBackgroundDepth_mm;
    }
  }
  return {person.data(), width, height};
}

std::size_t PartClassifier::State::sample_pixels(const PersonImage& image, const Box& box) noexcept {
  const int step = stride();
  const auto fx = static_cast<float>(intrinsics.focal_x_px);
  const auto fy = static_cast<float>(intrinsics.focal_y_px);
  const auto cx = static_cast<float>(intrinsics.centre_x_px);
  const auto cy = static_cast<float>(intrinsics.centre_y_px);
  const auto first = [step](int from) { return (from + step - 1) / step * step; };
  std::size_t count = 0;
  for (int v = first(box.top); v < box.bottom; v += step) {
    for (int u = first(box.left); u < box.right; u += step) {
      const std::uint16_t depth = image.depth_mm[(v - box.top + 1) * image.width + u - box.left + 1];
      if (depth == kBackgroundDepth_mm) continue;
      ClassifiedPixel& pixel = pixels[count++];
      const float z = static_cast<float>(depth) * 0.001F;
      const float x_per_column = z / fx;
      const float y_per_row = z / fy;
      pixel.u = static_cast<std::uint16_t>(u);
      pixel.v = static_cast<std::uint16_t>(v);
      pixel.point = {(static_cast<float>(u) - cx) * x_per_column, (static_cast<float>(v) - cy) * y_per_row, z};
      pixel.area_m2 = x_per_column * y_per_row * static_cast<float>(step * step);
    }
  }
  return count;
}

void PartClassifier::State::classify(const PersonImage& image, const Box& box, std::size_t count) noexcept {
  const FixedFocal focal = fixed_focal(intrinsics.focal_x_px, intrinsics.focal_y_px);
  for (std::size_t i = 0; i < count; ++i) {
    const int u = pixels[i].u - box.left + 1;
    const int v = pixels[i].v - box.top + 1;
    starts[i] = {u, v, probe_scale(focal, image.depth_mm[v * image.width + u])};
  }
  for (std::size_t t = 0; t < walks.size(); ++t) {
    walks[t].find_leaves(image, std::span(starts).first(count), leaves);
    const Leaf* const tree_leaves = forest->trees()[t].leaves.data();
    for (std::size_t i = 0; i < count; ++i) {
      pixels[i].leaves[t] = tree_leaves + leaves[i];
      // Two cache lines that will soon be read.
      __builtin_prefetch(pixels[i].leaves[t]->votes.data());
      __builtin_prefetch(&pixels[i].leaves[t]->probability.back());
    }
  }
}

PartClassifier::PartClassifier(std::shared_ptr<const Forest> forest, const ClassifierOptions& options)
    : state_(std::make_unique<State>()) {
  state_->forest = std::move(forest);
  state_->options = options;
  for (const Tree& tree : state_->forest->trees()) state_->walks.emplace_back(tree);
}
PartClassifier::~PartClassifier() = default;
PartClassifier::PartClassifier(PartClassifier&&) noexcept = default;
PartClassifier& PartClassifier::operator=(PartClassifier&&) noexcept = default;

void PartClassifier::reset(const Intrinsics& intrinsics) {
  State& s = *state_;
  s.intrinsics = intrinsics;
  const auto width = static_cast<std::size_t>(intrinsics.width);
  const auto height = static_cast<std::size_t>(intrinsics.height);
  const auto step = static_cast<std::size_t>(s.stride());
  s.person.assign((width + 2) * (height + 2), kBackgroundDepth_mm);
  s.columns.assign(width, 0);
  const std::size_t samples = (width / step + 1) * (height / step + 1);
  s.pixels.assign(samples, {});
  s.starts.assign(samples, {});
  s.leaves.assign(samples, 0);
  s.votes = {{}, s.stride()};
}

const PartVotes& PartClassifier::classify(DepthView frame, std::span<const std::uint8_t> user_of_pixel,
                                          std::uint8_t user) noexcept {
  State& s = *state_;
  s.votes.pixels = {};
  if (frame.intrinsics != s.intrinsics || user_of_pixel.size() != frame.depth_mm.size() || user == 0) return s.votes;
  const Box box = bounding_box(user_of_pixel, user, frame.height(), s.columns);
  if (box.bottom == 0) return s.votes;
  const PersonImage image = s.cut_out(frame, user_of_pixel, user, box);
  const std::size_t count = s.sample_pixels(image, box);
  s.classify(image, box, count);
  s.votes.pixels = std::span(s.pixels).first(count);
  return s.votes;
}

const Forest& PartClassifier::forest() const noexcept {
  return *state_->forest;
}

}  // namespace armature
