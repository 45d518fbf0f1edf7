#include "sdk/distance/bvh.h"

namespace armature::sdk {
namespace {

constexpr std::size_t kBins = 16;
constexpr int kDeepest = 48;  // beyond, ranges are halved, so that the stack of a descent is bounded

struct Range {
  std::size_t first = 0;
  std::size_t count = 0;
  UnitBox box;
};

class Builder {
 public:
  Builder(std::span<const UnitBox> boxes, std::size_t leaf_size, std::vector<Bvh::Node>& nodes,
          std::vector<std::uint32_t>& order)
      : boxes_(boxes), leaf_size_(leaf_size), nodes_(nodes), order_(order) {}

  void build() {
    order_.resize(boxes_.size());
    Range all{0, boxes_.size(), {}};
    for (std::size_t k = 0; k < boxes_.size(); ++k) {
      order_[k] = static_cast<std::uint32_t>(k);
      all.box.add(boxes_[k]);
    }
    nodes_.reserve(boxes_.size() / 2 + 1);
    add_node(all, 0);
  }

 private:
  [[nodiscard]] Eigen::Array4f twice_centre(std::size_t place) const {
    const UnitBox& box = boxes_[order_[place]];
    return box.lower + box.upper;
  }

  std::int32_t add_node(const Range& range, int depth) {
    std::array<Range, 4> parts{range};
    std::size_t count = 1;
    while (count < 4) {
      std::size_t widest = 4;
      for (std::size_t k = 0; k < count; ++k)
        if (parts[k].count > leaf_size_ && (widest == 4 || parts[k].box.half_area() > parts[widest].box.half_area()))
          widest = k;
      if (widest == 4) break;
      const auto [left, right] = split(parts[widest], depth);
      parts[widest] = left;
      parts[count++] = right;
    }

    const std::size_t at = nodes_.size();
    nodes_.emplace_back();
    const UnitBox none;
    for (std::size_t k = 0; k < 4; ++k) {
      const UnitBox& box = k < count ? parts[k].box : none;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        nodes_[at].lower[axis][static_cast<Eigen::Index>(k)] = box.lower[static_cast<Eigen::Index>(axis)];
        nodes_[at].upper[axis][static_cast<Eigen::Index>(k)] = box.upper[static_cast<Eigen::Index>(axis)];
      }
    }
    for (std::size_t k = 0; k < 4; ++k) {
      std::int32_t child = ~std::int32_t{0};
      if (k < count && parts[k].count <= leaf_size_)
        child = ~static_cast<std::int32_t>(parts[k].first * 8 + parts[k].count - 1);
      else if (k < count)
        child = add_node(parts[k], depth + 1);
      nodes_[at].child[k] = child;
    }
    return static_cast<std::int32_t>(at);
  }

  /// Cuts a range in two along the longest extent of its centres, at the cheapest of a few planes.
  std::pair<Range, Range> split(const Range& range, int depth) {
    UnitBox centres;
    for (std::size_t k = 0; k < range.count; ++k) {
      const Eigen::Array4f c = twice_centre(range.first + k);
      centres.add({c, c});
    }
    const Eigen::Array4f extent = centres.upper - centres.lower;
    Eigen::Index axis = extent[1] > extent[0] ? 1 : 0;
    if (extent[2] > extent[axis]) axis = 2;
    if (depth >= kDeepest || !(extent[axis] > 0)) return halve(range, axis);

    const float lower = centres.lower[axis];
    const float to_bin = static_cast<float>(kBins) * (1 - 1e-6F) / extent[axis];
    const auto bin_of = [&](std::uint32_t item) {
      const float centre = boxes_[item].lower[axis] + boxes_[item].upper[axis];
      return std::min(kBins - 1, static_cast<std::size_t>((centre - lower) * to_bin));
    };
    std::array<UnitBox, kBins> bins;
    std::array<std::size_t, kBins> counts{};
    for (std::size_t k = 0; k < range.count; ++k) {
      const std::uint32_t item = order_[range.first + k];
      const std::size_t bin = bin_of(item);
      bins[bin].add(boxes_[item]);
      ++counts[bin];
    }
    const auto cut = cheapest_cut(bins, counts);
    if (!cut.left.count || !cut.right.count) return halve(range, axis);
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(range.first);
    std::partition(begin, begin + static_cast<std::ptrdiff_t>(range.count),
                   [&](std::uint32_t item) { return bin_of(item) < cut.bin; });
    Range left{range.first, cut.left.count, cut.left.box};
    Range right{range.first + cut.left.count, cut.right.count, cut.right.box};
    return {left, right};
  }

  struct Cut {
    std::size_t bin = 0;
    Range left, right;
  };

  static Cut cheapest_cut(const std::array<UnitBox, kBins>& bins, const std::array<std::size_t, kBins>& counts) {
    std::array<Range, kBins> right;
    Range sum;
    for (std::size_t k = kBins; k-- > 1;) {
      sum.box.add(bins[k]);
      sum.count += counts[k];
      right[k] = sum;
    }
    Cut best;
    float best_cost = std::numeric_limits<float>::infinity();
    sum = {};
    for (std::size_t k = 1; k < kBins; ++k) {
      sum.box.add(bins[k - 1]);
      sum.count += counts[k - 1];
      if (!sum.count || !right[k].count) continue;
      const float cost = sum.box.half_area() * static_cast<float>(sum.count) +
                         right[k].box.half_area() * static_cast<float>(right[k].count);
      if (cost < best_cost) {
        best_cost = cost;
        best = {k, sum, right[k]};
      }
    }
    return best;
  }

  std::pair<Range, Range> halve(const Range& range, Eigen::Index axis) {
    const auto begin = order_.begin() + static_cast<std::ptrdiff_t>(range.first);
    const auto half = static_cast<std::ptrdiff_t>(range.count / 2);
    std::nth_element(begin, begin + half, begin + static_cast<std::ptrdiff_t>(range.count),
                     [&](std::uint32_t a, std::uint32_t b) {
                       const float ca = boxes_[a].lower[axis] + boxes_[a].upper[axis];
                       const float cb = boxes_[b].lower[axis] + boxes_[b].upper[axis];
                       return ca < cb || (ca == cb && a < b);
                     });
    Range left{range.first, range.count / 2, {}};
    Range right{range.first + left.count, range.count - left.count, {}};
    for (Range* part : {&left, &right})
      for (std::size_t k = 0; k < part->count; ++k) part->box.add(boxes_[order_[part->first + k]]);
    return {left, right};
  }

  std::span<const UnitBox> boxes_;
  std::size_t leaf_size_;
  std::vector<Bvh::Node>& nodes_;
  std::vector<std::uint32_t>& order_;
};

}  // namespace

UnitFrame::UnitFrame(const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) noexcept {
  origin = 0.5 * lower + 0.5 * upper;
  const double extent = (upper - lower).maxCoeff();
  if (extent > std::numeric_limits<double>::min() && std::isfinite(1 / extent)) scale = 2 / extent;
}

UnitBox unit_box(const UnitFrame& frame, const Eigen::Vector3d& lower, const Eigen::Vector3d& upper) noexcept {
  constexpr float kPad = 2.5e-7F;
  const Eigen::Vector3f a = frame.to_unit(lower);
  const Eigen::Vector3f b = frame.to_unit(upper);
  return {Eigen::Array4f(a[0], a[1], a[2], 0) - kPad, Eigen::Array4f(b[0], b[1], b[2], 0) + kPad};
}

Bvh::Bvh(std::span<const UnitBox> boxes, std::size_t leaf_size) {
  if (!boxes.empty()) Builder(boxes, leaf_size, nodes_, order_).build();
}

UnitRay::UnitRay(const UnitFrame& frame, const Eigen::Vector3d& from, const Eigen::Vector3d& direction) noexcept {
  const Eigen::Vector3f start = frame.to_unit(from);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    // A direction of zero along an axis would make 0 x infinity of a box that the ray runs along.
    double along = direction[axis] * frame.scale;
    const double least = 1e-12 * direction.cwiseAbs().maxCoeff() * frame.scale;
    if (std::abs(along) < least) along = std::copysign(least, along);
    origin[k] = start[axis];
    inverse[k] = static_cast<float>(1 / along);
  }
}

}  // namespace armature::sdk
