#include "sdk/descriptors/tall_products.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <tbb/parallel_for.h>

#include "sdk/mesh/four.h"

namespace armature::sdk {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using ConstTall = Eigen::Ref<const MatrixXd>;

constexpr Index kRows = 2048;  // of a task
constexpr Index kStrip = 256;  // rows that stay in the first cache

ARMATURE_INLINE const FourAnywhere& at(const double* place) {
  return *reinterpret_cast<const FourAnywhere*>(place);
}

/// Adds the products of two columns with four, over some rows, to two rows of four sums.
ARMATURE_LANES void add_products(const std::array<const double*, 2>& a, const std::array<const double*, 4>& b,
                                 Index rows, double* sums) {
  Four s00{}, s01{}, s02{}, s03{}, s10{}, s11{}, s12{}, s13{};
  Index i = 0;
  for (; i + 4 <= rows; i += 4) {
    const Four x = at(a[0] + i), y = at(a[1] + i);
    const Four p = at(b[0] + i), q = at(b[1] + i), r = at(b[2] + i), s = at(b[3] + i);
    s00 += x * p, s01 += x * q, s02 += x * r, s03 += x * s;
    s10 += y * p, s11 += y * q, s12 += y * r, s13 += y * s;
  }
  const Four* const all[] = {&s00, &s01, &s02, &s03, &s10, &s11, &s12, &s13};
  for (std::size_t k = 0; k < 8; ++k) {
    const Four& s = *all[k];
    sums[k] += (s[0] + s[1]) + (s[2] + s[3]);
  }
  for (; i < rows; ++i)
    for (std::size_t k = 0; k < 8; ++k) sums[k] += a[k / 4][i] * b[k % 4][i];
}

/// w -= q0 c0 + q1 c1 + q2 c2 + q3 c3.
ARMATURE_LANES void subtract_four(const std::array<const double*, 4>& q, const std::array<double, 4>& c, Index rows,
                                  double* w) {
  // By value: what is written might be them.
  const auto [q0, q1, q2, q3] = q;
  const auto [c0, c1, c2, c3] = c;
  Index i = 0;
  for (; i + 4 <= rows; i += 4)
    *reinterpret_cast<FourAnywhere*>(w + i) -=
        (at(q0 + i) * c0 + at(q1 + i) * c1) + (at(q2 + i) * c2 + at(q3 + i) * c3);
  for (; i < rows; ++i) w[i] -= (q0[i] * c0 + q1[i] * c1) + (q2[i] * c2 + q3[i] * c3);
}

/// Columns from one on, the last over and over behind the end.
template <std::size_t N>
std::array<const double*, N> columns_from(const ConstTall& matrix, Index column, Index row) {
  std::array<const double*, N> found;
  for (std::size_t k = 0; k < N; ++k)
    found[k] = matrix.data() + std::min(column + static_cast<Index>(k), matrix.cols() - 1) * matrix.outerStride() + row;
  return found;
}

template <class Work>
void by_strips(Index rows, const Work& work) {
  tbb::parallel_for(Index{0}, (rows + kRows - 1) / kRows, [&](Index k) {
    const Index end = std::min(rows, (k + 1) * kRows);
    for (Index begin = k * kRows; begin < end; begin += kStrip) work(k, begin, std::min(kStrip, end - begin));
  });
}

}  // namespace

MatrixXd dot(const ConstTall& a, const ConstTall& b) {
  std::vector<MatrixXd> parts(static_cast<std::size_t>((a.rows() + kRows - 1) / kRows),
                              MatrixXd::Zero(a.cols(), b.cols()));
  by_strips(a.rows(), [&](Index task, Index begin, Index rows) {
    MatrixXd& part = parts[static_cast<std::size_t>(task)];
    for (Index i = 0; i < a.cols(); i += 2)
      for (Index j = 0; j < b.cols(); j += 4) {
        std::array<double, 8> sums{};
        add_products(columns_from<2>(a, i, begin), columns_from<4>(b, j, begin), rows, sums.data());
        for (Index k = 0; k < std::min<Index>(2, a.cols() - i); ++k)
          for (Index l = 0; l < std::min<Index>(4, b.cols() - j); ++l)
            part(i + k, j + l) += sums[static_cast<std::size_t>(4 * k + l)];
      }
  });
  MatrixXd sum = MatrixXd::Zero(a.cols(), b.cols());
  for (const MatrixXd& part : parts) sum += part;
  return sum;
}

void subtract(Eigen::Ref<MatrixXd> w, const ConstTall& q, const MatrixXd& c) {
  if (q.cols() == 0) return;
  by_strips(w.rows(), [&](Index, Index begin, Index rows) {
    for (Index j = 0; j < q.cols(); j += 4) {
      const auto columns = columns_from<4>(q, j, begin);
      for (Index k = 0; k < w.cols(); ++k) {
        std::array<double, 4> factors{};
        for (Index i = 0; i < std::min<Index>(4, q.cols() - j); ++i) factors[static_cast<std::size_t>(i)] = c(j + i, k);
        subtract_four(columns, factors, rows, w.col(k).data() + begin);
      }
    }
  });
}

MatrixXd times(const ConstTall& q, const MatrixXd& c) {
  MatrixXd result = MatrixXd::Zero(q.rows(), c.cols());
  subtract(result, q, -c);
  return result;
}

}  // namespace armature::sdk
