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
template <Index Packs, bool Crossed>
COMMINUTE_INLINE void advance_packs(const Falling& f, const double* enters, double* arriving, Index at) {
    enters += at;
    arriving += at;
    Pack enter[Packs];
    Pack along[Packs];   // what arrives along the lines of the arm, and
    Pack across[Packs];  // along the one that crosses them: apart, so that neither waits for the other
    for (Index p = 0; p < Packs; ++p) {
        enter[p] = pack_at(enters + p * lanes);
        along[p] = across[p] = Pack{};
    }
    const double* power = Crossed ? f.power + at : nullptr;
    double* sums = f.sums + at * f.terms;
    for (Index a = 0; a < f.terms; ++a, power += f.power_stride, sums += lanes) {
        const double entering = f.entering[a];
        const double falling = f.falling[a];
        const double crossing = Crossed ? f.crossing[a] : 0.0;
        for (Index p = 0; p < Packs; ++p) {
            Pack& line = pack_at(sums + p * f.terms * lanes);
            const Pack now = line + entering * enter[p];
            line = now;
            along[p] += falling * now;
            if constexpr (Crossed) across[p] += crossing * pack_at(power + p * lanes);
        }
    }
    for (Index p = 0; p < Packs; ++p) pack_at(arriving + p * lanes) = along[p] + across[p];
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
    if (f.crossing == nullptr) {
        for (; k + 4 * lanes <= count; k += 4 * lanes) advance_packs<4, false>(f, enters, arriving, k);
        for (; k < count; k += lanes) advance_packs<1, false>(f, enters, arriving, k);
        return;
    }
    for (; k + 4 * lanes <= count; k += 4 * lanes) advance_packs<4, true>(f, enters, arriving, k);
    if (k + 2 * lanes <= count) {
        advance_packs<2, true>(f, enters, arriving, k);
        k += 2 * lanes;
    }
    if (k < count) advance_packs<1, true>(f, enters, arriving, k);
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

COMMINUTE_MULTIVERSION double push(Crushing c, double* onto_line, double* fines, Index count) {
    const Pack zero{};
    Pack sums{};
    for (Index k = 0; k < count; k += lanes) {
        const Pack settled = pack_at(c.settled_share + k);
        const Pack arrived = pack_at(c.arrived_share + k);
        const Pack moving = (settled != zero ? settled * pack_at(c.there + k) : zero) +
                            (arrived != zero ? arrived * pack_at(c.landed + k) : zero);
        pack_at(onto_line + k) = moving;
        pack_at(fines + k) += moving * c.below;
        sums += moving;
    }
    double sum = 0.0;
    for (Index l = 0; l < lanes; ++l) sum += sums[l];
    return sum;
}

COMMINUTE_MULTIVERSION void leave(Crushing c, double* rest, Index count) {
    COMMINUTE_INDEPENDENT
    for (Index k = 0; k < count; ++k) {
        rest[k] = c.there[k] * (1.0 - c.settled_share[k]) + c.landed[k] * (1.0 - c.arrived_share[k]);
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

}  // namespace comminute
