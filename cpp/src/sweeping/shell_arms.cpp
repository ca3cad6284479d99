// SPDX-License-Identifier: BSD-3-Clause
// Arrivals in the arms of a shell, and the crushing of their active part (docs/theory/one_sweep.md, section 8).
#include "sweeping/shell_arms.hpp"

#include <algorithm>

#include "simd/loops.hpp"

namespace comminute::detail {
namespace {

// A sum over hundreds of shells is rounded as often; taken in parts of so many shells it is rounded less.
constexpr Index shells_a_part = 32;

}  // namespace

ShellArms::ShellArms(const ShellWalk& walk, const ShellShares& shares, LinesInFlight& columns,
                     LinesInFlight& rows)
    : walk_(walk),
      shares_(shares),
      down_columns_{columns,
                    rows,
                    &OuterProduct::psibar,
                    &OuterProduct::psi,
                    LaneArray(walk.bins() + lanes),
                    LaneArray(walk.bins() + lanes)},
      along_rows_{rows,
                  columns,
                  &OuterProduct::psi,
                  &OuterProduct::psibar,
                  LaneArray(walk.bins() + lanes),
                  LaneArray(walk.bins() + lanes)},
      part_(walk.bins() + lanes) {}

// Mass landing in the arm that the running sums do not cover: from the last `head` shells, and from point masses.
const double* ShellArms::land_besides(Side& side, Index m) {
    const Index begin = walk_.first(m);
    double* const besides = side.besides.data();
    std::fill(besides + lanes_down(begin), besides + lanes_up(m), 0.0);
    if (!walk_.without_head()) land_from_head(side, m);
    for (const OuterProduct& from : *arrivals_) {
        const double factor = (from.*side.across)[m];
        if (factor != 0.0) {
            add_scaled(factor, (from.*side.along).data() + begin, besides + begin, m - begin);
        }
    }
    return besides;
}

// The shells of the head one by one: what each pushed onto the arm's own lines, and onto the line that crosses them.
void ShellArms::land_from_head(Side& side, Index m) {
    const Index begin = walk_.first(m);
    const Index last = walk_.coarsest_in_head(m);
    double* const all = side.besides.data();
    double* const part = last - m < shells_a_part ? all : part_.data();
    for (Index top = last; top >= m; top -= shells_a_part) {
        if (part != all) std::fill(part + begin, part + m, 0.0);
        for (Index shell = top; shell >= m && shell > top - shells_a_part; --shell) {
            side.lines.add_head(m, shell, part);
            const double mass = *side.crossing.pushed(shell, m);
            if (mass != 0.0) {
                add_scaled(mass, walk_.table().mass_towards(shell, begin), part + begin, m - begin);
            }
        }
        if (part != all) add_scaled(1.0, part + begin, all + begin, m - begin);
    }
}

// The fines cell at the end of an arm takes from its own line what lands in any cell, and from the crossing line all
// that falls below the grid.
double ShellArms::landed_in_fines(const Side& side, Index m) const {
    double landed = side.crossing.fines(m);
    for (const OuterProduct& from : *arrivals_) landed += (from.*side.across)[m] * (from.*side.along)[0];
    return side.lines.add_in_fines(m, landed);
}

double ShellArms::crush_fines(Side& side, Index m, double there, double* rest) {
    const double moved = shares_.fines().divide(there, landed_in_fines(side, m), rest);
    *side.lines.pushed(m, 0) = moved;
    side.lines.fines()[0] += moved * walk_.table().below[m];
    return moved;
}

Arm ShellArms::arm_of(Side& side, Index m, const double* there, bool keep_landed) {
    const Index from = lanes_down(walk_.first(m));
    const bool more = !walk_.without_head() || !arrivals_->empty();
    return {there + from,
            more ? land_besides(side, m) + from : nullptr,
            side.lines.entering_sums(m),
            side.lines.sums(from),
            side.crossing.own_sums(),
            keep_landed ? side.landed.data() + from : nullptr,
            side.lines.pushed(m, from),
            side.lines.fines() + from};
}

// Mass that stays in the cells of an arm, but for its fines cell.
void ShellArms::leave_arm(const Side& side, Index m, const double* there, double* rest) const {
    const Index begin = walk_.reaches_fines(m) ? 1 : walk_.first(m);
    leave({there + begin, side.landed.data() + begin, shares_.settled() + begin, shares_.arrived() + begin},
          rest + begin, m - begin);
}

Moved ShellArms::crush(Index m, const double* row, double* column, double* rest) {
    const CrushTable& table = walk_.table();
    const bool keep = rest != nullptr;
    const Index from = lanes_down(walk_.first(m));
    const double half = *down_columns_.lines.pushed(m, m);  // of the diagonal cell, on either line
    const Shell shell{table.terms,
                      walk_.entering(),
                      walk_.falling(),
                      table.powers_towards(0, m, from),
                      table.stride,
                      walk_.without_head() ? half : 0.0,
                      table.mass_towards(m, from),
                      shares_.settled() + from,
                      shares_.arrived() + from,
                      table.below[m]};
    Moved moved = crush_arms(shell, arm_of(down_columns_, m, row, keep), arm_of(along_rows_, m, column, keep),
                             lanes_up(m) - from);
    *down_columns_.lines.pushed(m, m) = *along_rows_.lines.pushed(m, m) = half;  // packs run over it
    if (keep) {
        leave_arm(down_columns_, m, row, rest);
        leave_arm(along_rows_, m, column, column);
    }
    if (walk_.reaches_fines(m)) {
        moved.first += crush_fines(down_columns_, m, row[0], rest);
        moved.second += crush_fines(along_rows_, m, column[0], keep ? column : nullptr);
    }
    return moved;
}

}  // namespace comminute::detail
