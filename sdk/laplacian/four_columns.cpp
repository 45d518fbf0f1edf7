#include "sdk/laplacian/four_columns.h"

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sdk/mesh/four.h"

namespace armature::sdk {
namespace {

/// A block's columns, one behind the other, and where its rows are.
struct Panel {
  const double* L;
  std::size_t height, width;
  const std::uint32_t* rows;  // below the block's own

  [[nodiscard]] std::size_t below() const noexcept { return height - width; }
};

/// own = L^-1 own, and what that takes from the rows below.
ARMATURE_LANES void forward(const Panel& panel, FourAnywhere* own, FourAnywhere* x) {
  const auto& [L, height, width, rows] = panel;
  for (std::size_t k = 0; k < width; ++k) {
    const double* l = L + k * height;
    own[k] /= l[k];
    for (std::size_t i = k + 1; i < width; ++i) own[i] -= l[i] * own[k];
  }
  std::size_t i = width;
  for (; i + 4 <= height; i += 4) {
    Four a{}, b{}, c{}, d{};
    for (std::size_t k = 0; k < width; ++k) {
      const double* l = L + k * height + i;
      a += l[0] * own[k], b += l[1] * own[k], c += l[2] * own[k], d += l[3] * own[k];
    }
    const std::uint32_t* row = rows + (i - width);
    x[row[0]] -= a, x[row[1]] -= b, x[row[2]] -= c, x[row[3]] -= d;
  }
  for (; i < height; ++i) {
    Four sum{};
    for (std::size_t k = 0; k < width; ++k) sum += L[k * height + i] * own[k];
    x[rows[i - width]] -= sum;
  }
}

/// own = L^-T own, given the rows below.
ARMATURE_LANES void backward(const Panel& panel, FourAnywhere* own, const FourAnywhere* below) {
  const auto& [L, height, width, rows] = panel;
  std::size_t k = width;
  for (; k % 4 != 0; --k) {
    const double* l = L + (k - 1) * height + width;
    for (std::size_t i = 0; i < panel.below(); ++i) own[k - 1] -= l[i] * below[i];
  }
  for (; k > 0; k -= 4) {
    const double* l0 = L + (k - 4) * height + width;
    const double *l1 = l0 + height, *l2 = l1 + height, *l3 = l2 + height;
    Four a{}, b{}, c{}, d{};
    for (std::size_t i = 0; i < panel.below(); ++i) {
      const Four known = below[i];
      a += l0[i] * known, b += l1[i] * known, c += l2[i] * known, d += l3[i] * known;
    }
    own[k - 4] -= a, own[k - 3] -= b, own[k - 2] -= c, own[k - 1] -= d;
  }
  for (k = width; k-- > 0;) {
    const double* l = L + k * height;
    for (std::size_t i = k + 1; i < width; ++i) own[k] -= l[i] * own[i];
    own[k] /= l[k];
  }
}

}  // namespace

void solve_four(const BlockStructure& structure, std::span<const double> values, std::span<double> x) {
  const auto panel = [&](std::size_t block) {
    return Panel{.L = values.data() + structure.value_starts[block],
                 .height = structure.height(block),
                 .width = structure.width(block),
                 .rows = structure.rows(block).data()};
  };
  auto* const all = reinterpret_cast<FourAnywhere*>(x.data());
  for (std::size_t block = 0; block < structure.blocks(); ++block)
    forward(panel(block), all + structure.first(block), all);
  std::vector<double> below;
  for (std::size_t block = structure.blocks(); block-- > 0;) {
    below.clear();
    for (const std::uint32_t row : structure.rows(block)) {
      const auto four = x.subspan(4 * std::size_t{row}, 4);
      below.insert(below.end(), four.begin(), four.end());
    }
    backward(panel(block), all + structure.first(block), reinterpret_cast<const FourAnywhere*>(below.data()));
  }
}

}  // namespace armature::sdk
