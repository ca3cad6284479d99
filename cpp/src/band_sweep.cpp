// SPDX-License-Identifier: BSD-3-Clause
#include "band_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "lanes.hpp"
#include "loops.hpp"

namespace comminute {
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
    for (LaneVector* line : {&arriving_, &entering_, &settled_share_, &arrived_share_, &last_row_}) {
        line->resize(static_cast<std::size_t>(bins + lanes));
    }
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
        lines->sums.assign(static_cast<std::size_t>(table.terms * lanes_up(bins_)), 0.0);
        lines->own.assign(static_cast<std::size_t>(table.terms), 0.0);
        lines->crossing.assign(static_cast<std::size_t>(table.terms), 0.0);
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
    double arriving = 0.0;
    const Index shell = m + table.head + 1;
    const double enters = shell < bins_ && first(shell) <= m ? *pushed(lines, shell, m) : 0.0;
    const double* sums = lines.sums.data() + lanes_down(m) * table.terms + m % lanes;
    const double* weight = table.entering_at(block_shell_);
    const double* decay = table.falling_at(block_shell_);
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

// The sums of line m as its arm is crossed: without a head, what its own diagonal cell has pushed is in them.
void BandSweep::set_crossing(const CrushTable& table, Lines& lines, double pushed_here) const {
    const double enters = table.head == 0 ? pushed_here : 0.0;
    for (std::size_t a = 0; a < lines.own.size(); ++a) {
        lines.crossing[a] = lines.own[a] + table.coefficient[a] * enters;
    }
}

// What lands in the arm of shell m whose mass falls along `lines`, from these lines and along line m of the `other`
// direction, which crosses them all.
void BandSweep::arrive_on_arm(const CrushTable& table, Lines& lines, const Lines& other, Index m) {
    const Index begin = first(m);
    const Index from_pack = lanes_down(begin);
    const Index count = lanes_up(m) - from_pack;
    double* arriving = arriving_.data();
    if (table.terms > 0) {
        const Falling falling{table.terms,
                              table.entering_at(block_shell_),
                              table.falling_at(block_shell_),
                              other.crossing.data(),
                              table.powers_towards(0, m, from_pack),
                              table.stride,
                              lines.sums.data() + from_pack * table.terms};
        advance(falling, entering_the_sums(table, lines, m) + from_pack, arriving + from_pack, count);
    } else {
        std::fill(arriving + begin, arriving + m, 0.0);
    }
    if (!by_line_) arrive_from_head(table, lines, other, m);
}

// The shells that the head speaks of, one by one, and in parts: a sum of hundreds of numbers is rounded as often.
void BandSweep::arrive_from_head(const CrushTable& table, const Lines& lines, const Lines& other, Index m) {
    const Index begin = first(m);
    const Index last = last_shell_of(table, m);
    double* const part = last - m < shells_a_part ? arriving_.data() : entering_.data();
    for (Index top = last; top >= m; top -= shells_a_part) {
        if (part != arriving_.data()) std::fill(part + begin, part + m, 0.0);
        for (Index shell = top; shell >= m && shell > top - shells_a_part; --shell) {
            const Index from = std::max(begin, first(shell));
            if (from < m && shell > m) {
                add_scaled(table.mass[static_cast<std::size_t>(shell - m)], pushed(lines, shell, from),
                           part + from, m - from);
            }
            const double mass = *pushed(other, shell, m);
            if (mass != 0.0) add_scaled(mass, table.mass_towards(shell, begin), part + begin, m - begin);
        }
        if (part != arriving_.data()) add_scaled(1.0, part + begin, arriving_.data() + begin, m - begin);
    }
}

// By line, for the lines of the arm of shell m and 0 for those that share a pack with them.
const double* BandSweep::entering_the_sums(const CrushTable& table, const Lines& lines, Index m) {
    if (by_line_) return lines.pushed.data();
    const Index shell = m + table.head + 1;
    const Index from = shell < bins_ ? std::max(first(m), first(shell)) : m;
    double* entering = entering_.data();
    std::fill(entering + lanes_down(first(m)), entering + lanes_up(m), 0.0);
    if (from < m) std::copy_n(pushed(lines, shell, from), m - from, entering + from);
    return entering;
}

// What lands in the fines cell at the end of an arm: along its own line as anywhere, along the crossing one all that
// falls below the grid.
double BandSweep::landed_in_fines(const CrushTable& table, const Lines& lines, const Lines& other,
                                  Index m) const {
    double landed = other.fines[static_cast<std::size_t>(m)];
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

// Arrays for the arms, 0 in the cells that share a pack with an arm's ends; the diagonal cell's share apart.
void BandSweep::set_shares(const ActiveBand& before, const ActiveBand& after, Index m) {
    double* arrived = arrived_share_.data();
    const Index last = std::min(after.last(m), m);
    const Index whole = std::max(after.full(m) - 1, Index{0});  // cells of an arm
    std::fill(arrived + lanes_down(first(m)), arrived + m - std::max(last, Index{0}), 0.0);
    for (Index d = last; d > whole; --d) arrived[m - d] = after.share(m, d);
    std::fill(arrived + m - whole, arrived + m, 1.0);
    std::fill(arrived + m, arrived + lanes_up(m), 0.0);
    diagonal_arrived_ = diagonal_settled_ = after.share(m, 0);
    settled_ = arrived;
    if (before.last(m) < 0) return;

    // Mass that has settled fills the part of its cell outside the old zone, which rounding may make the larger one.
    const auto of_settled = [](double& now, double was) {
        now = std::max(now, was);
        return was < 1.0 ? (now - was) / (1.0 - was) : 0.0;
    };
    double* settled = settled_share_.data();
    settled_ = settled;
    std::copy(arrived + lanes_down(first(m)), arrived + lanes_up(m), settled + lanes_down(first(m)));
    for (Index d = std::min(before.last(m), m - first(m)); d > 0; --d) {
        settled[m - d] = of_settled(arrived[m - d], before.share(m, d));
    }
    diagonal_settled_ = of_settled(diagonal_arrived_, before.share(m, 0));
}

double BandSweep::crush_diagonal(const CrushTable& table, Index m, double there, double* rest) {
    const double landed = arriving_[static_cast<std::size_t>(m)];
    const double moving = diagonal_settled_ != 0.0 ? there * diagonal_settled_ : 0.0;
    const double half = 0.5 * (moving + landed * diagonal_arrived_);
    if (rest != nullptr) rest[m] = there * (1.0 - diagonal_settled_) + landed * (1.0 - diagonal_arrived_);
    for (Lines* lines : {&columns_, &rows_}) {
        *pushed(*lines, m, m) = half;
        lines->fines[static_cast<std::size_t>(m)] += half * table.below[static_cast<std::size_t>(m)];
    }
    return half;
}

// Moves the active part of an arm onto its lines; the total that moved.
double BandSweep::crush_arm(const CrushTable& table, Lines& lines, Index m, const double* there,
                            double* rest) {
    const Index begin = first(m);
    const double below = table.below[static_cast<std::size_t>(m)];
    const auto from = [&](Index line) {
        return Crushing{there + line, arriving_.data() + line, settled_ + line, arrived_share_.data() + line,
                        below};
    };
    const Index pack = lanes_down(begin);
    double* const diagonal = pushed(lines, m, m);
    const double half = *diagonal;
    const double moved =
        push(from(pack), pushed(lines, m, pack), lines.fines.data() + pack, lanes_up(m) - pack);
    *diagonal = half;
    if (rest != nullptr) leave(from(begin), rest + begin, m - begin);
    return moved;
}

// Keeps what the far field needs of line m.
void BandSweep::hand_on(const CrushTable& table, Lines& lines, Index m) const {
    double* far = lines.far.data() + m * table.terms;
    if (by_line_) {
        std::copy(lines.crossing.begin(), lines.crossing.end(), far);
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

void BandSweep::take_columns(MatrixView<const double> state, Index begin, Index end) {
    for (Index i = first(begin); i < end - 1; ++i) {
        fetch(state.row(std::min(i + 2 * rows_ahead, end - 1)) + begin, end - begin);
        for (Index m = std::max(begin, i + 1); m < end; ++m) {
            block_[static_cast<std::size_t>((m - begin) * column_stride_ + i)] = state(i, m);
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
    double* arriving = arriving_.data();
    block_shell_ = 0;
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
            arriving[m] = landed;
            const double half = crush_diagonal(table, m, state(m, m), out != nullptr ? out->row(m) : nullptr);

            set_crossing(table, columns_, half);
            set_crossing(table, rows_, half);

            const auto arm = [&](Lines& lines, const Lines& other, const double* there, double* rest,
                                 auto along, auto across) {
                arrive_on_arm(table, lines, other, m);
                if (first(m) == 0 && m > 0) arriving[0] = landed_in_fines(table, lines, other, m);
                for (const OuterProduct& from : arrivals) {
                    const double factor = (from.*across)[static_cast<std::size_t>(m)];
                    if (factor != 0.0)
                        add_scaled(factor, (from.*along).data() + first(m), arriving + first(m),
                                   m - first(m));
                }
                return crush_arm(table, lines, m, there, rest);
            };
            const double grain =
                half + arm(columns_, rows_, row_of(state, m), out != nullptr ? out->row(m) : nullptr,
                           &OuterProduct::psibar, &OuterProduct::psi);
            double* column = block_.data() + (m - begin) * column_stride_;
            const double neighbour = half + arm(rows_, columns_, column, out != nullptr ? column : nullptr,
                                                &OuterProduct::psi, &OuterProduct::psibar);
            crushed_rows_[static_cast<std::size_t>(m)] = grain;
            crushed_ += grain;
            crushed_neighbour_ += neighbour;
            if (out != nullptr) {
                hand_on(table, columns_, m);
                hand_on(table, rows_, m);
            }
            ++block_shell_;
        }
        if (out != nullptr) give_columns(*out, begin, end);
    }
}

}  // namespace comminute
