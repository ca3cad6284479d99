// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// The kinds of help that an error can offer. A host words them for its users: `words_of` has the words for a caller of
/// this C++ library, Python, case files and the command line have their own.
enum class Remedy {
    none,
    normalise,                ///< divide the masses by their sum
    raise_psi_max,            ///< a grid that reaches further up
    size_grid_automatically,  ///< the same, or a grid made by fitting_grid
    lower_psi_min,            ///< a grid that reaches further down
    resolve_fines,            ///< the same, or the tail below the fines bin's edge
    extrapolate,              ///< the tail below the finest sieve, or finer sieves
    cumulate_masses,          ///< the mass fraction finer, where the mass of each bin was given
    cumulate_retained,        ///< per cent finer, where the per cent retained were given
    extend_top,               ///< a sieve that all grains pass, or the last slope carried on
    add_coarser_sieve,        ///< a sieve that all grains pass
    add_finer_sieve,          ///< a size with 0 % finer
    set_first_crush_stress,   ///< the material's own stress, or loads as stress ratios
    set_stress_measure,       ///< the measure by which stress tensors compare
    use_same_grid,            ///< the solver made with the grid of the fabric
    use_blend_kernel,         ///< the kernel to which a loading rate belongs, or no rate
    choose_path,              ///< another of the named paths
    record_avalanches,        ///< avalanches recorded from the start
    use_own_memory,           ///< an output apart from the input
    order_rows,               ///< an array whose rows follow each other without gaps
    leave_out,                ///< the parameter left out
    build_with_fftw,          ///< a build with FFTW
    use_lattice_or_resolved,  ///< a model that knows scattered strengths
};

/// Every kind but `none`.
COMMINUTE_API std::vector<Remedy> remedies();
/// Name of a kind as it stands in the enum, "extend_top"; empty for `none`.
COMMINUTE_API std::string name_of(Remedy remedy);
/// Words of a remedy for a caller of this C++ library; empty for `none`.
COMMINUTE_API std::string words_of(Remedy remedy);

/// One step of the way to an error: an entry of a list, a cell of a table, or a name alone.
struct COMMINUTE_API Place {
    std::string name;               ///< name of a list or an array, "states"; may be empty for a table
    std::vector<Index> index = {};  ///< indices of the entry, counted from 0; empty: the whole list
    Index row = 0;            ///< row of the table, counted from 1 as a reader counts; 0: it is no table
    std::string column = {};  ///< column of the table; empty: the whole row

    friend bool operator==(const Place& a, const Place& b) {
        return a.name == b.name && a.index == b.index && a.row == b.row && a.column == b.column;
    }
};

/// "states[3, 1, 2]", "sand.csv row 5, column size_mm", or the name alone.
COMMINUTE_API std::string text(const Place& place);

/// The parts of an error, from which each host makes the sentence that its users read.
struct COMMINUTE_API Fault {
    std::string parameter = {};                ///< name of the parameter or array at fault, "psi_min"
    std::string value = {};                    ///< its value as text; empty where it has none
    std::optional<double> number = {};         ///< its value, where that is a number
    std::string subject = {};                  ///< subject of the sentence; empty: the parameter or its entry
    std::string finding = {};                  ///< predicate of the sentence; empty: "is <value>"
    std::optional<Place> also = std::nullopt;  ///< a second place, with which the predicate ends
    std::string rule = {};  ///< the rule that is broken, as a clause: "it must be at least 8"
    /// The way to the parameter, outermost first; a last step of the parameter's own name is the entry at fault.
    std::vector<Place> place = {};
    Remedy remedy = Remedy::none;
};

/// "<place>: <parameter> is <value>; <rule>. <remedy>", with what the fault has of it and a host's words for the remedy.
COMMINUTE_API std::string message(const Fault& fault, const std::string& remedy);

/// The same fault as seen from further out: `outer` comes before the other steps of its place.
COMMINUTE_API Fault within(Place outer, Fault fault);

/// The parts that all errors of this library carry.
class COMMINUTE_API Faulty {
  public:
    explicit Faulty(Fault fault);
    const Fault& fault() const noexcept { return *fault_; }

  private:
    std::shared_ptr<const Fault> fault_;  // shared, since copying an exception must not throw
};

/// A parameter outside its range. The message gives its name, its value and the rule.
///
/// @code{.cpp}
/// try {
///     comminute::LogGrid(-6.0, 1.0, 4);
/// } catch (const comminute::ParameterError& error) {
///     CHECK(error.fault().parameter == "bins");
///     CHECK(error.fault().number == 4.0);
///     CHECK(error.fault().rule == "it must be at least 8");
///     CHECK(error.what() == std::string("bins is 4; it must be at least 8"));
/// }
/// @endcode
class COMMINUTE_API ParameterError : public std::invalid_argument, public Faulty {
  public:
    explicit ParameterError(const Fault& fault);
};

/// An array whose shape, layout or overlap does not fit. The message gives both shapes.
class COMMINUTE_API ShapeError : public std::invalid_argument, public Faulty {
  public:
    explicit ShapeError(const Fault& fault);
};

/// A part of the library that this build leaves out. The message says how to get it.
class COMMINUTE_API UnavailableError : public std::runtime_error, public Faulty {
  public:
    explicit UnavailableError(const Fault& fault);
};

/// Shortest decimal text that reads back as the same number.
COMMINUTE_API std::string text(double value);
/// Six significant digits: for numbers that were computed, and would show their rounding.
COMMINUTE_API std::string rounded(double value);

/// Throws ParameterError "<parameter> is <value>; it must be <rule>" unless `ok`.
///
/// @code{.cpp}
/// comminute::require(3.0 > 0.0, "weibull_modulus", 3.0, "greater than 0");
/// CHECK_THROWS_WITH_AS(comminute::require(false, "bins", 4, "at least 8"),
///                      "bins is 4; it must be at least 8", comminute::ParameterError);
/// @endcode
COMMINUTE_API void require(bool ok, const char* parameter, double value, const char* rule);

}  // namespace comminute
