// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "base/check.hpp"
#include "comminute/grading.hpp"

namespace comminute {

using namespace detail;

namespace {

struct Point {
    double size;
    double finer;
    Index row;  // counted from 1, in the order in which the points were given

    Place place() const { return {.name = "", .row = row}; }
};

constexpr double residue = 1e-9;  // per cent by which the sums of a spreadsheet may miss 0 and 100
constexpr double least_fraction = 0.9, most_fraction = 1.1;  // tops between these are tops of fractions
constexpr double most_extension = 2.0;  // ratio of one sieve to the next of the widest series

// 100.00000000000001 is 100, and -5e-15 is 0: what adding up leaves behind is no finding.
double without_residue(double percent) {
    if (std::abs(percent - 100.0) <= residue) return 100.0;
    return std::abs(percent) <= residue ? 0.0 : percent;
}

std::vector<Point> sorted_points(const std::vector<double>& size, const std::vector<double>& percent_finer) {
    const auto count = static_cast<Index>(size.size());
    require_entries(static_cast<Index>(percent_finer.size()), count, entry("percent_finer"),
                    "it must have one for each of the " + std::to_string(count) + " sizes");
    if (count < 2) {
        throw ParameterError({.parameter = "size",
                              .value = std::to_string(count),
                              .number = static_cast<double>(count),
                              .subject = "the sieve curve",
                              .finding = "has " + std::to_string(count) + " points",
                              .rule = "it must have at least 2"});
    }
    std::vector<Point> points;
    for (std::size_t q = 0; q < size.size(); ++q) {
        const Point point{size[q], without_residue(percent_finer[q]), static_cast<Index>(q) + 1};
        const auto require_in_row = [&point](bool ok, const char* column, double value, const char* rule) {
            if (ok) return;
            throw ParameterError({.parameter = column,
                                  .value = text(value),
                                  .number = value,
                                  .rule = rule,
                                  .place = {point.place()}});
        };
        require_in_row(point.size > 0.0 && std::isfinite(point.size), "size", point.size,
                       "it must be greater than 0 and finite");
        require_in_row(point.finer >= 0.0 && point.finer <= 100.0, "percent_finer", point.finer,
                       "it must be between 0 and 100");
        points.push_back(point);
    }
    std::stable_sort(points.begin(), points.end(),
                     [](const Point& a, const Point& b) { return a.size < b.size; });
    return points;
}

// A curve whose top lies near 1 is one of fractions, and one that stays below has no top to be told by.
void read_fractions(std::vector<Point>& points, std::vector<std::string>& notes) {
    const auto by_finer = [](const Point& p, const Point& q) { return p.finer < q.finer; };
    const double top = std::max_element(points.begin(), points.end(), by_finer)->finer;
    if (top == 0.0 || top > most_fraction) return;
    if (top < least_fraction || top > 1.0 + residue / 100.0) {
        throw ParameterError({.parameter = "percent_finer",
                              .value = rounded(top),
                              .number = top,
                              .subject = "the largest percent_finer",
                              .finding = "is " + rounded(top),
                              .rule = "fractions end at 1, and per cent at 100; give per cent"});
    }
    for (Point& point : points) point.finer = without_residue(100.0 * point.finer);
    notes.emplace_back("the values end at " + std::string(top == 1.0 ? "1" : rounded(top)) +
                       ": read as fractions, not per cent");
}

void require_rising(std::vector<Point>& points, const std::string& unit) {
    const std::string in_unit = unit.empty() ? "" : " " + unit;
    for (std::size_t q = 1; q < points.size(); ++q) {
        const Point& below = points[q - 1];
        Point& here = points[q];
        if (here.finer < below.finer && here.finer >= below.finer - residue) here.finer = below.finer;
        if (here.size == below.size) {
            throw ParameterError({.parameter = "size",
                                  .value = text(here.size),
                                  .number = here.size,
                                  .subject = "size " + text(here.size) + in_unit,
                                  .finding = "stands already in",
                                  .also = below.place(),
                                  .rule = "each sieve may appear once",
                                  .place = {here.place()}});
        }
        if (here.finer < below.finer) {
            throw ParameterError(
                {.parameter = "percent_finer",
                 .value = text(here.finer),
                 .number = here.finer,
                 .subject = text(here.finer) + " % finer at " + text(here.size) + in_unit,
                 .finding = "is less than " + text(below.finer) + " % at " + text(below.size) + in_unit,
                 .rule = "cumulative per cent finer cannot fall with size",
                 .place = {here.place()},
                 .remedy = Remedy::cumulate_retained});
        }
    }
}

// A curve that stops short of 100 % is closed, if asked for, along its last slope in ln d.
void close_top(std::vector<Point>& points, const std::string& unit, bool extend,
               std::vector<std::string>& notes) {
    const Point last = points.back();
    if (last.finer == 100.0) return;
    const Point before = points[points.size() - 2];
    const std::string in_unit = unit.empty() ? "" : " " + unit;
    const std::string coarsest = "the coarsest sieve, " + text(last.size) + in_unit + ",";
    const std::string found = "has " + rounded(last.finer) + " % finer, not 100 %";
    if (!extend || last.finer == before.finer) {
        throw ParameterError({.parameter = "percent_finer",
                              .value = text(last.finer),
                              .number = last.finer,
                              .subject = coarsest,
                              .finding = found,
                              .rule = extend ? "the curve is flat there and has no slope to carry on" : "",
                              .remedy = extend ? Remedy::add_coarser_sieve : Remedy::extend_top});
    }
    const double slope = (last.finer - before.finer) / std::log(last.size / before.size);
    const double top = last.size * std::exp((100.0 - last.finer) / slope);
    if (!(top <= most_extension * last.size * (1.0 + residue))) {
        throw ParameterError({.parameter = "percent_finer",
                              .value = text(last.finer),
                              .number = last.finer,
                              .subject = coarsest,
                              .finding = "has " + rounded(last.finer) +
                                         " % finer, and its last slope reaches 100 % at " + rounded(top) +
                                         in_unit + ", a factor of " + rounded(top / last.size) +
                                         " beyond the coarsest sieve",
                              .rule = "top = \"extend\" reaches the next sieve at most, a factor of 2",
                              .remedy = Remedy::add_coarser_sieve});
    }
    points.push_back({top, 100.0, 0});
    notes.push_back(coarsest + " " + found + ": the curve is carried on at its last slope to 100 % at " +
                    rounded(top) + in_unit);
}

// Plateaus at 0 % and at 100 % tell only where the grains end; one point of each is enough for that.
void trim(std::vector<Point>& points) {
    while (points.size() > 2 && points[points.size() - 2].finer == 100.0) points.pop_back();
    while (points.size() > 2 && points[1].finer == 0.0) points.erase(points.begin());
}

double tail_slope(const std::vector<Point>& points, const std::string& unit,
                  std::vector<std::string>& notes) {
    const Point& finest = points[0];
    const Point& next = points[1];
    if (finest.finer == 0.0) return 0.0;
    const std::string in_unit = unit.empty() ? "" : " " + unit;
    const double slope = std::log(next.finer / finest.finer) / std::log(next.size / finest.size);
    const std::string share = rounded(finest.finer) + " %";
    const std::string found = "is finer than the finest sieve, " + text(finest.size) + in_unit;
    if (!(slope > 0.0)) {
        throw ParameterError(
            {.parameter = "percent_finer",
             .value = text(finest.finer),
             .number = finest.finer,
             .subject = share,
             .finding = found + ", and the curve is flat above it, so no tail can be read from it",
             .remedy = Remedy::add_finer_sieve});
    }
    notes.push_back(share + " " + found + ": it continues as a power law of slope " +
                    rounded(std::round(1e4 * slope) / 1e4) + ", through the two finest points");
    return slope;
}

// Shares of grains become shares of mass: in each interval, a mass that is spread evenly in ln d has grains in
// proportion to the mean of d^-3.
void weigh(std::vector<Point>& points, const std::string& unit) {
    if (points[0].finer > 0.0) {
        throw ParameterError({.parameter = "percent_finer",
                              .value = text(points[0].finer),
                              .number = points[0].finer,
                              .subject = rounded(points[0].finer) + " % of the grains",
                              .finding = "are finer than the finest sieve, " + text(points[0].size) +
                                         (unit.empty() ? "" : " " + unit),
                              .rule = "no mass can be read from an open tail of numbers of grains",
                              .remedy = Remedy::add_finer_sieve});
    }
    const double largest = points.back().size;
    std::vector<double> mass{0.0};
    for (std::size_t q = 1; q < points.size(); ++q) {
        const double low = points[q - 1].size / largest;
        const double high = points[q].size / largest;
        const double per_mass = (std::pow(low, -3.0) - std::pow(high, -3.0)) / (3.0 * std::log(high / low));
        mass.push_back(mass.back() + (points[q].finer - points[q - 1].finer) / per_mass);
    }
    for (std::size_t q = 0; q < points.size(); ++q) points[q].finer = 100.0 * (mass[q] / mass.back());
}

}  // namespace

Grading sieve_grading(const std::vector<double>& size, const std::vector<double>& percent_finer,
                      const SieveOptions& options) {
    std::vector<std::string> notes;
    std::vector<Point> points = sorted_points(size, percent_finer);
    read_fractions(points, notes);
    require_rising(points, options.unit);
    close_top(points, options.unit, options.extend_top, notes);
    trim(points);
    if (options.by_number) {
        weigh(points, options.unit);
        notes.emplace_back("the shares count grains: converted to mass with weights of size cubed");
    }
    SieveCurve curve;
    curve.tail_slope = tail_slope(points, options.unit, notes);
    for (const Point& point : points) {
        curve.size.push_back(point.size);
        curve.finer_than.push_back(point.finer / 100.0);
    }
    return {std::move(curve), options.unit, std::move(notes)};
}

}  // namespace comminute
