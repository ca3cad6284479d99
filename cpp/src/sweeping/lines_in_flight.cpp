// SPDX-License-Identifier: BSD-3-Clause
// Running sums and head of the lines, shell by shell (docs/theory/one_sweep.md, section 7).
#include "sweeping/lines_in_flight.hpp"

#include <algorithm>

#include "simd/loops.hpp"
#include "simd/sums.hpp"

namespace comminute::detail {

LinesInFlight::LinesInFlight(const ShellWalk& walk) : walk_(walk), entering_(walk.bins() + lanes) {}

void LinesInFlight::begin(bool keep_for_far_field) {
    const Index bins = walk_.bins();
    const Index head = walk_.table().head;
    const Index terms = walk_.table().terms;
    if (walk_.without_head()) {
        width_ = lanes_up(bins);
        shells_kept_ = 1;
    } else {
        width_ = lanes_up(walk_.longest() + 1) + 2 * lanes;
        shells_kept_ = keep_for_far_field ? bins : std::min(bins, head + 2);
    }
    sums_.assign(std::max(terms, Index{1}) * lanes_up(bins), 0.0);
    own_.assign(terms, 0.0);
    pushed_.assign(shells_kept_ * width_, 0.0);
    fines_.assign(lanes_up(bins), 0.0);
    near_.resize(keep_for_far_field && head > 0 ? terms * bins : 0);
    far_.resize(keep_for_far_field ? terms * bins : 0);
}

void LinesInFlight::begin_block(Index m) {
    const Index from = lanes_down(walk_.first(m));
    decay(walk_.table().block_decay.data(), walk_.table().terms, sums(from), lanes_up(m + 1) - from);
}

double LinesInFlight::arrive_on_diagonal(Index m) {
    const CrushTable& table = walk_.table();
    const Index shell = m + table.head + 1;
    const double enters = shell < walk_.bins() && walk_.first(shell) <= m ? *pushed(shell, m) : 0.0;
    const double* sums = sums_.data() + lanes_down(m) * table.terms + m % lanes;
    const double* weight = walk_.entering();
    const double* decay = walk_.falling();
    double arriving = 0.0;
    for (Index a = 0; a < table.terms; ++a) {
        own_[a] = decay[a] * (sums[a * lanes] + weight[a] * enters);
        arriving += own_[a];
    }
    for (Index above = walk_.coarsest_in_head(m); above > m; --above) {
        arriving += table.mass[above - m] * *pushed(above, m);
    }
    return arriving;
}

double LinesInFlight::add_in_fines(Index m, double landed) const {
    const CrushTable& table = walk_.table();
    const double* decay = walk_.falling();
    for (Index a = 0; a < table.terms; ++a) landed += decay[a] * sums_[a * lanes];
    for (Index shell = walk_.first(m) == 0 ? walk_.coarsest_in_head(m) : m; shell > m; --shell) {
        if (walk_.first(shell) == 0) landed += table.mass[shell - m] * *pushed(shell, 0);
    }
    return landed;
}

void LinesInFlight::add_head(Index m, Index from, double* landed) const {
    const Index begin = std::max(walk_.first(m), walk_.first(from));
    if (begin < m && from > m) {
        add_scaled(walk_.table().mass[from - m], pushed(from, begin), landed + begin, m - begin);
    }
}

const double* LinesInFlight::entering_sums(Index m) {
    if (walk_.without_head()) return pushed_.data() + lanes_down(walk_.first(m));
    const Index shell = m + walk_.table().head + 1;
    const Index begin = lanes_down(walk_.first(m));
    const Index from = shell < walk_.bins() ? std::max(walk_.first(m), walk_.first(shell)) : m;
    double* const entering = entering_.data();
    std::fill(entering + begin, entering + lanes_up(m), 0.0);
    if (from < m) std::copy_n(pushed(shell, from), m - from, entering + from);
    return entering + begin;
}

void LinesInFlight::keep_for_far_field(Index m) {
    const CrushTable& table = walk_.table();
    double* const far = far_.data() + m * table.terms;
    if (walk_.without_head()) {
        const double half = *pushed(m, m);
        for (Index a = 0; a < table.terms; ++a) far[a] = own_[a] + table.coefficient[a] * half;
        return;
    }
    for (Index a = 0; a < table.terms; ++a) far[a] = own_[a] * table.powers(a)[table.head];
    const Index last = std::min(m + table.head, walk_.bins() - 1);
    for (Index shell = m; shell <= last && walk_.first(shell) <= m; ++shell) {
        const double mass = *pushed(shell, m);
        for (Index a = 0; a < table.terms; ++a) {
            far[a] += table.coefficient[a] * mass * table.powers(a)[shell - m];
        }
    }
    std::copy(own_.begin(), own_.end(), near_.begin() + m * table.terms);
}

}  // namespace comminute::detail
