// SPDX-License-Identifier: BSD-3-Clause
#include "sweeping/band_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simd/lanes.hpp"
#include "simd/loops.hpp"
#include "simd/sums.hpp"

namespace comminute::detail {
namespace {

constexpr Index columns_a_block = 32;  // enough to use whole cache lines of the state's rows
constexpr Index rows_ahead = 4;
constexpr Index shells_a_part = 32;

}  // namespace

BandSweep::BandSweep(Index bins)
    : bins_(bins),
      column_stride_(row_stride(bins)),
      first_(static_cast<std::size_t>(bins)),
      crushed_rows_(static_cast<std::size_t>(bins)) {
    for (LaneVector* line :
         {&part_, &settled_share_, &arrived_share_, &last_row_, &columns_.landed, &columns_.besides,
          &columns_.entering, &rows_.landed, &rows_.besides, &rows_.entering}) {
        line->resize(static_cast<std::size_t>(bins + lanes));
    }
    columns_.along = rows_.across = &OuterProduct::psibar;
    columns_.across = rows_.along = &OuterProduct::psi;
}

void BandSweep::prepare(const CrushTable& table, const ActiveBand& after, bool whole_state) {
    Index lowest = bins_;
    Index longest = 0;
    for (Index m = bins_ - 1; m >= 0; --m) {
        lowest = std::min({lowest, m - after.last(m), m});
        first_[static_cast<std::size_t>(m)] = lowest;
        longest = std::max(longest, m - lowest);
    }
    // Without a head a shell's masses enter the sums at the next one, and are kept no longer than that, by line.
    by_line_ = table.head == 0;
    width_ = by_line_ ? lanes_up(bins_) : lanes_up(longest + 1) + 2 * lanes;
    shells_kept_ = by_line_ ? 1 : whole_state ? bins_ : std::min(bins_, table.head + 2);
    const auto by_term = static_cast<std::size_t>(table.terms * bins_);
    for (Lines* lines : {&columns_, &rows_}) {
        lines->sums.assign(static_cast<std::size_t>(std::max(table.terms, Index{1}) * lanes_up(bins_)), 0.0);
        lines->own.assign(static_cast<std::size_t>(table.terms), 0.0);
        lines->pushed.assign(static_cast<std::size_t>(shells_kept_ * width_), 0.0);
        lines->fines.assign(static_cast<std::size_t>(lanes_up(bins_)), 0.0);
        lines->near.resize(whole_state && table.head > 0 ? by_term : 0);
        lines->far.resize(whole_state ? by_term : 0);
    }
    std::fill(crushed_rows_.begin(), crushed_rows_.end(), 0.0);
    crushed_ = crushed_neighbour_ = 0.0;
}

// The coarsest shell that has pushed mass onto line m of which the head speaks here. From there on down, since what has
// fallen far is little, and would be lost bit by bit beside what has not.
Index BandSweep::last_shell_of(const CrushTable& table, Index m) const {
    Index shell = std::min(m + table.head, bins_ - 1);
    while (shell > m && first(shell) > m) --shell;
    return shell;
}

// What the sums of line m come to at its own shell; what they give there.
double BandSweep::arrive_on_diagonal(const CrushTable& table, Lines& lines, Index m) const {
    const Index shell = m + table.head + 1;
    const double enters = shell < bins_ && first(shell) <= m ? *pushed(lines, shell, m) : 0.0;
    const double* sums = lines.sums.data() + lanes_down(m) * table.terms + m % lanes;
    const double* weight = table.entering_at(block_shell_);
    const double* decay = table.falling_at(block_shell_);
    double arriving = 0.0;
    for (Index a = 0; a < table.terms; ++a) {
        const double own = decay[a] * (sums[a * lanes] + weight[a] * enters);
        lines.own[static_cast<std::size_t>(a)] = own;
        arriving += own;
    }
    for (Index above = last_shell_of(table, m); above > m; --above) {
        arriving += table.mass[static_cast<std::size_t>(above - m)] * *pushed(lines, above, m);
    }
    return arriving;
}

// What lands in the arm of shell m whose mass falls along `lines` that no sum speaks of.
const double* BandSweep::arrive_besides(const CrushTable& table, Lines& lines, const Lines& other,
                                        const std::vector<OuterProduct>& arrivals, Index m) {
    const Index begin = first(m);
    double* const besides = lines.besides.data();
    std::fill(besides + lanes_down(begin), besides + lanes_up(m), 0.0);
    if (!by_line_) arrive_from_head(table, lines, other, m);
    for (const OuterProduct& from : arrivals) {
        const double factor = (from.*lines.across)[static_cast<std::size_t>(m)];
        if (factor != 0.0) {
            add_scaled(factor, (from.*lines.along).data() + begin, besides + begin, m - begin);
        }
    }
    return besides;
}

// The shells that the head speaks of, one by one, and in parts: a sum of hundreds of numbers is rounded as often.
void BandSweep::arrive_from_head(const CrushTable& table, Lines& lines, const Lines& other, Index m) {
    const Index begin = first(m);
    const Index last = last_shell_of(table, m);
    double* const all = lines.besides.data();
    double* const part = last - m < shells_a_part ? all : part_.data();
    for (Index top = last; top >= m; top -= shells_a_part) {
        if (part != all) std::fill(part + begin, part + m, 0.0);
        for (Index shell = top; shell >= m && shell > top - shells_a_part; --shell) {
            const Index from = std::max(begin, first(shell));
            if (from < m && shell > m) {
                add_scaled(table.mass[static_cast<std::size_t>(shell - m)], pushed(lines, shell, from),
                           part + from, m - from);
            }
            const double mass = *pushed(other, shell, m);
            if (mass != 0.0) add_scaled(mass, table.mass_towards(shell, begin), part + begin, m - begin);
        }
        if (part != all) add_scaled(1.0, part + begin, all + begin, m - begin);
    }
}

// Past the head, for the lines of the arm of shell m, and 0 for those that share a pack with them.
const double* BandSweep::entering_the_sums(const CrushTable& table, Lines& lines, Index m) {
    const Index shell = m + table.head + 1;
    const Index from = shell < bins_ ? std::max(first(m), first(shell)) : m;
    double* const entering = lines.entering.data();
    std::fill(entering + lanes_down(first(m)), entering + lanes_up(m), 0.0);
    if (from < m) std::copy_n(pushed(lines, shell, from), m - from, entering + from);
    return entering;
}

// What lands in the fines cell at the end of an arm: along its own line as anywhere, along the crossing one all that
// falls below the grid.
double BandSweep::landed_in_fines(const CrushTable& table, const Lines& lines, const Lines& other,
                                  const std::vector<OuterProduct>& arrivals, Index m) const {
    double landed = other.fines[static_cast<std::size_t>(m)];
    for (const OuterProduct& from : arrivals) {
        landed += (from.*lines.across)[static_cast<std::size_t>(m)] * (from.*lines.along)[0];
    }
    const double* decay = table.falling_at(block_shell_);
    for (Index a = 0; a < table.terms; ++a) {
        landed += decay[a] * lines.sums[static_cast<std::size_t>(a * lanes)];
    }
    for (Index shell = first(m) == 0 ? last_shell_of(table, m) : m; shell > m; --shell) {
        if (first(shell) > 0) continue;
        landed += table.mass[static_cast<std::size_t>(shell - m)] * *pushed(lines, shell, 0);
    }
    return landed;
}

// Arrays for the arms, 0 in the cells that share a pack with an arm's ends; apart the shares of the diagonal cell and of
// the fines cells, whose arrivals are of another kind.
void BandSweep::set_shares(const ActiveBand& before, const ActiveBand& after, Index m) {
    double* const arrived = arrived_share_.data();
    const Index last = std::clamp(after.last(m), Index{0}, m);
    const Index whole = std::max(after.full(m) - 1, Index{0});  // cells of an arm
    for (Index line = lanes_down(first(m)); line < m - last; ++line) arrived[line] = 0.0;
    for (Index d = last; d > whole; --d) arrived[m - d] = after.share(m, d);
    for (Index line = m - whole; line < std::min(m, ones_from_); ++line) arrived[line] = 1.0;
    ones_from_ = m - whole;
    arrived[m] = 0.0;
    const bool to_fines = first(m) == 0 && m > 0;
    if (to_fines) arrived[0] = after.share(m, m);
    diagonal_.arrived = diagonal_.settled = after.share(m, 0);
    settled_ = arrived;
    if (before.last(m) >= 0) {
        // Mass that has settled fills the part of its cell outside the old zone, which rounding may make the larger one.
        const auto of_settled = [](double& now, double was) {
            now = std::max(now, was);
            return was < 1.0 ? (now - was) / (1.0 - was) : 0.0;
        };
        double* const settled = settled_share_.data();
        settled_ = settled;
        std::copy(arrived + lanes_down(first(m)), arrived + lanes_up(m), settled + lanes_down(first(m)));
        for (Index d = std::min(before.last(m), m - first(m)); d > 0; --d) {
            settled[m - d] = of_settled(arrived[m - d], before.share(m, d));
        }
        diagonal_.settled = of_settled(diagonal_.arrived, before.share(m, 0));
    }
    if (to_fines) {
        fines_ = {settled_[0], arrived[0]};
        arrived[0] = settled_share_[0] = 0.0;
    }
}

// Takes the active part out of a cell apart, and leaves the rest where that is wanted.
double BandSweep::crush_cell(Shares share, double there, double landed, double* rest) {
    if (rest != nullptr) *rest = there * (1.0 - share.settled) + landed * (1.0 - share.arrived);
    return (share.settled != 0.0 ? there * share.settled : 0.0) + landed * share.arrived;
}

double BandSweep::crush_diagonal(const CrushTable& table, Index m, double there, double landed,
                                 double* rest) {
    const double half = 0.5 * crush_cell(diagonal_, there, landed, rest);
    for (Lines* lines : {&columns_, &rows_}) {
        *pushed(*lines, m, m) = half;
        lines->fines[static_cast<std::size_t>(m)] += half * table.below[static_cast<std::size_t>(m)];
    }
    return half;
}

// Moves the active part of the fines cell at the end of an arm onto its line.
double BandSweep::crush_fines(const CrushTable& table, Lines& lines, const Lines& other,
                              const std::vector<OuterProduct>& arrivals, Index m, double there,
                              double* rest) {
    const double moved = crush_cell(fines_, there, landed_in_fines(table, lines, other, arrivals, m), rest);
    *pushed(lines, m, 0) = moved;
    lines.fines[0] += moved * table.below[static_cast<std::size_t>(m)];
    return moved;
}

Arm BandSweep::arm_of(const CrushTable& table, Lines& lines, const Lines& other,
                      const std::vector<OuterProduct>& arrivals, Index m, const double* there,
                      bool whole_state) {
    const Index from = lanes_down(first(m));
    const bool more = !by_line_ || !arrivals.empty();
    return {there + from,
            more ? arrive_besides(table, lines, other, arrivals, m) + from : nullptr,
            (by_line_ ? lines.pushed.data() : entering_the_sums(table, lines, m)) + from,
            lines.sums.data() + from * table.terms,
            other.own.data(),
            whole_state ? lines.landed.data() + from : nullptr,
            pushed(lines, m, from),
            lines.fines.data() + from};
}

// Moves the active part of both arms of shell m onto their lines, and leaves the rest where `rest_row` and `column` are
// wanted.
Moved BandSweep::crush_arms_of(const CrushTable& table, const std::vector<OuterProduct>& arrivals, Index m,
                               const double* row, double* column, double* rest_row) {
    const bool whole_state = rest_row != nullptr;
    const Index from = lanes_down(first(m));
    const double half = *pushed(columns_, m, m);
    const Shell shell{table.terms,
                      table.entering_at(block_shell_),
                      table.falling_at(block_shell_),
                      table.powers_towards(0, m, from),
                      table.stride,
                      by_line_ ? half : 0.0,
                      table.mass_towards(m, from),
                      settled_ + from,
                      arrived_share_.data() + from,
                      table.below[static_cast<std::size_t>(m)]};
    Moved moved =
        crush_arms(shell, arm_of(table, columns_, rows_, arrivals, m, row, whole_state),
                   arm_of(table, rows_, columns_, arrivals, m, column, whole_state), lanes_up(m) - from);
    *pushed(columns_, m, m) = *pushed(rows_, m, m) = half;

    const bool to_fines = first(m) == 0 && m > 0;
    if (whole_state) {
        const Index begin = to_fines ? 1 : first(m);
        const auto leave_on = [&](const Lines& lines, const double* there, double* rest) {
            leave(
                {there + begin, lines.landed.data() + begin, settled_ + begin, arrived_share_.data() + begin},
                rest + begin, m - begin);
        };
        leave_on(columns_, row, rest_row);
        leave_on(rows_, column, column);
    }
    if (to_fines) {
        moved.first += crush_fines(table, columns_, rows_, arrivals, m, row[0], rest_row);
        moved.second +=
            crush_fines(table, rows_, columns_, arrivals, m, column[0], whole_state ? column : nullptr);
    }
    return moved;
}

// Keeps what the far field needs of line m.
void BandSweep::hand_on(const CrushTable& table, Lines& lines, Index m) const {
    double* far = lines.far.data() + m * table.terms;
    if (by_line_) {
        const double half = *pushed(lines, m, m);
        for (Index a = 0; a < table.terms; ++a) {
            const auto term = static_cast<std::size_t>(a);
            far[a] = lines.own[term] + table.coefficient[term] * half;
        }
        return;
    }
    for (Index a = 0; a < table.terms; ++a) {
        far[a] = lines.own[static_cast<std::size_t>(a)] * table.powers(a)[table.head];
    }
    for (Index shell = m; shell <= std::min(m + table.head, bins_ - 1) && first(shell) <= m; ++shell) {
        const double mass = *pushed(lines, shell, m);
        for (Index a = 0; a < table.terms; ++a) {
            far[a] += table.coefficient[static_cast<std::size_t>(a)] * mass * table.powers(a)[shell - m];
        }
    }
    std::copy(lines.own.begin(), lines.own.end(), lines.near.begin() + m * table.terms);
}

// A new block of shells: the sums as they are at its first one. Lines above the band hand nothing on any more.
void BandSweep::begin_block(const CrushTable& table, Index m) {
    block_shell_ = 0;
    const Index from = lanes_down(first(m));
    for (Lines* lines : {&columns_, &rows_}) {
        decay(table.block_decay.data(), table.terms, lines->sums.data() + from * table.terms,
              lanes_up(m + 1) - from);
    }
}

// Row m, readable to the end of the pack of its diagonal cell: of the last row a copy.
const double* BandSweep::row_of(MatrixView<const double> state, Index m) {
    if (m + 1 < bins_) return state.row(m);
    std::copy_n(state.row(m), bins_, last_row_.begin());
    return last_row_.data();
}

// By squares, from above the diagonal or across it; what lies below is of no use, and of no harm.
void BandSweep::take_columns(MatrixView<const double> state, Index begin, Index end) {
    const auto column_from = [&](Index m, Index i) {
        return block_.data() + (m - begin) * column_stride_ + i;
    };
    for (Index i = lanes_down(first(begin)); i < end - 1; i += lanes) {
        const Index rows_end = std::min(i + lanes, bins_);
        for (Index r = i + lanes; r < std::min(i + 2 * lanes, end); ++r)
            fetch(state.row(r) + begin, end - begin);
        for (Index m_end = end; m_end > std::max(begin, i + 1); m_end -= lanes) {
            const Index m = std::max(m_end - lanes, begin);
            if (rows_end <= first(m)) continue;
            if (m_end - m == lanes && rows_end - i == lanes) {
                transpose(state.row(i) + m, state.stride(), column_from(m, i), column_stride_);
                continue;
            }
            for (Index row = i; row < rows_end; ++row) {
                for (Index column = m; column < m_end; ++column)
                    *column_from(column, row) = state(row, column);
            }
        }
    }
}

void BandSweep::give_columns(MatrixView<double> out, Index begin, Index end) const {
    for (Index i = first(begin); i < end - 1; ++i) {
        for (Index m = std::max(begin, i + 1); m < end; ++m) {
            if (first(m) <= i) out(i, m) = block_[static_cast<std::size_t>((m - begin) * column_stride_ + i)];
        }
    }
}

void BandSweep::run(const CrushTable& table, const ActiveBand& before, const ActiveBand& after,
                    MatrixView<const double> state, const std::vector<OuterProduct>& arrivals,
                    MatrixView<double>* out) {
    prepare(table, after, out != nullptr);
    block_.resize(static_cast<std::size_t>(columns_a_block * column_stride_));
    block_shell_ = 0;
    ones_from_ = bins_;
    std::fill(arrived_share_.begin(), arrived_share_.end(), 0.0);
    for (Index end = bins_; end > 0; end -= std::min(end, columns_a_block)) {
        const Index begin = std::max(Index{0}, end - columns_a_block);
        take_columns(state, begin, end);
        for (Index m = end - 1; m >= begin; --m) {
            if (block_shell_ == table.shells_a_block) begin_block(table, m);
            if (m >= rows_ahead) fetch(state.row(m - rows_ahead) + first(m), m - first(m));
            set_shares(before, after, m);
            double landed = arrive_on_diagonal(table, columns_, m) + arrive_on_diagonal(table, rows_, m);
            if (m == 0) landed = columns_.fines[0] + rows_.fines[0];
            for (const OuterProduct& from : arrivals) {
                landed += from.psi[static_cast<std::size_t>(m)] * from.psibar[static_cast<std::size_t>(m)];
            }
            double* const rest = out != nullptr ? out->row(m) : nullptr;
            const double* const row = row_of(state, m);
            const double half =
                crush_diagonal(table, m, row[m], landed, rest != nullptr ? rest + m : nullptr);
            const Moved moved =
                crush_arms_of(table, arrivals, m, row, block_.data() + (m - begin) * column_stride_, rest);
            crushed_rows_[static_cast<std::size_t>(m)] = half + moved.first;
            crushed_ += half + moved.first;
            crushed_neighbour_ += half + moved.second;
            if (out != nullptr) {
                hand_on(table, columns_, m);
                hand_on(table, rows_, m);
            }
            ++block_shell_;
        }
        if (out != nullptr) give_columns(*out, begin, end);
    }
}

}  // namespace comminute::detail
