// SPDX-License-Identifier: BSD-3-Clause
#include "band_sweep.hpp"

#include <algorithm>
#include <cmath>

#include "loops.hpp"
#include "multiversion.hpp"

namespace comminute {
namespace {

constexpr Index pad = 4;               // lines below the first, so that loops over an arm need no remainder
constexpr Index columns_a_block = 32;  // enough to use whole cache lines of the state's rows
constexpr Index shells_a_flush = 16;
constexpr double negligible = 1e-200;

Index rounded_up(Index n) {
    return (n + pad - 1) / pad * pad;
}

// The K sums of the lines of an arm, and of the line that crosses them all.
struct Falling {
    const double* ratio;
    const double* entering;  // weight of what enters
    const double* crossing;  // sums of the crossing line
    Index terms;
    double* sums;  // of the first line of the arm
    Index sum_stride;
    const double* power;  // by which the crossing line has decayed there
    Index power_stride;
};

// The sums decay by a bin and take in what enters; with them lands what falls along the crossing line. Four terms at
// a time, so that what arrives is not loaded and stored for each.
COMMINUTE_MULTIVERSION void advance(const Falling& f, const double* enters, double* arriving, Index count) {
    for (Index a = 0; a < f.terms; a += 4) {
        double* const s0 = f.sums + a * f.sum_stride;
        double* const s1 = s0 + f.sum_stride;
        double* const s2 = s1 + f.sum_stride;
        double* const s3 = s2 + f.sum_stride;
        const double* const p0 = f.power + a * f.power_stride;
        const double* const p1 = p0 + f.power_stride;
        const double* const p2 = p1 + f.power_stride;
        const double* const p3 = p2 + f.power_stride;
        const double q0 = f.ratio[a], q1 = f.ratio[a + 1], q2 = f.ratio[a + 2], q3 = f.ratio[a + 3];
        const double e0 = f.entering[a], e1 = f.entering[a + 1], e2 = f.entering[a + 2],
                     e3 = f.entering[a + 3];
        const double c0 = f.crossing[a], c1 = f.crossing[a + 1], c2 = f.crossing[a + 2],
                     c3 = f.crossing[a + 3];
        COMMINUTE_INDEPENDENT
        for (Index k = 0; k < count; ++k) {
            const double x = enters[k];
            const double n0 = s0[k] * q0 + e0 * x;
            const double n1 = s1[k] * q1 + e1 * x;
            const double n2 = s2[k] * q2 + e2 * x;
            const double n3 = s3[k] * q3 + e3 * x;
            s0[k] = n0;
            s1[k] = n1;
            s2[k] = n2;
            s3[k] = n3;
            arriving[k] += ((n0 + c0 * p0[k]) + (n1 + c1 * p1[k])) + ((n2 + c2 * p2[k]) + (n3 + c3 * p3[k]));
        }
    }
}

double sum_of(const double* values, Index count) {
    double part[4] = {0.0, 0.0, 0.0, 0.0};  // four sums, so that none waits for the one before
    Index k = 0;
    for (; k + 4 <= count; k += 4) {
        for (Index q = 0; q < 4; ++q) part[q] += values[k + q];
    }
    for (; k < count; ++k) part[0] += values[k];
    return (part[0] + part[1]) + (part[2] + part[3]);
}

struct Crushing {
    const double* there;
    const double* landed;
    const double* settled_share;
    const double* arrived_share;
    double below;
};

// What moves of the cells of an arm, onto its lines and their fines.
COMMINUTE_MULTIVERSION void push(const Crushing& c, double* onto_line, double* fines, Index count) {
    const auto [there, landed, settled, arrived, below] = c;
    COMMINUTE_INDEPENDENT
    for (Index k = 0; k < count; ++k) {
        const double moving = there[k] * settled[k] + landed[k] * arrived[k];
        onto_line[k] = moving;
        fines[k] += moving * below;
    }
}

// What stays. `rest` may be where `there` is.
COMMINUTE_MULTIVERSION void leave(const Crushing& c, double* rest, Index count) {
    const auto [there, landed, settled, arrived, below] = c;
    COMMINUTE_INDEPENDENT
    for (Index k = 0; k < count; ++k) {
        rest[k] = there[k] * (1.0 - settled[k]) + landed[k] * (1.0 - arrived[k]);
    }
}

}  // namespace

BandSweep::BandSweep(Index bins)
    : bins_(bins),
      stride_(rounded_up(bins + pad) + pad),
      first_(static_cast<std::size_t>(bins)),
      crushed_rows_(static_cast<std::size_t>(bins)) {
    for (std::vector<double>* line : {&arriving_, &entering_, &settled_share_, &arrived_share_}) {
        line->resize(static_cast<std::size_t>(bins + pad));
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
    width_ = longest + 1;
    shells_kept_ = std::min(bins_, table.head + 2);
    if (whole_state && table.head > 0) shells_kept_ = bins_;
    const auto by_term = static_cast<std::size_t>(table.terms * bins_);
    for (Lines* lines : {&columns_, &rows_}) {
        lines->sums.assign(static_cast<std::size_t>(table.terms * stride_), 0.0);
        lines->own.assign(static_cast<std::size_t>(table.terms), 0.0);
        lines->pushed.assign(static_cast<std::size_t>(shells_kept_ * width_), 0.0);
        lines->fines.assign(static_cast<std::size_t>(bins_), 0.0);
        lines->near.resize(whole_state && table.head > 0 ? by_term : 0);
        lines->far.resize(whole_state ? by_term : 0);
    }
    std::fill(crushed_rows_.begin(), crushed_rows_.end(), 0.0);
    crushed_ = crushed_neighbour_ = 0.0;
}

// What lands in (m, m) along one of its two lines. Leaves the line's own sums in `own`.
double BandSweep::arrive_on_diagonal(const CrushTable& table, Lines& lines, Index m) const {
    double arriving = 0.0;
    const Index entering = m + table.head + 1;
    const double enters = entering < bins_ && first(entering) <= m ? *pushed(lines, entering, m) : 0.0;
    for (Index a = 0; a < table.terms; ++a) {
        const auto at = static_cast<std::size_t>(a);
        const double sum = lines.sums[static_cast<std::size_t>(a * stride_ + pad + m)];
        lines.own[at] = table.ratio[at] * (sum + table.coefficient[at] * enters);
        arriving += lines.own[at];
    }
    for (Index shell = m + 1; shell <= std::min(m + table.head, bins_ - 1) && first(shell) <= m; ++shell) {
        arriving += table.mass[static_cast<std::size_t>(shell - m)] * *pushed(lines, shell, m);
    }
    return arriving;
}

// What lands in the arm of shell m whose mass falls along `lines`, from these lines and along line m of the `other`
// direction, which crosses them all.
void BandSweep::arrive_on_arm(const CrushTable& table, Lines& lines, const Lines& other, Index m) {
    const Index begin = first(m);
    const Index padded = rounded_up(m - begin);
    double* arriving = arriving_.data() + pad;
    double* entering = entering_.data() + pad;

    if (table.terms > 0) {
        const Index shell = m + table.head + 1;
        std::fill(entering + m - padded, entering + m, 0.0);
        if (shell < bins_) {
            const Index from = std::max(begin, first(shell));
            if (from < m) std::copy_n(pushed(lines, shell, from), m - from, entering + from);
        }
        const Falling falling{table.ratio.data(),
                              table.entering.data(),
                              other.own.data(),
                              table.terms,
                              lines.sums.data() + pad + m - padded,
                              stride_,
                              table.powers_towards(0, m, m - padded),
                              bins_};
        advance(falling, entering + m - padded, arriving + m - padded, padded);
    }
    for (Index shell = m + 1; shell <= std::min(m + table.head, bins_ - 1); ++shell) {
        const Index from = std::max(begin, first(shell));
        if (from >= m) break;
        add_scaled(table.mass[static_cast<std::size_t>(shell - m)], pushed(lines, shell, from),
                   arriving + from, m - from);
    }
    for (Index shell = m; shell <= std::min(m + table.head, bins_ - 1) && first(shell) <= m; ++shell) {
        const double mass = *pushed(other, shell, m);
        if (mass != 0.0) add_scaled(mass, table.mass_towards(shell, begin), arriving + begin, m - begin);
    }
}

// What lands in the fines cell at the end of an arm: along its own line as anywhere, along the crossing one all that
// falls below the grid.
double BandSweep::landed_in_fines(const CrushTable& table, const Lines& lines, const Lines& other,
                                  Index m) const {
    double landed = other.fines[static_cast<std::size_t>(m)];
    for (Index a = 0; a < table.terms; ++a) landed += lines.sums[static_cast<std::size_t>(a * stride_ + pad)];
    for (Index shell = m + 1; shell <= std::min(m + table.head, bins_ - 1) && first(shell) == 0; ++shell) {
        landed += table.mass[static_cast<std::size_t>(shell - m)] * *pushed(lines, shell, 0);
    }
    return landed;
}

void BandSweep::set_shares(const ActiveBand& before, const ActiveBand& after, Index m) {
    double* settled = settled_share_.data() + pad;
    double* arrived = arrived_share_.data() + pad;
    const Index last = after.last(m);
    std::fill(arrived + first(m), arrived + m - last, 0.0);
    for (Index d = last; d >= after.full(m); --d) arrived[m - d] = after.share(m, d);
    std::fill(arrived + m + 1 - after.full(m), arrived + m + 1, 1.0);
    std::copy(arrived + first(m), arrived + m + 1, settled + first(m));
    // Mass that has settled fills the part of its cell outside the old zone, which rounding may make the larger one.
    for (Index d = before.last(m); d >= 0; --d) {
        const double was = before.share(m, d);
        arrived[m - d] = std::max(arrived[m - d], was);
        settled[m - d] = was < 1.0 ? (arrived[m - d] - was) / (1.0 - was) : 0.0;
    }
}

double BandSweep::crush_diagonal(const CrushTable& table, Index m, double there, double* rest) {
    const double settled = settled_share_[static_cast<std::size_t>(pad + m)];
    const double arrived = arrived_share_[static_cast<std::size_t>(pad + m)];
    const double landed = arriving_[static_cast<std::size_t>(pad + m)];
    const double half = 0.5 * (there * settled + landed * arrived);
    if (rest != nullptr) rest[m] = there * (1.0 - settled) + landed * (1.0 - arrived);
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
    const Index count = m - begin;
    const Index at = pad + begin;
    const Crushing crushing{there + begin, arriving_.data() + at, settled_share_.data() + at,
                            arrived_share_.data() + at, table.below[static_cast<std::size_t>(m)]};
    double* onto_line = pushed(lines, m, begin);
    push(crushing, onto_line, lines.fines.data() + begin, count);
    if (rest != nullptr) leave(crushing, rest + begin, count);
    return sum_of(onto_line, count);
}

// Keeps what the far field needs of line m.
void BandSweep::hand_on(const CrushTable& table, Lines& lines, Index m) const {
    double* far = lines.far.data() + m * table.terms;
    for (Index a = 0; a < table.terms; ++a) {
        far[a] = lines.own[static_cast<std::size_t>(a)] * table.powers(a)[table.head];
    }
    for (Index shell = m; shell <= std::min(m + table.head, bins_ - 1) && first(shell) <= m; ++shell) {
        const double mass = *pushed(lines, shell, m);
        for (Index a = 0; a < table.terms; ++a) {
            far[a] += table.coefficient[static_cast<std::size_t>(a)] * mass * table.powers(a)[shell - m];
        }
    }
    if (table.head > 0) std::copy(lines.own.begin(), lines.own.end(), lines.near.begin() + m * table.terms);
}

// Sums decay for as long as the zone is wide; denormal numbers would take a hundred times as long to add.
void BandSweep::flush(const CrushTable& table, Lines& lines, Index m) const {
    for (Index a = 0; a < table.terms; ++a) {
        double* sums = lines.sums.data() + a * stride_ + pad;
        for (Index j = first(m); j < m; ++j) {
            if (std::abs(sums[j]) < negligible) sums[j] = 0.0;
        }
    }
}

void BandSweep::take_columns(MatrixView<const double> state, Index begin, Index end) {
    for (Index i = first(begin); i < end - 1; ++i) {
        for (Index m = std::max(begin, i + 1); m < end; ++m) {
            block_[static_cast<std::size_t>((m - begin) * stride_ + i)] = state(i, m);
        }
    }
}

void BandSweep::give_columns(MatrixView<double> out, Index begin, Index end) const {
    for (Index i = first(begin); i < end - 1; ++i) {
        for (Index m = std::max(begin, i + 1); m < end; ++m) {
            if (first(m) <= i) out(i, m) = block_[static_cast<std::size_t>((m - begin) * stride_ + i)];
        }
    }
}

void BandSweep::run(const CrushTable& table, const ActiveBand& before, const ActiveBand& after,
                    MatrixView<const double> state, const std::vector<OuterProduct>& arrivals,
                    MatrixView<double>* out) {
    prepare(table, after, out != nullptr);
    block_.resize(static_cast<std::size_t>(columns_a_block * stride_));
    double* arriving = arriving_.data() + pad;
    const bool decays_far =
        table.terms > 0 &&
        std::pow(table.ratio.front(), static_cast<double>(table.terms * width_)) < negligible;
    for (Index end = bins_; end > 0; end -= std::min(end, columns_a_block)) {
        const Index begin = std::max(Index{0}, end - columns_a_block);
        take_columns(state, begin, end);
        for (Index m = end - 1; m >= begin; --m) {
            set_shares(before, after, m);
            double landed = arrive_on_diagonal(table, columns_, m) + arrive_on_diagonal(table, rows_, m);
            if (m == 0) landed = columns_.fines[0] + rows_.fines[0];
            for (const OuterProduct& from : arrivals) {
                landed += from.psi[static_cast<std::size_t>(m)] * from.psibar[static_cast<std::size_t>(m)];
            }
            arriving[m] = landed;
            const double half = crush_diagonal(table, m, state(m, m), out != nullptr ? out->row(m) : nullptr);

            const auto arm = [&](Lines& lines, const Lines& other, const double* there, double* rest,
                                 auto along, auto across) {
                std::fill(arriving + m - rounded_up(m - first(m)), arriving + m, 0.0);
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
                half + arm(columns_, rows_, state.row(m), out != nullptr ? out->row(m) : nullptr,
                           &OuterProduct::psibar, &OuterProduct::psi);
            double* column = block_.data() + (m - begin) * stride_;
            const double neighbour = half + arm(rows_, columns_, column, out != nullptr ? column : nullptr,
                                                &OuterProduct::psi, &OuterProduct::psibar);
            crushed_rows_[static_cast<std::size_t>(m)] = grain;
            crushed_ += grain;
            crushed_neighbour_ += neighbour;
            if (out != nullptr) {
                hand_on(table, columns_, m);
                hand_on(table, rows_, m);
            }
            if (decays_far && m % shells_a_flush == 0) {
                flush(table, columns_, m);
                flush(table, rows_, m);
            }
        }
        if (out != nullptr) give_columns(*out, begin, end);
    }
}

}  // namespace comminute
