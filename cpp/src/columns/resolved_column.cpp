// SPDX-License-Identifier: BSD-3-Clause
// The column as a host meets it (docs/theory/columns.md, section 1).
#include "comminute/resolved_column.hpp"

#include <cmath>
#include <limits>
#include <numeric>
#include <string>

#include "base/check.hpp"
#include "columns/column_work.hpp"
#include "model/column_drive.hpp"
#include "resolved/triple_joint.hpp"

namespace comminute {

using namespace detail;

struct ResolvedColumn::Work : ColumnWork {
    using ColumnWork::ColumnWork;
};

namespace {

std::vector<double> row_of(MatrixView<const double> pmf, Index z) {
    return {pmf.row(z), pmf.row(z) + pmf.cols()};
}

void require_all(const ResolvedColumnOptions& o, const Material& material, double height, Index rows) {
    if (material.strength_scatter) {
        throw ParameterError({.parameter = "strength_scatter",
                              .value = "true",
                              .finding = "is true, and a column knows one strength for each size",
                              .rule = "it must be false"});
    }
    const auto require_share = [](double share, const char* name) {
        require(share > 0.0 && share <= 1.0, name, share, "greater than 0 and at most 1");
    };
    require(height > 0.0 && std::isfinite(height), "height", height, "greater than 0 and finite");
    require(rows >= 2, "rows", static_cast<double>(rows), "at least 2: a single row is a Resolved");
    require_share(o.largest_mixing, "largest_mixing");
    require_share(o.largest_segregation, "largest_segregation");
    require_share(o.competition, "competition");
    require(o.tolerance > 0.0, "tolerance", o.tolerance, "greater than 0");
    require(o.rest > 0.0, "rest", o.rest, "greater than 0");
    require(o.threads >= 1, "threads", static_cast<double>(o.threads), "at least 1");
    require(o.partners != Partners::locked, "partners", 2.0,
            "permuted or shift: what becomes of locked columns depends on more than three cells");
    const double dz = height / static_cast<double>(rows);
    const auto refuse_length = [&](const std::string& rule) {
        throw ParameterError({.parameter = "neighbour_length",
                              .value = text(o.neighbour_length),
                              .number = o.neighbour_length,
                              .rule = rule});
    };
    if (!(o.neighbour_length >= 0.0 && o.neighbour_length <= dz * (1.0 + 1e-12)))
        refuse_length("it must be at least 0 and at most the rows' distance, " + text(dz) +
                      ": take fewer rows, or a greater height");
    if (o.partners == Partners::shift && o.neighbour_length > 0.0 && o.neighbour_length < dz * (1.0 - 1e-12))
        refuse_length("it must be the rows' distance, " + text(dz) + ", where partners are shifted");
}

}  // namespace

ResolvedColumn::ResolvedColumn(const ResolvedGrid& grid, const Material& material,
                               MatrixView<const double> pmf, double height,
                               const ResolvedColumnOptions& options) {
    require_all(options, material, height, pmf.rows());
    work_ = std::make_unique<Work>(grid, material, height, options);
    for (Index z = 0; z < pmf.rows(); ++z) work_->rows.emplace_back(work_->tables, row_of(pmf, z));
}

ResolvedColumn::ResolvedColumn(const ResolvedGrid& grid, const Material& material,
                               const ResolvedColumnRecord& record, double height,
                               const ResolvedColumnOptions& options) {
    require_all(options, material, height, static_cast<Index>(record.rows.size()));
    work_ = std::make_unique<Work>(grid, material, height, options);
    for (const ResolvedRowRecord& row : record.rows) work_->rows.emplace_back(work_->tables, row);
    work_->sweeps = record.sweeps;
    work_->fed = record.fed;
}

ResolvedColumn::~ResolvedColumn() = default;
ResolvedColumn::ResolvedColumn(const ResolvedColumn& other) : work_(std::make_unique<Work>(*other.work_)) {}
ResolvedColumn& ResolvedColumn::operator=(const ResolvedColumn& other) {
    work_ = std::make_unique<Work>(*other.work_);
    return *this;
}
ResolvedColumn::ResolvedColumn(ResolvedColumn&&) noexcept = default;
ResolvedColumn& ResolvedColumn::operator=(ResolvedColumn&&) noexcept = default;

Index ResolvedColumn::rows() const {
    return work_->count();
}
const ResolvedGrid& ResolvedColumn::grid() const {
    return work_->tables.triples.grid();
}
const Material& ResolvedColumn::material() const {
    return work_->tables.triples.material();
}
const ResolvedColumnOptions& ResolvedColumn::options() const {
    return work_->options;
}
double ResolvedColumn::height() const {
    return work_->height;
}
std::uint64_t ResolvedColumn::sweeps() const {
    return work_->sweeps;
}

bool ResolvedColumn::load_to(VectorView<const double> stress_ratio, const std::function<bool()>& go_on) {
    require_entries(stress_ratio.size(), rows(), entry("stress_ratio"), "it must have one for each row");
    for (Index z = 0; z < rows(); ++z) require_stress_ratio(stress_ratio[z]);
    return work_->for_each_row(
        [&](Index z, Tools& tools) { work_->row(z).load_to(work_->tables, stress_ratio[z], tools.settling); },
        go_on);
}

bool ResolvedColumn::stand_under(VectorView<const double> stress_ratio, const std::function<bool()>& go_on) {
    require_entries(stress_ratio.size(), rows(), entry("stress_ratio"), "it must have one for each row");
    for (Index z = 0; z < rows(); ++z) require_stress_ratio(stress_ratio[z]);
    return work_->for_each_row(
        [&](Index z, Tools& tools) {
            work_->row(z).stand_under(work_->tables, stress_ratio[z], tools.settling);
        },
        go_on);
}

ResolvedColumnReport ResolvedColumn::advance(double time, const ColumnDrive& drive, const ColumnEnds& ends,
                                             const std::function<bool()>& go_on) {
    Work& w = *work_;
    require_column_drive(time, drive, rows());
    w.require_ends(ends);
    ResolvedColumnReport report;
    report.inflow.assign(static_cast<std::size_t>(grid().nodes()), 0.0);
    for (Index z = 0; z < rows(); ++z) {
        if (!w.row(z).load())
            throw ParameterError(
                {.parameter = "stress_ratio", .subject = "the column", .finding = "has no load yet"});
    }
    const bool exchanges = drive.mixing > 0.0 || drive.shear_mixing > 0.0 || drive.segregation > 0.0;
    const bool fed = ends.bottom == ColumnEnd::feed || ends.top == ColumnEnd::feed;
    const ColumnWork::Driven driven{drive, ends, fed ? w.grains_of(ends.feed, nullptr) : Grains{}};
    if (exchanges || fed || drive.crush_rate != std::numeric_limits<double>::infinity()) {
        for (Index z = 0; z < rows(); ++z) w.require_no_fall(z, z, *w.row(z).load());
        w.for_each_row([&](Index z, Tools& tools) { w.row(z).open(w.tables, tools.settling); }, {});
    }
    double left = time;
    while (left > 0.0) {
        if (go_on && !go_on()) break;
        double part = left;
        if (ends.feed_rate > 0.0) part = std::min(part, (w.dz() - w.fed) / ends.feed_rate);
        if (exchanges) {
            part = w.divided(driven, part, report);
            const auto first = static_cast<Index>(w.sweeps / 2 % 2);
            w.sweep(driven, part, first, report);
            w.sweep(driven, part, 1 - first, report);
            ++report.exchanges;
        } else if (drive.crush_rate != std::numeric_limits<double>::infinity()) {
            w.for_each_row(
                [&](Index z, Tools& tools) {
                    tools.settling.run(w.row(z).law(), nullptr,
                                       drive.crush_rate * drive.shear_rate[z] * part);
                },
                {});
        }
        if (ends.feed_rate > 0.0) {
            w.fed += ends.feed_rate * part;
            if (w.fed >= w.dz() * (1.0 - 1e-12)) w.push(driven, report);
        }
        left = part < left ? left - part : 0.0;
    }
    return report;
}

std::vector<double> ResolvedColumn::pmf(Index row) const {
    return work_->checked(row).pmf(work_->tables);
}

std::vector<double> ResolvedColumn::triples(Index row) const {
    const auto mass = work_->checked(row).masses(work_->tables);
    const Index nodes = grid().nodes();
    std::vector<double> found;
    found.reserve(static_cast<std::size_t>(nodes * nodes * nodes));
    for (Index b = 0; b < nodes; ++b) {
        for (Index a = 0; a < nodes; ++a) {
            for (Index c = 0; c < nodes; ++c) found.push_back(mass(b, a, c));
        }
    }
    return found;
}

std::vector<double> ResolvedColumn::joint(Index row, const LogGrid& bins) const {
    return joint_of(work_->tables.triples, bins, work_->checked(row).masses(work_->tables));
}

double ResolvedColumn::crushes(Index row) const {
    return work_->checked(row).crushes();
}

double ResolvedColumn::mean_size(Index row) const {
    return work_->grains_of(pmf(row), nullptr).mean;
}

double ResolvedColumn::pending(Index row) const {
    return work_->checked(row).pending();
}

ResolvedColumnRecord ResolvedColumn::record() const {
    ResolvedColumnRecord record;
    for (const LawRow& row : work_->rows) record.rows.push_back(row.record(work_->tables));
    record.sweeps = work_->sweeps;
    record.fed = work_->fed;
    return record;
}

}  // namespace comminute
