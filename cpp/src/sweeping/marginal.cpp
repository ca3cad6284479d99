// SPDX-License-Identifier: BSD-3-Clause
// One line of running sums over the mass crushed in psi (docs/theory/one_sweep.md, section 10).
#include "sweeping/marginal.hpp"

#include <algorithm>
#include <numeric>

namespace comminute::detail {
namespace {

constexpr double negligible = 1e-290;  // denormal numbers would slow every shell that follows

// Running sums of one line, shell by shell from coarse to fine.
class OneLine {
  public:
    explicit OneLine(const CrushTable& table) : table_(table), sums_(Eigen::ArrayXd::Zero(table.terms)) {}

    // Lets the sums decay by one shell, takes in mass that leaves the head, and returns the mass that lands.
    double advance(double enters) {
        if (++block_shell_ == table_.shells_a_block) {
            sums_ *= ConstLine(table_.block_decay.data(), table_.terms);
            sums_ = (sums_.abs() > negligible).select(sums_, 0.0);
            block_shell_ = 0;
        }
        sums_ += enters * ConstLine(table_.entering_at(block_shell_), table_.terms);
        return (sums_ * ConstLine(table_.falling_at(block_shell_), table_.terms)).sum();
    }

  private:
    const CrushTable& table_;
    Eigen::ArrayXd sums_;  // (K)
    Index block_shell_ = -1;
};

}  // namespace

std::vector<double> row_sums(MatrixView<const double> state) {
    Array<double> sums(state.rows());
    for (Index i = 0; i < state.rows(); ++i) sums[i] = ConstLine(state.row(i), state.cols()).sum();
    return std::move(sums).vector();
}

void move_marginal(const CrushTable& table, const Arrivals& arrivals, const Array<double>& crushed,
                   VectorView<double> grading) {
    const Index bins = table.bins;
    for (const OuterProduct& from : arrivals) {
        const double partners = std::accumulate(from.psibar.begin(), from.psibar.end(), 0.0);
        for (Index i = 0; i < bins; ++i) grading[i] += from.psi[i] * partners;
    }
    for (Index i = 0; i < bins; ++i) grading[0] += crushed[i] * table.below[i];
    OneLine line(table);
    for (Index i = bins - 1; i >= 1; --i) {
        double landed = 0.0;
        for (Index m = std::min(table.head, bins - 1 - i); m >= 1; --m) {
            landed += table.mass[m] * crushed[i + m];
        }
        const Index entering = i + table.head + 1;
        if (table.terms > 0) landed += line.advance(entering < bins ? crushed[entering] : 0.0);
        // The exact result is 0 if all of a bin crushes, and a negative one is rounding.
        grading[i] = std::max(grading[i] + landed - crushed[i], 0.0);
    }
}

}  // namespace comminute::detail
