// SPDX-License-Identifier: BSD-3-Clause
// Transposition of the band's columns by squares (docs/theory/one_sweep.md, section 8).
#include "sweeping/state_columns.hpp"

#include <algorithm>

#include "simd/loops.hpp"

namespace comminute::detail {

StateColumns::StateColumns(const ShellWalk& walk)
    : walk_(walk), stride_(row_stride(walk.bins())), block_(shells * stride_) {}

// A square may reach below the diagonal; what is read there is never looked at.
void StateColumns::take(MatrixView<const double> state, Index begin, Index end) {
    begin_ = begin;
    end_ = end;
    for (Index i = lanes_down(walk_.first(begin)); i < end - 1; i += lanes) {
        const Index rows_end = std::min(i + lanes, walk_.bins());
        for (Index r = i + lanes; r < std::min(i + 2 * lanes, end); ++r) {
            fetch(state.row(r) + begin, end - begin);
        }
        for (Index m_end = end; m_end > std::max(begin, i + 1); m_end -= lanes) {
            const Index m = std::max(m_end - lanes, begin);
            if (rows_end <= walk_.first(m)) continue;
            if (m_end - m == lanes && rows_end - i == lanes) {
                transpose(state.row(i) + m, state.stride(), column(m) + i, stride_);
                continue;
            }
            for (Index row = i; row < rows_end; ++row) {
                for (Index c = m; c < m_end; ++c) column(c)[row] = state(row, c);
            }
        }
    }
}

void StateColumns::give(MatrixView<double> out) const {
    for (Index i = walk_.first(begin_); i < end_ - 1; ++i) {
        for (Index m = std::max(begin_, i + 1); m < end_; ++m) {
            if (walk_.first(m) <= i) out(i, m) = block_[(m - begin_) * stride_ + i];
        }
    }
}

}  // namespace comminute::detail
