// SPDX-License-Identifier: BSD-3-Clause
#include "simd/narrow_band.hpp"

#include <algorithm>

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/narrow_band.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

constexpr double negligible = 1e-290;  // denormal numbers would slow every bin that follows

// A register of problems as they go down the shells. Problems fill `Problems` numbers, of which it takes those from
// `first` on.
template <Index Problems>
class NarrowShells {
    static constexpr Tag<Problems> d{};
    using V = hn::Vec<Tag<Problems>>;

  public:
    HWY_INLINE NarrowShells(const NarrowBand& band, Index first) : band_(band), first_(first) {}

    HWY_INLINE void sweep() {
        V neighbour = hn::Zero(d);
        for (Index m = band_.bins - 1; m >= 0; --m) {
            const Index reach = std::min(band_.reach[m], m);
            const Index cells = std::min(band_.width, m);
            const Index last = band_.keep ? cells : reach;
            V moved[2] = {hn::Zero(d), hn::Zero(d)};
            if (last >= 0) moved[0] = moved[1] = crush_diagonal(m);
            for (Index k = 1; k <= last; ++k) crush_pair(m, k, moved);
            for (Index k = last + 1; k <= cells; ++k) {
                put(hn::Zero(d), moving(band_.down, m - k, k));
                put(hn::Zero(d), moving(band_.along, m - k, k));
            }
            put(moved[0], band_.crushed + m * Problems + first_);
            neighbour = hn::Add(neighbour, moved[1]);
        }
        put(neighbour, band_.neighbour + first_);
    }

  private:
    HWY_INLINE V get(const double* from) const { return hn::LoadU(d, from); }
    HWY_INLINE void put(V numbers, double* to) const { hn::StoreU(numbers, d, to); }
    HWY_INLINE V all(double value) const { return hn::Set(d, value); }

    HWY_INLINE double* moving(double* lines, Index line, Index k) const {
        return lines + (line * (band_.width + 1) + k) * Problems + first_;
    }
    HWY_INLINE double* cell(Index i, Index j) const {
        return band_.cells + (i * (2 * band_.width + 1) + band_.width + j - i) * Problems + first_;
    }
    HWY_INLINE V with_products(V landed, Index i, Index j) const {
        const NarrowProducts& from = band_.landing;
        for (Index q = 0; q < from.products; ++q) {
            landed = hn::MulAdd(get(from.psi + (q * band_.bins + i) * Problems + first_),
                                get(from.psibar + (q * band_.bins + j) * Problems + first_), landed);
        }
        return landed;
    }

    // The active part of a cell, which leaves it.
    HWY_INLINE V divide(Index m, Index k, V landed, double* there) const {
        const Index place = (m * (band_.width + 1) + k) * Problems + first_;
        const V settled = get(band_.settled + place);
        const V arrived = get(band_.arrived + place);
        const V before = get(there);
        if (band_.keep) {
            put(hn::MulAdd(before, hn::Sub(all(1.0), settled), hn::Mul(landed, hn::Sub(all(1.0), arrived))),
                there);
        }
        const V own = hn::IfThenElseZero(hn::Ne(settled, hn::Zero(d)), hn::Mul(settled, before));
        return hn::Add(own, hn::IfThenElseZero(hn::Ne(arrived, hn::Zero(d)), hn::Mul(arrived, landed)));
    }

    // Half of what crushes among equals moves along either line.
    HWY_INLINE V crush_diagonal(Index m) const {
        const double* const share = m > 0 ? band_.mass : band_.below;
        V landed[2] = {hn::Zero(d), hn::Zero(d)};
        for (Index e = band_.line[m]; e >= 1; --e) {
            landed[0] = hn::MulAdd(get(moving(band_.down, m, e)), all(share[e]), landed[0]);
            landed[1] = hn::MulAdd(get(moving(band_.along, m, e)), all(share[e]), landed[1]);
        }
        const V all_landed = with_products(hn::Add(landed[0], landed[1]), m, m);
        const V half = hn::Mul(all(0.5), divide(m, 0, all_landed, cell(m, m)));
        put(half, moving(band_.down, m, 0));
        put(half, moving(band_.along, m, 0));
        return half;
    }

    // Cells (m, m - k) and (m - k, m). In each, mass lands from its own line, which coarser shells have fed, and from the
    // line of shell m, which crosses it.
    HWY_INLINE void crush_pair(Index m, Index k, V* moved) const {
        const Index line = m - k;
        const double* const across = line > 0 ? band_.mass + k : band_.below + m;
        V crossing[2] = {hn::Zero(d), hn::Zero(d)};
        for (Index e = band_.line[m]; e >= 0; --e) {
            const V share = all(across[e]);
            crossing[0] = hn::MulAdd(get(moving(band_.along, m, e)), share, crossing[0]);
            crossing[1] = hn::MulAdd(get(moving(band_.down, m, e)), share, crossing[1]);
        }
        V own[2] = {hn::Zero(d), hn::Zero(d)};
        for (Index e = band_.line[line]; e > k; --e) {
            const V share = all(band_.mass[e - k]);
            own[0] = hn::MulAdd(get(moving(band_.down, line, e)), share, own[0]);
            own[1] = hn::MulAdd(get(moving(band_.along, line, e)), share, own[1]);
        }
        const V left = divide(m, k, with_products(hn::Add(crossing[0], own[0]), m, line), cell(m, line));
        const V right = divide(m, k, with_products(hn::Add(crossing[1], own[1]), line, m), cell(line, m));
        put(left, moving(band_.down, line, k));
        put(right, moving(band_.along, line, k));
        moved[0] = hn::Add(moved[0], left);
        moved[1] = hn::Add(moved[1], right);
    }

    const NarrowBand& band_;
    Index first_;
};

void sweep_narrow(const NarrowBand& band) {
    if (band.problems == 1) {
        NarrowShells<1>(band, 0).sweep();
        return;
    }
    for (Index first = 0; first < lanes; first += width) NarrowShells<lanes>(band, first).sweep();
}

// Row i of one problem's state before and after. `Cells` is W + 1, so that the mass along the row stays in registers.
template <Index Cells>
class NarrowRow {
  public:
    HWY_INLINE NarrowRow(const NarrowLanding& lines, Index i, const double* before, double* after)
        : lines_(lines), i_(i), before_(before), after_(after) {
        for (Index e = 0; e < Cells; ++e) along_[e] = lines.along[e * lines.stride + i];
    }

    // Whole registers overwrite cells of the band, which are not wanted here.
    template <class D>
    HWY_INLINE void operator()(D d, Index j) const {
        const auto columns = static_cast<Index>(hn::MaxLanes(d));
        const bool left = j < i_;
        const bool right = j + columns > i_ + Cells;
        if (left && right) {
            const auto column = hn::Iota(d, static_cast<double>(j));
            const auto in_left = hn::Lt(column, hn::Set(d, static_cast<double>(i_)));
            put(d, j, hn::IfThenElse(in_left, landed_left(d, j), landed_right(d, j)));
        } else if (left) {
            put(d, j, landed_left(d, j));
        } else if (right) {
            put(d, j, landed_right(d, j));
        }
    }

    // The cell in column 0, where the line of the row lands all that falls below the grid.
    HWY_INLINE void land_in_fines(double before) const {
        constexpr Tag<1> d{};
        auto landed = hn::Zero(d);
        for (Index e = Cells - 1; e >= 0; --e) {
            landed = hn::MulAdd(hn::Set(d, along_[e]), hn::Set(d, lines_.below[i_ + e]), landed);
        }
        hn::StoreU(hn::Add(hn::Set(d, before), with_products(d, 0, landed)), d, after_);
    }

  private:
    // All cells left of the band lie on the line of the row.
    template <class D>
    HWY_INLINE hn::Vec<D> landed_left(D d, Index j) const {
        const double* const share = lines_.mass_upwards + lines_.bins - 1 - i_ + j;
        auto landed = hn::Zero(d);
        for (Index e = Cells - 1; e >= 0; --e) {
            landed = hn::MulAdd(hn::Set(d, along_[e]), hn::LoadU(d, share - e), landed);
        }
        return landed;
    }

    // Cells right of the band have a column's line each.
    template <class D>
    HWY_INLINE hn::Vec<D> landed_right(D d, Index j) const {
        const double* const share = i_ > 0 ? lines_.mass + (j - i_) : lines_.below + j;
        auto landed = hn::Zero(d);
        for (Index e = Cells - 1; e >= 0; --e) {
            landed = hn::MulAdd(hn::LoadU(d, lines_.down + e * lines_.stride + j), hn::LoadU(d, share + e),
                                landed);
        }
        return landed;
    }

    template <class D>
    HWY_INLINE hn::Vec<D> with_products(D d, Index j, hn::Vec<D> landed) const {
        const NarrowProducts& from = lines_.landing;
        for (Index q = 0; q < from.products; ++q) {
            landed = hn::MulAdd(hn::Set(d, from.psi[q * lines_.bins + i_]),
                                hn::LoadU(d, from.psibar + q * lines_.bins + j), landed);
        }
        return landed;
    }

    template <class D>
    HWY_INLINE void put(D d, Index j, hn::Vec<D> landed) const {
        hn::StoreU(hn::Add(hn::LoadU(d, before_ + j), with_products(d, j, landed)), d, after_ + j);
    }

    const NarrowLanding& lines_;
    Index i_;
    const double* before_;
    double* after_;
    double along_[Cells];
};

template <Index Cells>
HWY_INLINE void land_rows(const NarrowLanding& lines, MatrixView<const double> state,
                          MatrixView<double> out) {
    for (Index i = 0; i < lines.bins; ++i) {
        const NarrowRow<Cells> row(lines, i, state.row(i), out.row(i));
        const double in_fines = state(i, 0);
        for_each_register(row, 0, lines.bins);
        if (i >= Cells) row.land_in_fines(in_fines);
    }
}

template <Index Cells = 1>
HWY_INLINE void land_outside_of(const NarrowLanding& lines, MatrixView<const double> state,
                                MatrixView<double> out) {
    if constexpr (Cells <= widest_narrow_band + 1) {
        if (lines.width + 1 == Cells) return land_rows<Cells>(lines, state, out);
        land_outside_of<Cells + 1>(lines, state, out);
    }
}

void land_outside(const NarrowLanding& lines, MatrixView<const double> state, MatrixView<double> out) {
    land_outside_of(lines, state, out);
}

template <Index Problems>
HWY_INLINE void move_register(const NarrowGradings& g, Index first) {
    constexpr Tag<Problems> d{};
    const auto crushed = [&](Index i) { return hn::LoadU(d, g.crushed + i * Problems + first); };
    const auto sums = [&](Index a) { return g.sums + a * Problems + first; };
    for (Index a = 0; a < g.terms; ++a) hn::StoreU(hn::Zero(d), d, sums(a));
    auto fines = hn::LoadU(d, g.grading + first);
    for (Index i = 0; i < g.bins; ++i) fines = hn::MulAdd(crushed(i), hn::Set(d, g.below[i]), fines);
    hn::StoreU(fines, d, g.grading + first);
    Index in_block = -1;
    for (Index i = g.bins - 1; i >= 1; --i) {
        auto landed = hn::Zero(d);
        for (Index m = std::min(g.head, g.bins - 1 - i); m >= 1; --m) {
            landed = hn::MulAdd(hn::Set(d, g.mass[m]), crushed(i + m), landed);
        }
        if (g.terms > 0) {
            const Index source = i + g.head + 1;
            const auto enters = source < g.bins ? crushed(source) : hn::Zero(d);
            const bool next_block = ++in_block == g.shells_a_block;
            if (next_block) in_block = 0;
            const double* const entering = g.entering + in_block * g.terms;
            const double* const falling = g.falling + in_block * g.terms;
            for (Index a = 0; a < g.terms; ++a) {
                auto sum = hn::LoadU(d, sums(a));
                if (next_block) {
                    sum = hn::Mul(sum, hn::Set(d, g.decay[a]));
                    sum = hn::IfThenElseZero(hn::Gt(hn::Abs(sum), hn::Set(d, negligible)), sum);
                }
                sum = hn::MulAdd(enters, hn::Set(d, entering[a]), sum);
                hn::StoreU(sum, d, sums(a));
                landed = hn::MulAdd(sum, hn::Set(d, falling[a]), landed);
            }
        }
        // The exact result is 0 if all of a bin crushes, and a negative one is rounding.
        double* const to = g.grading + i * Problems + first;
        const auto left = hn::Sub(hn::Add(hn::LoadU(d, to), landed), crushed(i));
        hn::StoreU(hn::IfThenZeroElse(hn::Lt(left, hn::Zero(d)), left), d, to);
    }
}

void move_gradings(const NarrowGradings& gradings) {
    if (gradings.problems == 1) {
        move_register<1>(gradings, 0);
        return;
    }
    for (Index first = 0; first < lanes; first += width) move_register<lanes>(gradings, first);
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace comminute::detail {

HWY_EXPORT(sweep_narrow);
HWY_EXPORT(land_outside);
HWY_EXPORT(move_gradings);

void sweep_narrow(const NarrowBand& band) {
    HWY_DYNAMIC_DISPATCH(sweep_narrow)(band);
}
void land_outside(const NarrowLanding& lines, MatrixView<const double> state, MatrixView<double> out) {
    HWY_DYNAMIC_DISPATCH(land_outside)(lines, state, out);
}
void move_gradings(const NarrowGradings& gradings) {
    HWY_DYNAMIC_DISPATCH(move_gradings)(gradings);
}

}  // namespace comminute::detail
#endif
