// SPDX-License-Identifier: BSD-3-Clause
#include "loops.hpp"

#include <bit>
#include <cstdint>

#include "lanes.hpp"
#include "multiversion.hpp"

namespace comminute {
namespace {

constexpr double negligible = 1e-290;  // denormal numbers would take a hundred times as long to add

// Packs at once, so that a term's weights are loaded once for all of them, and what arrives stays in registers.
template <Index Packs>
COMMINUTE_INLINE void advance_packs(const Falling& f, const double* enters, double* arriving, Index at) {
    Pack enter[Packs];
    Pack sum[Packs];
    for (Index p = 0; p < Packs; ++p) {
        enter[p] = pack_at(enters + at + p * lanes);
        sum[p] = Pack{};
    }
    double* sums = f.sums + at * f.terms;
    for (Index a = 0; a < f.terms; ++a, sums += lanes) {
        const double entering = f.entering[a];  // here, lest they be loaded again after every store
        const double falling = f.falling[a];
        for (Index p = 0; p < Packs; ++p) {
            Pack& line = pack_at(sums + p * f.terms * lanes);
            const Pack now = line + entering * enter[p];
            line = now;
            sum[p] += falling * now;
        }
    }
    for (Index p = 0; p < Packs; ++p) pack_at(arriving + at + p * lanes) = sum[p];
}

COMMINUTE_INLINE double sum_of(const Pack& pack) {
    return ((pack[0] + pack[4]) + (pack[2] + pack[6])) + ((pack[1] + pack[5]) + (pack[3] + pack[7]));
}

// One arm's part of a few packs of lines.
template <Index Packs>
struct ArmPacks {
    Pack enter[Packs];
    Pack along[Packs];   // what arrives along the lines of the arm, and
    Pack across[Packs];  // along the one that crosses them: apart, so that neither waits for the other
    double* sums;
    const double* crossing;

    COMMINUTE_INLINE ArmPacks(const Arm& arm, Index terms, Index at)
        : sums(arm.sums + at * terms), crossing(arm.crossing) {
        for (Index p = 0; p < Packs; ++p) {
            enter[p] = pack_at(arm.enters + at + p * lanes);
            along[p] = Pack{};
            across[p] = arm.besides != nullptr ? pack_at(arm.besides + at + p * lanes) : Pack{};
        }
    }

    COMMINUTE_INLINE void crush(const Shell& shell, const Arm& arm, Index at, Pack& moved) const {
        const Pack zero{};
        for (Index p = 0; p < Packs; ++p, at += lanes) {
            const Pack landed = along[p] + across[p];
            if (arm.landed != nullptr) pack_at(arm.landed + at) = landed;
            const Pack settled = pack_at(shell.settled_share + at);
            const Pack arrived = pack_at(shell.arrived_share + at);
            const Pack moving = (settled != zero ? settled * pack_at(arm.there + at) : zero) +
                                (arrived != zero ? arrived * landed : zero);
            pack_at(arm.onto_line + at) = moving;
            pack_at(arm.fines + at) += moving * shell.below;
            moved += moving;
        }
    }
};

template <Index Packs>
COMMINUTE_INLINE void crush_packs(const Shell& shell, const Arm& first, const Arm& second, Index at,
                                  Pack* moved) {
    const Index terms = shell.terms;  // here and below, lest a number be loaded again after every store
    ArmPacks<Packs> arms[2] = {{first, terms, at}, {second, terms, at}};
    const double* entering_of = shell.entering;
    const double* falling_of = shell.falling;
    const double* power = shell.power + at;
    const Index power_stride = shell.power_stride;
    for (Index a = 0; a < terms; ++a, power += power_stride) {
        const double entering = entering_of[a];
        const double falling = falling_of[a];
        const double crossing[2] = {arms[0].crossing[a], arms[1].crossing[a]};
        for (Index p = 0; p < Packs; ++p) {
            const Pack decayed = pack_at(power + p * lanes);
            for (Index k = 0; k < 2; ++k) {
                Pack& line = pack_at(arms[k].sums + (p * terms + a) * lanes);
                const Pack now = line + entering * arms[k].enter[p];
                line = now;
                arms[k].along[p] += falling * now;
                arms[k].across[p] += crossing[k] * decayed;
            }
        }
    }
    arms[0].crush(shell, first, at, moved[0]);
    arms[1].crush(shell, second, at, moved[1]);
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

// By value, so that no store can change what the loops are told.
COMMINUTE_MULTIVERSION void advance(Falling f, const double* enters, double* arriving, Index count) {
    Index k = 0;
    for (; k + 4 * lanes <= count; k += 4 * lanes) advance_packs<4>(f, enters, arriving, k);
    for (; k < count; k += lanes) advance_packs<1>(f, enters, arriving, k);
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

// Two packs of each arm at once, or three where no single one is left over: one alone would wait for itself.
COMMINUTE_MULTIVERSION Moved crush_arms(const Shell& shell, const Arm& first, const Arm& second,
                                        Index count) {
    Pack moved[2] = {};
    Index k = 0;
    while (k < count) {
        const Index left = (count - k) / lanes;
        if (left >= 5 || left == 3) {
            crush_packs<3>(shell, first, second, k, moved);
            k += 3 * lanes;
        } else if (left >= 2) {
            crush_packs<2>(shell, first, second, k, moved);
            k += 2 * lanes;
        } else {
            crush_packs<1>(shell, first, second, k, moved);
            k += lanes;
        }
    }
    return {sum_of(moved[0]), sum_of(moved[1])};
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

COMMINUTE_MULTIVERSION void add_to_rows(Terms of, const double* factors, Index terms, double* rows,
                                        Index row_stride, Index count) {
    for (Index k = 0; k < count; k += lanes, of.lines += of.pack_stride) {
        Pack sum[rows_at_once];
        for (Index r = 0; r < rows_at_once; ++r) sum[r] = pack_at(rows + r * row_stride + k);
        const double* line = of.lines;
        for (Index a = 0; a < terms; ++a, line += of.term_stride) {
            const Pack by = pack_at(line);
            for (Index r = 0; r < rows_at_once; ++r) sum[r] += factors[a * rows_at_once + r] * by;
        }
        for (Index r = 0; r < rows_at_once; ++r) pack_at(rows + r * row_stride + k) = sum[r];
    }
}

// In three rounds of pairs of rows: neighbours, next but one, and next but three.
COMMINUTE_MULTIVERSION void transpose(const double* from, Index from_stride, double* to, Index to_stride) {
    Pack row[lanes];
    Pack turned[lanes];
    for (Index r = 0; r < lanes; ++r) row[r] = pack_at(from + r * from_stride);
    for (Index r = 0; r < lanes; r += 2) {
        turned[r] = __builtin_shufflevector(row[r], row[r + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        turned[r + 1] = __builtin_shufflevector(row[r], row[r + 1], 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (Index half = 0; half < lanes; half += lanes / 2) {
        for (Index r = half; r < half + 2; ++r) {
            row[r] = __builtin_shufflevector(turned[r], turned[r + 2], 0, 1, 8, 9, 4, 5, 12, 13);
            row[r + 2] = __builtin_shufflevector(turned[r], turned[r + 2], 2, 3, 10, 11, 6, 7, 14, 15);
        }
    }
    for (Index r = 0; r < lanes / 2; ++r) {
        pack_at(to + r * to_stride) = __builtin_shufflevector(row[r], row[r + 4], 0, 1, 2, 3, 8, 9, 10, 11);
        pack_at(to + (r + 4) * to_stride) =
            __builtin_shufflevector(row[r], row[r + 4], 4, 5, 6, 7, 12, 13, 14, 15);
    }
}

}  // namespace comminute
