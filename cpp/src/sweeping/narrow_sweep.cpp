// SPDX-License-Identifier: BSD-3-Clause
// Problems into lanes, and their results back out (docs/theory/one_sweep.md, section 15).
#include "sweeping/narrow_sweep.hpp"

#include <algorithm>
#include <numeric>

#include "simd/loops.hpp"

namespace comminute::detail {

// Numbers are only ever added to a workspace, so that solves of one size allocate once.
void NarrowSweep::at_least(LaneArray& numbers, Index count) {
    if (numbers.size() < count) numbers.resize(count);
}

LaneArray NarrowSweep::with_margins(const Array<double>& shares) {
    LaneArray numbers(shares.size() + 2 * narrow_margin);
    std::copy(shares.begin(), shares.end(), numbers.begin() + narrow_margin);
    return numbers;
}

void NarrowSweep::begin(const CrushTable& table, VectorView<const Problem> problems) {
    if (&table != table_) {
        table_ = &table;
        mass_ = with_margins(table.mass);
        below_ = with_margins(table.below);
        mass_upwards_ = mass_;
        std::reverse(mass_upwards_.begin(), mass_upwards_.end());
    }
    side_by_side_ = problems.size() == 1 ? 1 : lanes;
    width_ = 0;
    for (const Problem& problem : problems) width_ = std::max(width_, problem.zones->width());
    reach_.assign(bins_, -1);
    for (const Problem& problem : problems) {
        for (Index m = 0; m < bins_; ++m) reach_[m] = std::max(reach_[m], problem.zones->last(m));
    }
    line_.assign(bins_, -1);
    for (Index m = 0; m < bins_; ++m) {
        for (Index d = 0; d <= reach_[m]; ++d) line_[m - d] = std::max(line_[m - d], d);
    }
    const Index in_band = bins_ * (width_ + 1) * side_by_side_;
    for (LaneArray* numbers : {&settled_, &arrived_, &down_, &along_}) at_least(*numbers, in_band);
    // The coarsest lines end at the top of the grid, before the band does.
    const Index cut_lines = std::min(width_, bins_) * (width_ + 1) * side_by_side_;
    for (LaneArray* lines : {&down_, &along_}) {
        std::fill_n(lines->begin() + (in_band - cut_lines), cut_lines, 0.0);
    }
    at_least(cells_, bins_ * (2 * width_ + 1) * side_by_side_);
    at_least(crushed_, bins_ * side_by_side_);
    at_least(neighbour_, side_by_side_);
}

// The shares of each problem, whose own band may be narrower than that of all.
void NarrowSweep::set_shares(VectorView<const Problem> problems) {
    const Index in_band = bins_ * (width_ + 1) * side_by_side_;
    std::fill_n(settled_.begin(), in_band, 0.0);
    std::fill_n(arrived_.begin(), in_band, 0.0);
    for (Index p = 0; p < problems.size(); ++p) {
        const ZonePair& zones = *problems[p].zones;
        const Index stride = std::max(zones.width(), Index{0}) + 1;
        for (Index m = 0; m < bins_; ++m) {
            for (Index d = 0; d <= zones.last(m); ++d) {
                const Index to = (m * (width_ + 1) + d) * side_by_side_ + p;
                settled_[to] = zones.settled()[m * stride + d];
                arrived_[to] = zones.arrived()[m * stride + d];
            }
        }
    }
}

void NarrowSweep::take_cells(VectorView<const Problem> problems) {
    const Index across = 2 * width_ + 1;
    const double* const first = problems[0].state.data();
    const bool shared =
        side_by_side_ > 1 && std::all_of(problems.begin(), problems.end(), [&](const Problem& p) {
            return p.state.data() == first && p.state.stride() == problems[0].state.stride();
        });
    if (problems.size() < side_by_side_) std::fill_n(cells_.begin(), bins_ * across * side_by_side_, 0.0);
    for (Index i = 0; i < bins_; ++i) {
        const Index begin = std::max(i - width_, Index{0});
        const Index end = std::min(i + width_ + 1, bins_);
        double* const to = cells_.data() + (i * across + width_ - i) * side_by_side_;
        if (shared) {
            const double* const row = problems[0].state.row(i);
            for (Index j = begin; j < end; ++j) std::fill_n(to + j * lanes, lanes, row[j]);
            continue;
        }
        for (Index p = 0; p < problems.size(); ++p) {
            const double* const row = problems[p].state.row(i);
            for (Index j = begin; j < end; ++j) to[j * side_by_side_ + p] = row[j];
        }
    }
}

// Outer products by lane; a problem with fewer than the others has some that are 0.
Index NarrowSweep::take_arrivals(VectorView<const Problem> problems) {
    Index products = 0;
    for (const Problem& problem : problems) {
        products = std::max(products, static_cast<Index>(problem.arrivals->size()));
    }
    psi_.assign(products * bins_ * side_by_side_, 0.0);
    psibar_.assign(products * bins_ * side_by_side_, 0.0);
    for (Index p = 0; p < problems.size(); ++p) {
        Index to = p;
        for (const OuterProduct& product : *problems[p].arrivals) {
            for (Index i = 0; i < bins_; ++i, to += side_by_side_) {
                psi_[to] = product.psi[i];
                psibar_[to] = product.psibar[i];
            }
        }
    }
    return products;
}

// Lines of the problems, which lie side by side, one by one: line d of problem p begins at (d * problems + p) * stride.
void NarrowSweep::part_lines(const LaneArray& together, double* parted, Index stride) const {
    const Index in_line = (width_ + 1) * side_by_side_;
    for (Index d = 0; d <= width_; ++d) {
        const double* const from = together.data() + d * side_by_side_;
        double* const to = parted + d * side_by_side_ * stride;
        if (side_by_side_ == 1) {
            for (Index line = 0; line < bins_; ++line) to[line] = from[line * in_line];
            continue;
        }
        Index line = 0;
        for (; line + lanes <= bins_; line += lanes) {
            transpose(from + line * in_line, in_line, to + line, stride);
        }
        for (; line < bins_; ++line) {
            for (Index p = 0; p < lanes; ++p) to[p * stride + line] = from[line * in_line + p];
        }
    }
}

void NarrowSweep::give_states(VectorView<const Problem> problems) {
    const Index stride = row_stride(bins_);
    const Index across = 2 * width_ + 1;
    const Index size = (width_ + 1) * side_by_side_ * stride;
    at_least(lines_, 2 * size);
    part_lines(along_, lines_.data(), stride);
    part_lines(down_, lines_.data() + size, stride);
    for (Index p = 0; p < problems.size(); ++p) {
        const Problem& problem = problems[p];
        LaneArray& psi = psi_;
        const auto products = static_cast<Index>(problem.arrivals->size());
        psi.resize(products * bins_);
        psibar_.resize(products * bins_);
        Index to = 0;
        for (const OuterProduct& product : *problem.arrivals) {
            std::copy(product.psi.begin(), product.psi.end(), psi.begin() + to);
            std::copy(product.psibar.begin(), product.psibar.end(), psibar_.begin() + to);
            to += bins_;
        }
        const double* const along = lines_.data() + p * stride;
        land_outside({bins_,
                      width_,
                      mass_.data() + narrow_margin,
                      mass_upwards_.data() + narrow_margin,
                      below_.data() + narrow_margin,
                      along,
                      along + size,
                      side_by_side_ * stride,
                      {psi.data(), psibar_.data(), products}},
                     problem.state, *problem.out);
        for (Index i = 0; i < bins_; ++i) {
            const double* const from = cells_.data() + (i * across + width_ - i) * side_by_side_ + p;
            double* const row = problem.out->row(i);
            const Index end = std::min(i + width_ + 1, bins_);
            for (Index j = std::max(i - width_, Index{0}); j < end; ++j) row[j] = from[j * side_by_side_];
        }
    }
}

void NarrowSweep::give_gradings(VectorView<const Problem> problems) {
    at_least(gradings_, bins_ * side_by_side_);
    at_least(sums_, table_->terms * side_by_side_);
    for (Index p = 0; p < problems.size(); ++p) {
        const std::vector<double>& grading = *problems[p].grading;
        for (Index i = 0; i < bins_; ++i) gradings_[i * side_by_side_ + p] = at(grading, i);
        for (const OuterProduct& from : *problems[p].arrivals) {
            const double partners = std::accumulate(from.psibar.begin(), from.psibar.end(), 0.0);
            for (Index i = 0; i < bins_; ++i) gradings_[i * side_by_side_ + p] += from.psi[i] * partners;
        }
    }
    const CrushTable& table = *table_;
    move_gradings({side_by_side_, bins_, table.head, table.terms, table.shells_a_block, table.mass.data(),
                   table.below.data(), table.entering.data(), table.falling.data(), table.block_decay.data(),
                   crushed_.data(), sums_.data(), gradings_.data()});
    for (Index p = 0; p < problems.size(); ++p) {
        std::vector<double>& grading = *problems[p].grading;
        for (Index i = 0; i < bins_; ++i) at(grading, i) = gradings_[i * side_by_side_ + p];
    }
}

void NarrowSweep::run(const CrushTable& table, VectorView<Problem> problems) {
    begin(table, problems);
    set_shares(problems);
    take_cells(problems);
    const Index products = take_arrivals(problems);
    const bool keep = problems[0].out != nullptr;
    sweep_narrow({side_by_side_,
                  bins_,
                  width_,
                  reach_.data(),
                  line_.data(),
                  table.mass.data(),
                  table.below.data(),
                  settled_.data(),
                  arrived_.data(),
                  {psi_.data(), psibar_.data(), products},
                  keep,
                  cells_.data(),
                  down_.data(),
                  along_.data(),
                  crushed_.data(),
                  neighbour_.data()});
    for (Index p = 0; p < problems.size(); ++p) {
        double crushed = 0.0;
        for (Index m = 0; m < bins_; ++m) crushed += crushed_[m * side_by_side_ + p];
        problems[p].crushed = crushed;
        problems[p].crushed_neighbour = neighbour_[p];
    }
    if (problems[0].grading != nullptr) give_gradings(problems);
    if (keep) give_states(problems);
}

}  // namespace comminute::detail
