// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/full_convolution.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "check.hpp"
#ifdef COMMINUTE_HAS_FFTW
#include "fft_plan.hpp"
#include "lanes.hpp"
#include "line_pairs.hpp"
#include "loops.hpp"
#endif

namespace comminute {

#ifdef COMMINUTE_HAS_FFTW

namespace {

/// Cells of a row that lie in one zone and do the same.
struct Run {
    Index begin;
    Index end;
    Zone zone;
};

/// Columns in pairs side by side: the rows that may hold mass, and the mass of each column.
struct Gathered {
    Index begin = 0;
    Index end = 0;
    std::array<double, lanes> pushed{};
};

void require_finite(MatrixView<const double> p) {
    for (Index i = 0; i < p.rows(); ++i) {
        if (all_finite(p.row(i), p.cols())) continue;
        const double* bad =
            std::find_if_not(p.row(i), p.row(i) + p.cols(), [](double v) { return std::isfinite(v); });
        throw ParameterError("p[" + std::to_string(i) + ", " + std::to_string(bad - p.row(i)) + "] is " +
                             text(*bad) + "; every entry must be finite");
    }
}

}  // namespace

struct FullConvolution::Workspace {
    Workspace(Kernel k, PlanEffort effort)
        : kernel(std::move(k)),
          zones(kernel.grid(), kernel.material(), 0.0),
          spreader(kernel.fragments().mass, lanes / 2, effort),
          some_stays(kernel.fragments().mass[0] > 0.0),
          stride(row_stride(kernel.grid().bins())),
          psi_crushing(static_cast<std::size_t>(kernel.grid().bins() * stride)),
          reach(static_cast<std::size_t>(kernel.grid().bins())) {
        runs.reserve(static_cast<std::size_t>(kernel.grid().bins()));
    }

    StepReport step(MatrixView<const double> p, MatrixView<double> out);
    void find_runs(Index i, const double* mass);
    void add_run(Index begin, Index end, const double* mass, Zone zone);
    void split_row(Index i, double* rest);
    void push(Line*& line, double* to, double share, const double* mass, const Run& run);
    void spread_pair(Index q);
    void spread_lines();
    Gathered gather(Index begin);
    void spread_columns(Index begin, MatrixView<double> out);

    Kernel kernel;
    CrushZones zones;
    LineSpreader spreader;
    bool some_stays;  // of a crush, in its own bin; never under the paper's rule
    Index stride;
    LaneVector psi_crushing;     // mass to be spread along psi: a + f *_psibar c
    std::vector<Index> reach;    // bins of psi_crushing's rows, from the finest, that may hold mass
    Index widest = -1;           // distance |i - j| that is active
    std::vector<Run> runs;       // of the row at hand
    LinePair lines;              // of the pair at hand
    std::size_t line_count = 0;  // of them that are taken, while rows are divided
    StepReport report;
};

// Cells begin .. end - 1 as a run, without what is empty at its ends.
void FullConvolution::Workspace::add_run(Index begin, Index end, const double* mass, Zone zone) {
    while (end > begin && mass[end - 1] == 0.0) --end;
    while (begin < end && mass[begin] == 0.0) ++begin;
    if (begin < end) runs.push_back({begin, end, zone});
}

// The runs of row i that hold mass. Towards finer neighbours the row's own shell decides, and either zone is one
// interval; towards coarser ones each cell's shell does.
void FullConvolution::Workspace::find_runs(Index i, const double* mass) {
    runs.clear();
    const Index grain = std::max<Index>(i - zones.band(i), 0);
    const Index both = std::max<Index>(i - zones.overlap(i), 0);
    add_run(grain, std::min(both, i), mass, Zone::grain);
    add_run(both, i, mass, Zone::both);
    if (zones.band(i) >= 0) add_run(i, i + 1, mass, zones.at(i, i));
    const Index end = std::min(i + widest + 1, kernel.grid().bins());
    for (Index j = i + 1; j < end;) {
        const Zone zone = zones.at(i, j);
        const Index begin = j;
        while (++j < end && zones.at(i, j) == zone) {
        }
        if (zone != Zone::rest) add_run(begin, j, mass, zone);
    }
}

// Puts a share of a run's mass on a line of the pair, which it opens if need be.
void FullConvolution::Workspace::push(Line*& line, double* to, double share, const double* mass,
                                      const Run& run) {
    if (share == 0.0) return;
    if (line == nullptr) {
        line = &lines[line_count++];
        *line = {0.0, run.begin, -1, to};
    }
    double* numbers = spreader.pair(0) + (line - lines.data());
    for (Index j = run.begin; j < run.end; ++j) numbers[2 * j] = share * mass[j];
    line->pushed += share * sum(mass + run.begin, run.end - run.begin);
    line->coarsest = run.end - 1;
}

// Divides row i of the state, which lies in `rest`, into what rests and what crushes in psi (to psi_crushing),
// psibar or both.
void FullConvolution::Workspace::split_row(Index i, double* rest) {
    find_runs(i, rest);
    double* grain = psi_crushing.data() + i * stride;
    const Index filled = runs.empty() ? 0 : runs.back().end;
    std::fill_n(grain, lanes_up(filled), 0.0);
    reach[static_cast<std::size_t>(i)] = 0;
    Line* neighbour = nullptr;
    Line* both = nullptr;
    for (const Run& run : runs) {
        const CrushShares share = kernel.shares(run.zone, i, run.begin);
        const Index count = run.end - run.begin;
        const double mass = sum(rest + run.begin, count);
        report.active += mass;
        report.crushed += (share.grain + share.both) * mass;
        report.crushed_neighbour += (share.neighbour + share.both) * mass;
        add_scaled(share.grain, rest + run.begin, grain + run.begin, count);
        push(neighbour, rest, share.neighbour, rest, run);
        push(both, grain, share.both, rest, run);
        if (share.grain + share.both > 0.0) reach[static_cast<std::size_t>(i)] = run.end;
        std::fill_n(rest + run.begin, count, 0.0);
    }
}

// Spreads pair q, whose lines are those at hand.
void FullConvolution::Workspace::spread_pair(Index q) {
    double* pair = spreader.pair(q);
    const auto unlevel = level(pair, lines);
    spreader.spread(q, finest(lines), coarsest(lines));
    clean(pair, lines, unlevel, some_stays);
}

// Spreads what crushes in psibar, and adds it where it belongs.
void FullConvolution::Workspace::spread_lines() {
    if (line_count == 0) return;
    if (line_count == 1) lines[1] = {0.0, lines[0].finest, -1, nullptr};
    spread_pair(0);
    for (std::size_t b = 0; b < line_count; ++b) {
        add_line(spreader.pair(0) + b, lines[b].to, lines[b].coarsest + 1);
    }
    spreader.clear(0);
    line_count = 0;
}

// Takes eight columns of what crushes in psi into pairs.
Gathered FullConvolution::Workspace::gather(Index begin) {
    Gathered columns;
    const auto bins = static_cast<Index>(reach.size());
    for (Index i = 0; i < bins;) {
        Index end = i;
        while (end < bins && reach[static_cast<std::size_t>(end)] > begin) ++end;
        if (end > i) {
            gather_columns(psi_crushing.data() + i * stride + begin, stride, end - i,
                           spreader.pair(0) + 2 * i, spreader.distance(), columns.pushed.data());
            if (columns.end == 0) columns.begin = i;
            columns.end = end;
        }
        i = end + 1;
    }
    return columns;
}

// Spreads what crushes in psi, eight columns at a time.
void FullConvolution::Workspace::spread_columns(Index begin, MatrixView<double> out) {
    const Gathered columns = gather(begin);
    if (columns.end == 0) return;
    for (Index q = 0; q < lanes / 2; ++q) {
        double* pair = spreader.pair(q);
        for (std::size_t b = 0; b < 2; ++b) {
            Index top = columns.end - 1;
            while (top >= columns.begin && pair[2 * top + static_cast<Index>(b)] == 0.0) --top;
            lines[b] = {columns.pushed[static_cast<std::size_t>(2 * q) + b], columns.begin,
                        top < columns.begin ? -1 : top, nullptr};
        }
        if (coarsest(lines) < 0) continue;
        spread_pair(q);
        std::fill(pair + 2 * (coarsest(lines) + 1), pair + 2 * columns.end, 0.0);
    }
    add_columns(spreader.pair(0), spreader.distance(), columns.end, out, begin);
    for (Index q = 0; q < lanes / 2; ++q) spreader.clear(q);
}

StepReport FullConvolution::Workspace::step(MatrixView<const double> p, MatrixView<double> out) {
    const Index bins = kernel.grid().bins();
    const bool two_lines = kernel.kind() == KernelKind::exact || kernel.kind() == KernelKind::blend;
    report = {};
    report.steps = 1;
    widest = -1;
    for (Index m = 0; m < bins; ++m) widest = std::max(widest, zones.band(m));
    for (Index i = 0; i < bins; ++i) {
        if (out.data() != p.data()) std::copy_n(p.row(i), bins, out.row(i));
        split_row(i, out.row(i));
        if (two_lines || line_count == lines.size()) spread_lines();
    }
    spread_lines();
    for (Index j = 0; j < bins; j += lanes) spread_columns(j, out);
    return report;
}

FullConvolution::FullConvolution(Kernel kernel, PlanEffort effort)
    : work_(std::make_unique<Workspace>(std::move(kernel), effort)) {}

StepReport FullConvolution::step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out) {
    require_square(p, work_->kernel.grid().bins(), "p");
    require_square(out, work_->kernel.grid().bins(), "out");
    require_same_or_apart(p, out);
    require_finite(p);
    work_->zones.set_load(stress_ratio);
    return work_->step(p, out);
}

const Kernel& FullConvolution::kernel() const {
    return work_->kernel;
}

bool has_fftw() {
    return true;
}

#else  // without FFTW

struct FullConvolution::Workspace {
    Kernel kernel;
};

FullConvolution::FullConvolution(Kernel, PlanEffort) {
    throw UnavailableError(
        "FullConvolution needs FFTW, which this build of comminute leaves out; install libfftw3-dev and "
        "build with "
        "-DCOMMINUTE_WITH_FFTW=ON, or use SlowUpdate, which needs none");
}

StepReport FullConvolution::step(MatrixView<const double>, double, MatrixView<double>) {
    return {};
}

const Kernel& FullConvolution::kernel() const {
    return work_->kernel;
}

bool has_fftw() {
    return false;
}

#endif

FullConvolution::~FullConvolution() = default;
FullConvolution::FullConvolution(FullConvolution&&) noexcept = default;
FullConvolution& FullConvolution::operator=(FullConvolution&&) noexcept = default;

}  // namespace comminute
