// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/fabric.hpp"
#include "comminute/material.hpp"

namespace comminute {

/// A few exact sizes: monodisperse or gap-graded packings.
///
/// In every law `finer` is the cdf F and `quantile` its inverse inf{d : F(d) >= share}, share in (0, 1]: on a plateau its
/// lower end, at 1 the largest size.
struct COMMINUTE_API PointMasses {
    std::vector<double> size;   ///< > 0, ascending
    std::vector<double> share;  ///< shares of the mass, each > 0, sum 1

    double finer(double size_at) const;
    double quantile(double share_finer) const;
    double smallest_size() const { return size.front(); }
    double largest_size() const { return size.back(); }
    friend bool operator==(const PointMasses& a, const PointMasses& b) {
        return a.size == b.size && a.share == b.share;
    }
};

/// Power law N(> s) ~ s^-alpha between two sizes, by mass
/// F = (s^(3-alpha) - s_m^(3-alpha)) / (s_M^(3-alpha) - s_m^(3-alpha)); alpha = 3 is uniform in ln s, 2 uniform in s.
struct COMMINUTE_API PowerLawGrading {
    double fractal_dimension;
    double smallest;  ///< 0 is allowed for alpha < 3
    double largest;

    double finer(double size_at) const;
    double quantile(double share_finer) const;
    double smallest_size() const { return smallest; }
    double largest_size() const { return largest; }
    friend bool operator==(const PowerLawGrading& a, const PowerLawGrading& b) {
        return a.fractal_dimension == b.fractal_dimension && a.smallest == b.smallest &&
               a.largest == b.largest;
    }
};

/// Lognormal by mass, cut off at `largest` and rescaled.
struct COMMINUTE_API LogNormalGrading {
    double median;
    double sd_log;
    double largest;

    double finer(double size_at) const;
    double quantile(double share_finer) const;
    double smallest_size() const { return 0.0; }
    double largest_size() const { return largest; }
    friend bool operator==(const LogNormalGrading& a, const LogNormalGrading& b) {
        return a.median == b.median && a.sd_log == b.sd_log && a.largest == b.largest;
    }
};

/// Rosin-Rammler F = 1 - exp[-(d / d63)^exponent], cut off at `largest` and rescaled.
struct COMMINUTE_API RosinRammlerGrading {
    double d63;
    double exponent;
    double largest;

    double finer(double size_at) const;
    double quantile(double share_finer) const;
    double smallest_size() const { return 0.0; }
    double largest_size() const { return largest; }
    friend bool operator==(const RosinRammlerGrading& a, const RosinRammlerGrading& b) {
        return a.d63 == b.d63 && a.exponent == b.exponent && a.largest == b.largest;
    }
};

/// Measured points, linear in ln d between sieves; below the finest a power law F = F_1 (d / d_1)^tail_slope.
struct COMMINUTE_API SieveCurve {
    std::vector<double> size;        ///< > 0, ascending
    std::vector<double> finer_than;  ///< fractions, never falling, last 1
    double tail_slope = 0.0;         ///< > 0 where finer_than[0] > 0

    double finer(double size_at) const;
    double quantile(double share_finer) const;
    double smallest_size() const { return finer_than.front() > 0.0 ? 0.0 : size.front(); }
    double largest_size() const { return size.back(); }
    friend bool operator==(const SieveCurve& a, const SieveCurve& b) {
        return a.size == b.size && a.finer_than == b.finer_than && a.tail_slope == b.tail_slope;
    }
};

/// Points of F, never falling in either number; equal sizes are a jump.
struct COMMINUTE_API CurvePoints {
    std::vector<double> size;
    std::vector<double> finer_than;  ///< fractions, the last 1
    double tail_slope = 0.0;         ///< below the finest: F = F_1 (d / d_1)^tail_slope, where F_1 > 0

    /// F(size), linear in ln d between points and after the jump where there is one; below the finest along the tail, or 0
    /// where there is none.
    double finer(double size) const;
    /// inf{d : F(d) >= share}, linear in ln d between points; below the finest along the tail, where there is one.
    double quantile(double share) const;
    /// Mean of ln d by mass, of which Einav's breakage index is a ratio of differences; NaN where mass below the finest point
    /// has no tail.
    double mean_log() const;
    /// Hardin's breakage potential, the mean by mass of log10(d / silt) above the size `silt` and 0 below (Hardin 1985).
    double breakage_potential(double silt) const;
};

/// Curve of a cdf at the upper edges of a grid's bins, up to the first point that holds all. The share in the fines bin
/// continues as a power law through the two finest edges.
/// @param cdf     (N) fraction finer than the upper edge of each bin, points among them
/// @param points  exact sizes, fine to coarse: the curve jumps there, inside their bins
/// @param largest size that no grain exceeds: where it lies inside the bin in which the curve reaches its end, the mass of
///                that bin is spread up to there; 0 where it is not known
/// @throws ShapeError, and ParameterError for a cdf that falls (by more than 1e-12) or is not finite
COMMINUTE_API CurvePoints curve_on_grid(const LogGrid& grid, VectorView<const double> cdf,
                                        const std::vector<PointMass>& points = {}, double largest = 0.0);

/// Curve of a crushed grading that bends at the sieves of its measured start, as far as bins still hold grains of it.
///
/// The mass of a bin, up to what the start had there, is spread as the sieve data are; the rest, fragments that landed
/// there, evenly in ln d. A grading that is the start has the curve that was measured.
/// @param curve    of `mass`, as curve_on_grid() gives it
/// @param mass     (N) by bin
/// @param start    (N) mass of the start by bin
/// @param measured sieve data of the start
/// @throws ShapeError for other sizes
COMMINUTE_API CurvePoints with_sieves(const CurvePoints& curve, const LogGrid& grid,
                                      VectorView<const double> mass, VectorView<const double> start,
                                      const CurvePoints& measured);

/// How the numbers of a sieve table are meant.
struct SieveOptions {
    std::string unit = "mm";
    bool extend_top = false;  ///< carry the last slope in ln d on to 100 % where the curve stops short of it
    /// The shares count grains; they are weighed with size cubed, mass spread evenly in ln d between sieves.
    bool by_number = false;
};

using GradingLaw =
    std::variant<PointMasses, PowerLawGrading, LogNormalGrading, RosinRammlerGrading, SieveCurve>;

/// How much of the mass is finer than each size, at the start. Make one with the functions below.
struct COMMINUTE_API Grading {
    GradingLaw law;
    std::string unit;                ///< unit of the sizes, as text ("mm"); empty where sizes are relative
    std::vector<std::string> notes;  ///< assumptions made on the way, in plain words

    /// Mass fraction of grains no larger than `size`. @throws ParameterError unless size > 0
    double finer(double size) const;
    /// inf{d : F(d) >= share}, the inverse of `finer`; below the finest sieve along the tail. @throws ParameterError
    /// unless 0 < share <= 1
    double quantile(double share) const;
    /// Largest size; no grain is larger.
    double largest() const;
    /// Size that a share `tail` of the mass is finer than; of 0 the smallest size (0 if a tail runs on for ever).
    double smallest(double tail = 0.0) const;
    /// (N) mass by bin; what is finer than the grid goes to the fines bin. Sums to 1.
    /// @throws ParameterError if a grain is larger than the grid's last edge
    std::vector<double> on_grid(const LogGrid& grid) const;
    /// Size D_x such that `percent` of the mass is finer: inf{d : F(d) >= percent/100}, at a plateau its lower
    /// end; D_0 is the smallest size.
    /// @param extrapolate  go on below the finest sieve, along the tail
    /// @throws ParameterError if D_x lies below the finest sieve of a measured curve
    double percentile(double percent, bool extrapolate = false) const;
    /// The curve as points, linear in ln(size) between them: the sieves of a measured curve, both ends of each jump
    /// of point masses, and a law at `count` sizes evenly spaced in ln(size).
    CurvePoints points(Index count = 20001) const;

    friend bool operator==(const Grading& a, const Grading& b) { return a.law == b.law && a.unit == b.unit; }
};

/// @name Makers. All throw ParameterError naming the parameter, its value and the rule.
///
/// @code{.cpp}
/// CHECK(comminute::monodisperse(2.0).finer(1.99) == 0.0);
/// CHECK(comminute::gap_graded(1.0, 0.1, 0.25).finer(0.5) == 0.75);
/// CHECK(comminute::power_law(2.5, 1e-3, 1.0).finer(1.0) == 1.0);
/// auto sand = comminute::sieve_grading({0.5, 1.0, 2.0}, {0.0, 50.0, 100.0}, {"mm"});
/// CHECK(sand.finer(1.0) == 0.5);
/// CHECK(sand.percentile(50.0) == 1.0);
/// @endcode
///@{
COMMINUTE_API Grading monodisperse(double size);
/// Share of the coarse grains in a gap-graded packing where none is given.
inline constexpr double usual_coarse_share = 0.5;
/// @param coarse_share  share of the mass that is coarse, in [0, 1]
COMMINUTE_API Grading gap_graded(double coarse, double fine, double coarse_share = usual_coarse_share);
/// @param fractal_dimension  alpha; 0 < smallest < largest, or smallest = 0 for alpha < 3
COMMINUTE_API Grading power_law(double fractal_dimension, double smallest, double largest);
/// Uniform in s by mass, the power law with alpha = 2.
COMMINUTE_API Grading uniform_size(double smallest, double largest);
/// Uniform in ln s by mass, the power law with alpha = 3.
COMMINUTE_API Grading log_uniform(double smallest, double largest);
/// Exponent of Fuller's own curve; any other is Talbot's.
inline constexpr double fuller_exponent = 0.5;
/// Fuller-Talbot F = (d / largest)^exponent, the power law with alpha = 3 - exponent from 0.
COMMINUTE_API Grading fuller(double largest, double exponent = fuller_exponent);
/// @param median   of the uncut law, by mass
/// @param sd_log   standard deviation of ln s
/// @param largest  where the law is cut off; none: 4 standard deviations above the median (a note says so)
COMMINUTE_API Grading lognormal(double median, double sd_log, std::optional<double> largest = std::nullopt);
/// @param d63      size that 1 - 1/e of the uncut law is finer than
/// @param largest  where the law is cut off; none: where 0.01 % would be coarser (a note says so)
COMMINUTE_API Grading rosin_rammler(double d63, double exponent,
                                    std::optional<double> largest = std::nullopt);
/// @param size           two or more sieve openings in any order, all different
/// @param percent_finer  one a sieve, 0 to 100, never falling with size, 100 at the coarsest; a curve that ends at
///                       near 1 (0.9 to 1) is read as fractions (a note says so). Errors name a point as the row of a table,
///                       counted from 1 in the order given
COMMINUTE_API Grading sieve_grading(const std::vector<double>& size, const std::vector<double>& percent_finer,
                                    const SieveOptions& options = {});
///@}

/// Treatment of the exact sizes of a monodisperse or gap-graded start.
enum class PointHandling {
    exact,   ///< they stay exact until they crush
    binned,  ///< they go to the bins that hold them, for engines that know bins only
};

/// Complete mixing (Eq. 64) of a grading: neighbours independent of the grain. Never loaded.
/// @throws ParameterError if a grain is larger than the grid's last edge
COMMINUTE_API Fabric mixed_fabric(const Grading& grading, const LogGrid& grid, Mean mean = Mean::arithmetic,
                                  PointHandling points = PointHandling::exact);

/// Widest bins of a grid that nobody asked for.
inline constexpr double usual_spacing = 0.02;

/// Bin width that a grading and a fragment law need, so that curves are good to some 2e-3: a twelfth of the range in ln s
/// that holds the middle 68 % of the mass, a tenth of a sieve interval that holds a fifth of it, a twenty-second part of the
/// range of ln X that holds the middle 68 % of the fragments. Point masses need none. Errors grow as the width's square.
/// @returns > 0; 0 where the fragments are all of one relative size, which no bins resolve
///
/// @code{.cpp}
/// CHECK(comminute::needed_spacing(comminute::fuller(2.0), comminute::Material{}) > comminute::usual_spacing);
/// CHECK(comminute::needed_spacing(comminute::uniform_size(0.95, 1.0), comminute::Material{}) < 0.003);
/// @endcode
COMMINUTE_API double needed_spacing(const Grading& grading, const Material& material);
/// The same of the fragment law alone, for a start that is a fabric.
COMMINUTE_API double needed_spacing(const Material& material);

/// Constraints on a fitting grid; fitting_grid() chooses whatever is not given.
struct GridOptions {
    /// Wanted bin width, > 0; none: `usual_spacing`, or `needed_spacing` where that is narrower. The grid's is no larger,
    /// unless that would take more than 4000 bins or `bins` is given.
    std::optional<double> spacing = std::nullopt;
    std::optional<Index> bins = std::nullopt;      ///< number of bins, >= 8
    std::optional<double> psi_min = std::nullopt;  ///< log size at the centre of the fines bin
    std::optional<double> psi_max = std::nullopt;  ///< log size at the last centre
};

/// A grid that fits: its top edge at the largest grain, the fines bin below both the finest grains and the
/// zone of the largest load, point masses on bin centres (the two coarsest at least,
/// unless they differ by less than a bin of the largest grid, or both an end and the number of bins are given).
/// @param max_stress_ratio  largest load to come, >= 0; finite unless the options say the whole grid
/// @throws ParameterError for a load, spacing, end or number of bins outside its range
///
/// @code{.cpp}
/// auto grid = comminute::fitting_grid(comminute::gap_graded(1.0, 0.1), comminute::Material{}, 100.0);
/// CHECK(grid.psi_max() == 0.0);
/// CHECK(grid.centre(grid.bin_of(std::log(0.1))) == doctest::Approx(std::log(0.1)));
/// @endcode
COMMINUTE_API LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                                   const GridOptions& options = {});
/// The same with a wanted bin width alone.
COMMINUTE_API LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                                   double spacing);
/// A whole number would be a bin width, and is meant for a number of bins: give options with `bins`.
LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                     int bins) = delete;

/// Size D_x such that `percent` of the mass is finer: inf{d : F(d) >= percent/100}, linear in ln d inside a
/// bin. On a plateau this is its lower end.
/// @param cdf      (N) fraction finer than the upper edge of each bin
/// @param percent  in [0, 100]
/// @param extrapolate  continue a curve that ends in the fines bin as a power law through its two finest points
/// @param points   exact sizes that are part of `cdf`, fine to coarse: it jumps there, inside their bin
/// @param largest  size that no grain exceeds; 0 where it is not known
/// @throws ParameterError if D_x lies in the fines bin, where no size is known, or above the top; for a cdf that falls (by
/// more than 1e-12) or is not finite
COMMINUTE_API double percentile(const LogGrid& grid, VectorView<const double> cdf, double percent,
                                bool extrapolate = false, const std::vector<PointMass>& points = {},
                                double largest = 0.0);

}  // namespace comminute
