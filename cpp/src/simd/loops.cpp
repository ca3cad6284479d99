// SPDX-License-Identifier: BSD-3-Clause
#include "simd/loops.hpp"

#include <bit>
#include <cstdint>
#include <utility>

#include "simd/lanes.hpp"
#include "simd/multiversion.hpp"

namespace comminute::detail {
namespace {

constexpr double negligible = 1e-290;  // denormal numbers would take a hundred times as long to add

// Vectors at once, so that a term's weights are loaded once for all of them, and what arrives stays in registers. They
// begin with a pack, or lie in one.
template <Index Width, Index Vectors>
COMMINUTE_INLINE void advance_vectors(const Falling& f, const double* enters, double* arriving, Index at) {
    Vector<Width> enter[Vectors];
    Vector<Width> sum[Vectors];
    for (Index v = 0; v < Vectors; ++v) {
        enter[v] = load<Width>(enters + at + v * Width);
        sum[v] = Vector<Width>{};
    }
    const Index terms = f.terms;
    double* sums = f.sums + lanes_down(at) * terms + at % lanes;
    for (Index a = 0; a < terms; ++a, sums += lanes) {
        const double entering = f.entering[a];  // here, lest they be loaded again after every store
        const double falling = f.falling[a];
        for (Index v = 0; v < Vectors; ++v) {
            double* const line = sums + lanes_down(v * Width) * terms + v * Width % lanes;
            const Vector<Width> now = load<Width>(line) + entering * enter[v];
            store<Width>(now, line);
            sum[v] += falling * now;
        }
    }
    for (Index v = 0; v < Vectors; ++v) store<Width>(sum[v], arriving + at + v * Width);
}

template <Index Width>
COMMINUTE_INLINE void advance_by(const Falling& f, const double* enters, double* arriving, Index count) {
    Index k = 0;
    for (; k + 4 * Width <= count; k += 4 * Width) advance_vectors<Width, 4>(f, enters, arriving, k);
    for (; k < count; k += lanes) advance_vectors<Width, lanes / Width>(f, enters, arriving, k);
}

template <Index Width>
COMMINUTE_INLINE double sum_of(Vector<Width> vector) {
    double sum[Width];
    store<Width>(vector, sum);
    for (Index half = Width / 2; half > 0; half /= 2) {
        for (Index l = 0; l < half; ++l) sum[l] += sum[l + half];
    }
    return sum[0];
}

// One arm's part of a few vectors of lines.
template <Index Width, Index Vectors>
struct ArmPart {
    using Numbers = Vector<Width>;

    Numbers enter[Vectors];
    Numbers along[Vectors];   // what arrives along the lines of the arm, and
    Numbers across[Vectors];  // along the one that crosses them: apart, so that neither waits for the other
    double* sums;
    const double* crossing;

    COMMINUTE_INLINE ArmPart(const Arm& arm, Index terms, Index at)
        : sums(arm.sums + lanes_down(at) * terms + at % lanes), crossing(arm.crossing) {
        for (Index v = 0; v < Vectors; ++v) {
            enter[v] = load<Width>(arm.enters + at + v * Width);
            along[v] = Numbers{};
            across[v] = arm.besides != nullptr ? load<Width>(arm.besides + at + v * Width) : Numbers{};
        }
    }

    COMMINUTE_INLINE void crush(const Shell& shell, const Arm& arm, Index at, Numbers& moved) const {
        const Numbers zero{};
        for (Index v = 0; v < Vectors; ++v, at += Width) {
            const Numbers landed =
                along[v] + (across[v] + shell.diagonal * load<Width>(shell.of_diagonal + at));
            if (arm.landed != nullptr) store<Width>(landed, arm.landed + at);
            const Numbers settled = load<Width>(shell.settled_share + at);
            const Numbers arrived = load<Width>(shell.arrived_share + at);
            const Numbers moving = (settled != zero ? settled * load<Width>(arm.there + at) : zero) +
                                   (arrived != zero ? arrived * landed : zero);
            store<Width>(moving, arm.onto_line + at);
            store<Width>(load<Width>(arm.fines + at) + moving * shell.below, arm.fines + at);
            moved += moving;
        }
    }
};

template <Index Width, Index Vectors>
COMMINUTE_INLINE void crush_vectors(const Shell& shell, const Arm& first, const Arm& second, Index at,
                                    Vector<Width>* moved) {
    const Index terms = shell.terms;
    ArmPart<Width, Vectors> arms[2] = {{first, terms, at}, {second, terms, at}};
    const double* const entering_of = shell.entering;
    const double* const falling_of = shell.falling;
    const double* power = shell.power + at;
    const Index power_stride = shell.power_stride;
    for (Index a = 0; a < terms; ++a, power += power_stride) {
        const double entering = entering_of[a];
        const double falling = falling_of[a];
        const double crossing[2] = {arms[0].crossing[a], arms[1].crossing[a]};
        for (Index v = 0; v < Vectors; ++v) {
            const Vector<Width> decayed = load<Width>(power + v * Width);
            for (Index k = 0; k < 2; ++k) {
                double* const line =
                    arms[k].sums + (lanes_down(v * Width) * terms + v * Width % lanes) + a * lanes;
                const Vector<Width> now = load<Width>(line) + entering * arms[k].enter[v];
                store<Width>(now, line);
                arms[k].along[v] += falling * now;
                arms[k].across[v] += crossing[k] * decayed;
            }
        }
    }
    arms[0].crush(shell, first, at, moved[0]);
    arms[1].crush(shell, second, at, moved[1]);
}

// Two vectors of each arm at once, or three where no single one is left over: one alone would wait for itself.
template <Index Width>
COMMINUTE_INLINE Moved crush_arms_by(const Shell& shell, const Arm& first, const Arm& second, Index count) {
    Vector<Width> moved[2] = {};
    Index k = 0;
    if constexpr (Width < lanes) {
        for (; k < count; k += 2 * Width) crush_vectors<Width, 2>(shell, first, second, k, moved);
    } else {
        while (k < count) {
            const Index left = (count - k) / Width;
            if (left >= 5 || left == 3) {
                crush_vectors<Width, 3>(shell, first, second, k, moved);
                k += 3 * Width;
            } else if (left >= 2) {
                crush_vectors<Width, 2>(shell, first, second, k, moved);
                k += 2 * Width;
            } else {
                crush_vectors<Width, 1>(shell, first, second, k, moved);
                k += Width;
            }
        }
    }
    return {sum_of<Width>(moved[0]), sum_of<Width>(moved[1])};
}

template <Index Width, Index Vectors>
COMMINUTE_INLINE void add_to_rows_at(const Terms& of, const double* factors, Index terms, double* rows,
                                     Index row_stride, Index at) {
    double* const row = rows + at;
    Vector<Width> sum[rows_at_once][Vectors];
    for (Index r = 0; r < rows_at_once; ++r) {
        for (Index v = 0; v < Vectors; ++v) sum[r][v] = load<Width>(row + r * row_stride + v * Width);
    }
    const double* line = of.lines + at / lanes * of.pack_stride + at % lanes;
    const Index pack_stride = of.pack_stride;
    const Index term_stride = of.term_stride;
    for (Index a = 0; a < terms; ++a, line += term_stride, factors += rows_at_once) {
        for (Index v = 0; v < Vectors; ++v) {
            const Vector<Width> by = load<Width>(line + v * Width / lanes * pack_stride + v * Width % lanes);
            for (Index r = 0; r < rows_at_once; ++r) sum[r][v] += factors[r] * by;
        }
    }
    for (Index r = 0; r < rows_at_once; ++r) {
        for (Index v = 0; v < Vectors; ++v) store<Width>(sum[r][v], row + r * row_stride + v * Width);
    }
}

template <Index Width>
COMMINUTE_INLINE void add_to_rows_by(const Terms& of, const double* factors, Index terms, double* rows,
                                     Index row_stride, Index count) {
    Index k = 0;
    for (; k + 2 * Width <= count; k += 2 * Width) {
        add_to_rows_at<Width, 2>(of, factors, terms, rows, row_stride, k);
    }
    if (k < count) add_to_rows_at<Width, 1>(of, factors, terms, rows, row_stride, k);
}

// Of two rows `Step` apart, the half of the columns in which they have changed places once all pairs of all steps have.
template <Index Width, Index Step, std::size_t... Column>
COMMINUTE_INLINE void exchange(Vector<Width>& upper, Vector<Width>& lower, std::index_sequence<Column...>) {
    constexpr auto step = static_cast<std::size_t>(Step);
    constexpr auto width = static_cast<std::size_t>(Width);
    const Vector<Width> first =
        __builtin_shufflevector(upper, lower, ((Column & step) == 0 ? Column : width + Column - step)...);
    lower = __builtin_shufflevector(upper, lower, ((Column & step) == 0 ? Column + step : width + Column)...);
    upper = first;
}

template <Index Width, Index Step>
COMMINUTE_INLINE void exchange_all(Vector<Width>* row) {
    for (Index r = 0; r < Width; ++r) {
        if ((r & Step) == 0) {
            exchange<Width, Step>(row[r], row[r + Step],
                                  std::make_index_sequence<static_cast<std::size_t>(Width)>());
        }
    }
}

template <Index Width>
COMMINUTE_INLINE void transpose_by(const double* from, Index from_stride, double* to, Index to_stride) {
    for (Index i = 0; i < lanes; i += Width) {
        for (Index j = 0; j < lanes; j += Width) {
            Vector<Width> row[Width];
            for (Index r = 0; r < Width; ++r) row[r] = load<Width>(from + (i + r) * from_stride + j);
            exchange_all<Width, 1>(row);
            if constexpr (Width > 2) exchange_all<Width, 2>(row);
            if constexpr (Width > 4) exchange_all<Width, 4>(row);
            for (Index r = 0; r < Width; ++r) store<Width>(row[r], to + (j + r) * to_stride + i);
        }
    }
}

}  // namespace

COMMINUTE_MULTIVERSION void add_scaled(double factor, const double* from, double* to, Index count) {
    COMMINUTE_INDEPENDENT
    for (Index k = 0; k < count; ++k) to[k] += factor * from[k];
}

COMMINUTE_MULTIVERSION double sum(const double* values, Index count) {
    double partial[lanes] = {};
    Index k = 0;
    for (; k + lanes <= count; k += lanes) {
        for (Index lane = 0; lane < lanes; ++lane) partial[lane] += values[k + lane];
    }
    for (; k < count; ++k) partial[k % lanes] += values[k];
    return ((partial[0] + partial[1]) + (partial[2] + partial[3])) +
           ((partial[4] + partial[5]) + (partial[6] + partial[7]));
}

COMMINUTE_MULTIVERSION bool all_finite(const double* values, Index count) {
    std::uint64_t bits = 0;
    for (Index k = 0; k < count; ++k) bits |= std::bit_cast<std::uint64_t>(0.0 * values[k]);
    return bits << 1 == 0;  // 0 but for its sign, where 0 times infinity or NaN is NaN
}

COMMINUTE_MULTIVERSION void decay(const double* factor, Index terms, double* sums, Index count) {
    for (Index k = 0; k < count; k += lanes) {
        for (Index a = 0; a < terms; ++a, sums += lanes) {
            for (Index l = 0; l < lanes; ++l) {
                const double now = sums[l] * factor[a];
                sums[l] = now > negligible || now < -negligible ? now : 0.0;
            }
        }
    }
}

COMMINUTE_MULTIVERSION void leave(Staying s, double* rest, Index count) {
    COMMINUTE_INDEPENDENT
    for (Index k = 0; k < count; ++k) {
        rest[k] = s.there[k] * (1.0 - s.settled_share[k]) + s.landed[k] * (1.0 - s.arrived_share[k]);
    }
}

COMMINUTE_MULTIVERSION void settle_row(Landing landing, double* row, double* fines, Index count) {
    COMMINUTE_INDEPENDENT
    for (Index k = 0; k < count; ++k) {
        row[k] += landing.arriving[k] + landing.stays * landing.crushing[k];
        fines[k] += landing.below * landing.crushing[k];
    }
}

COMMINUTE_VERSIONS(void, advance, (const Falling& f, const double* enters, double* arriving, Index count),
                   (f, enters, arriving, count))

COMMINUTE_VERSIONS(Moved, crush_arms, (const Shell& shell, const Arm& first, const Arm& second, Index count),
                   (shell, first, second, count))

COMMINUTE_VERSIONS(void, add_to_rows,
                   (const Terms& of, const double* factors, Index terms, double* rows, Index row_stride,
                    Index count),
                   (of, factors, terms, rows, row_stride, count))

COMMINUTE_VERSIONS(void, transpose, (const double* from, Index from_stride, double* to, Index to_stride),
                   (from, from_stride, to, to_stride))

}  // namespace comminute::detail
