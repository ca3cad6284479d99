// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/full_convolution.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "check.hpp"
#ifdef COMMINUTE_HAS_FFTW
#include "fft_plan.hpp"
#endif

namespace comminute {

#ifdef COMMINUTE_HAS_FFTW

namespace {

constexpr Index lines_at_once = 8;

/// One line before spreading: how much mass it pushes, and from how high.
struct Source {
    double pushed = 0.0;
    Index top = -1;

    void add(Index bin, double mass) {
        pushed += mass;
        top = bin;
    }
};

// Removes FFT noise from a spread line by the rule stated in the header, and closes its mass balance in bin
// 0.
void clean(double* line, Index bins, const Source& source, bool some_stays) {
    const Index highest = some_stays ? source.top : source.top - 1;
    double landed = 0.0;
    Index largest = 0;
    line[0] = 0.0;
    for (Index i = 1; i <= highest; ++i) {
        line[i] = std::max(line[i], 0.0);
        landed += line[i];
        if (line[i] > line[largest]) largest = i;
    }
    std::fill(line + std::max(highest, Index{0}) + 1, line + bins, 0.0);
    const double fines = source.pushed - landed;
    line[0] = std::max(fines, 0.0);
    if (fines < 0.0) line[largest] += fines;
}

void require_finite(MatrixView<const double> p) {
    for (Index i = 0; i < p.rows(); ++i) {
        double zero_if_finite = 0.0;
        for (Index j = 0; j < p.cols(); ++j) zero_if_finite += 0.0 * p(i, j);
        if (zero_if_finite == 0.0) continue;
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
          spreader(kernel.fragments().mass, lines_at_once, effort),
          some_stays(kernel.fragments().mass[0] > 0.0),
          stride(8 * ((kernel.grid().bins() + 7) / 8 |
                      1)),  // an odd number of cache lines: columns spread over all sets
          psi_crushing(static_cast<std::size_t>(kernel.grid().bins() * stride)) {}

    StepReport step(MatrixView<const double> p, MatrixView<double> out);
    void split_row(Index i, const double* p, double* rest, double* neighbour, double* both);
    void spread_rows(Index begin, Index end, MatrixView<const double> p, MatrixView<double> out);
    void spread_columns(Index begin, Index end, MatrixView<double> out);

    Kernel kernel;
    CrushZones zones;
    LineSpreader spreader;
    bool some_stays;  // of a crush, in its own bin; never under the paper's rule
    Index stride;
    std::vector<double> psi_crushing;  // mass to be spread along psi: a + f *_psibar c
    std::array<Source, lines_at_once> source;
    StepReport report;
};

// Divides row i of the state into what rests and what crushes in psi (to psi_crushing), psibar or both.
void FullConvolution::Workspace::split_row(Index i, const double* p, double* rest, double* neighbour,
                                           double* both) {
    const Index bins = kernel.grid().bins();
    const Index b = (i % (lines_at_once / 2)) * 2;
    double* grain = psi_crushing.data() + i * stride;
    for (Index j = 0; j < bins; ++j) {
        const double mass = p[j];
        const Zone zone = zones.at(i, j);
        grain[j] = 0.0;
        if (zone == Zone::rest || mass == 0.0) {
            rest[j] = mass;
            continue;
        }
        const CrushShares share = kernel.shares(zone, i, j);
        rest[j] = 0.0;
        grain[j] = share.grain * mass;
        if (share.neighbour > 0.0) {
            neighbour[j] = share.neighbour * mass;
            source[static_cast<std::size_t>(b)].add(j, neighbour[j]);
        }
        if (share.both > 0.0) {
            both[j] = share.both * mass;
            source[static_cast<std::size_t>(b + 1)].add(j, both[j]);
        }
        report.active += mass;
        report.crushed += (share.grain + share.both) * mass;
        report.crushed_neighbour += (share.neighbour + share.both) * mass;
    }
}

void FullConvolution::Workspace::spread_rows(Index begin, Index end, MatrixView<const double> p,
                                             MatrixView<double> out) {
    const Index bins = kernel.grid().bins();
    source.fill({});
    spreader.clear();
    for (Index i = begin; i < end; ++i) {
        const Index b = 2 * (i - begin);
        split_row(i, p.row(i), out.row(i), spreader.line(b), spreader.line(b + 1));
    }
    if (std::all_of(source.begin(), source.end(), [](const Source& s) { return s.top < 0; })) return;
    spreader.spread();
    for (Index i = begin; i < end; ++i) {
        for (const Index b : {2 * (i - begin), 2 * (i - begin) + 1}) {
            if (source[static_cast<std::size_t>(b)].top < 0) continue;
            double* to = b % 2 == 0 ? out.row(i) : psi_crushing.data() + i * stride;
            const double* line = spreader.line(b);
            clean(spreader.line(b), bins, source[static_cast<std::size_t>(b)], some_stays);
            for (Index j = 0; j < bins; ++j) to[j] += line[j];
        }
    }
}

void FullConvolution::Workspace::spread_columns(Index begin, Index end, MatrixView<double> out) {
    const Index bins = kernel.grid().bins();
    source.fill({});
    spreader.clear();
    for (Index i = 0; i < bins; ++i) {
        for (Index j = begin; j < end; ++j) {
            const double mass = psi_crushing[static_cast<std::size_t>(i * stride + j)];
            spreader.line(j - begin)[i] = mass;
            if (mass != 0.0) source[static_cast<std::size_t>(j - begin)].add(i, mass);
        }
    }
    if (std::all_of(source.begin(), source.end(), [](const Source& s) { return s.top < 0; })) return;
    spreader.spread();
    for (Index j = begin; j < end; ++j) {
        clean(spreader.line(j - begin), bins, source[static_cast<std::size_t>(j - begin)], some_stays);
    }
    for (Index i = 0; i < bins; ++i) {
        for (Index j = begin; j < end; ++j) out(i, j) += spreader.line(j - begin)[i];
    }
}

StepReport FullConvolution::Workspace::step(MatrixView<const double> p, MatrixView<double> out) {
    const Index bins = kernel.grid().bins();
    report = {};
    report.steps = 1;
    for (Index i = 0; i < bins; i += lines_at_once / 2) {
        spread_rows(i, std::min(i + lines_at_once / 2, bins), p, out);
    }
    for (Index j = 0; j < bins; j += lines_at_once) {
        spread_columns(j, std::min(j + lines_at_once, bins), out);
    }
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
