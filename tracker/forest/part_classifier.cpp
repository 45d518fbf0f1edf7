#include "tracker/forest/part_classifier.h"

#include <algorithm>
#include <vector>

#include "tracker/forest/part_feature.h"

namespace armature {
namespace {

/// As many pixels as walk down a tree together, so that one's cache misses hide behind the others' work.
constexpr std::size_t kInterleave = 16;

struct Box {
  int left = 0, top = 0, right = 0, bottom = 0;  // right and bottom exclusive
};

Box bounding_box(std::span<const std::uint8_t> mask, std::uint8_t user, int width, int height) noexcept {
  Box box{width, height, 0, 0};
  for (int v = 0; v < height; ++v) {
    const auto row =
        mask.subspan(static_cast<std::size_t>(v) * static_cast<std::size_t>(width), static_cast<std::size_t>(width));
    const auto first = std::find(row.begin(), row.end(), user);
    if (first == row.end()) continue;
    const auto last = std::find(row.rbegin(), row.rend(), user);
    box.left = std::min(box.left, static_cast<int>(first - row.begin()));
    box.right = std::max(box.right, static_cast<int>(row.rend() - last));
    box.top = std::min(box.top, v);
    box.bottom = v + 1;
  }
  return box;
}

struct Walker {
  std::int32_t node = 0;
  int u = 0, v = 0;  // in the person image
  ProbeScale scale;
};

/// Walks every walker to a leaf; its node is then ~leaf.
void walk(const Tree& tree, const PersonImage& image, std::span<Walker> walkers) noexcept {
  bool any = !tree.nodes.empty();
  if (!any) {
    for (Walker& walker : walkers) walker.node = ~0;
    return;
  }
  for (Walker& walker : walkers) walker.node = 0;
  while (any) {
    any = false;
    for (Walker& walker : walkers) {
      if (walker.node < 0) continue;
      const SplitNode& node = tree.nodes[static_cast<std::size_t>(walker.node)];
      const bool right = part_feature(image, walker.u, walker.v, walker.scale, node) >= node.threshold_mm;
      walker.node = node.child[right ? 1 : 0];
      any = any || walker.node >= 0;
    }
  }
}

}  // namespace

PartLabel most_likely_part(const ClassifiedPixel& pixel) noexcept {
  const auto best = std::max_element(pixel.probability.begin(), pixel.probability.begin() + kPartCount);
  return static_cast<PartLabel>(best - pixel.probability.begin());
}

struct PartClassifier::State {
  std::shared_ptr<const Forest> forest;
  ClassifierOptions options;
  Intrinsics intrinsics;
  std::vector<std::uint16_t> person;  // the person image, with room for the whole frame and its border
  std::vector<ClassifiedPixel> pixels;
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
  const auto trees = forest->trees();
  std::array<Walker, kInterleave> block;
  for (std::size_t begin = 0; begin < count; begin += kInterleave) {
    const std::size_t size = std::min(kInterleave, count - begin);
    const auto walkers = std::span(block).first(size);
    for (std::size_t i = 0; i < size; ++i) {
      const ClassifiedPixel& pixel = pixels[begin + i];
      walkers[i].u = pixel.u - box.left + 1;
      walkers[i].v = pixel.v - box.top + 1;
      walkers[i].scale = probe_scale(focal, image.depth_mm[walkers[i].v * image.width + walkers[i].u]);
    }
    for (std::size_t t = 0; t < trees.size(); ++t) {
      walk(trees[t], image, walkers);
      for (std::size_t i = 0; i < size; ++i) {
        pixels[begin + i].leaves[t] = &trees[t].leaves[static_cast<std::size_t>(~walkers[i].node)];
      }
    }
    for (std::size_t i = 0; i < size; ++i) {
      ClassifiedPixel& pixel = pixels[begin + i];
      std::array<std::uint16_t, 32> sum{};
      for (std::size_t t = 0; t < trees.size(); ++t) {
        for (std::size_t part = 0; part < sum.size(); ++part) {
          sum[part] = static_cast<std::uint16_t>(sum[part] + pixel.leaves[t]->probability[part]);
        }
      }
      const auto tree_count = static_cast<std::uint32_t>(trees.size());
      const std::uint32_t reciprocal = (65536 + tree_count - 1) / tree_count;
      for (std::size_t part = 0; part < sum.size(); ++part) {
        pixel.probability[part] = static_cast<std::uint8_t>((sum[part] * reciprocal) >> 16U);
      }
    }
  }
}

PartClassifier::PartClassifier(std::shared_ptr<const Forest> forest, const ClassifierOptions& options)
    : state_(std::make_unique<State>()) {
  state_->forest = std::move(forest);
  state_->options = options;
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
  s.pixels.assign((width / step + 1) * (height / step + 1), {});
  s.votes = {{}, s.stride()};
}

const PartVotes& PartClassifier::classify(DepthView frame, std::span<const std::uint8_t> user_of_pixel,
                                          std::uint8_t user) noexcept {
  State& s = *state_;
  s.votes.pixels = {};
  if (frame.intrinsics != s.intrinsics || user_of_pixel.size() != frame.depth_mm.size() || user == 0) return s.votes;
  const Box box = bounding_box(user_of_pixel, user, frame.width(), frame.height());
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
