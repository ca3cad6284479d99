// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/fabric.hpp"
#include "comminute/material.hpp"
#include "comminute/scheme.hpp"

namespace comminute {

/// Numbers in which material points keep their states; all arithmetic is in double.
enum class PointNumbers : unsigned char {
    float64,  ///< 8 bytes a number
    float32,  ///< 4 bytes a number; a state is scaled to a total of 1 whenever it is read
};

/// State that a material point keeps.
enum class PointContents : unsigned char {
    states,  ///< (N, N) the fabric
    /// 2 N numbers: the grading when the packing was last mixed, from which its fabric follows, and the grading now. As exact,
    /// for points that are loaded at one loading rate between two mixings.
    gradings,
};

/// Settled load of a merged point.
enum class MergedLoad : unsigned char {
    /// The smaller of the two. Cells between the two zones hold mass of one point that crushed to the edge of the larger zone;
    /// it counts as spread evenly outside the smaller zone, so that some of it, in the cells that an edge cuts, is tested again.
    smaller,
    never,  ///< None: all mass counts as freshly filled in, and the whole zone of the next load is applied to it.
};

/// Choices of a MaterialPoints.
struct MaterialPointsOptions {
    PointNumbers numbers = PointNumbers::float64;
    PointContents contents = PointContents::states;
    Scheme scheme = Scheme::conservative;  ///< of the fragments and of the zones
    friend bool operator==(const MaterialPointsOptions& a, const MaterialPointsOptions& b) {
        return a.numbers == b.numbers && a.contents == b.contents && a.scheme == b.scheme;
    }
};

/// Loads of all points in one step.
struct PointLoads {
    VectorView<const double> stress_ratio;  ///< (P) >= 0
    /// (P) not 0: the packing is mixed anew before the load comes; empty: none is
    VectorView<const unsigned char> remix = {nullptr, 0};
    /// (P) in [0, 1], share of the fast kernel (Eq. 67); empty: 0 for all
    VectorView<const double> loading_rate = {nullptr, 0};
};

/// Each point ends a step as one of these.
enum class PointStatus : unsigned char {
    done = 0,
    bad_load = 1,  ///< it keeps its begin state, since its load is NaN or negative
    bad_rate = 2,  ///< it keeps its begin state, since its loading rate is NaN or outside [0, 1]
    rate_change =
        3,  ///< it keeps its begin state: a point that keeps gradings must be mixed before its rate changes
};

/// Thousands of material points of one material, such as those of a finite-element or material-point code.
///
/// Each point has a *begin state*, that of the last accepted step. `trial` takes all points from there to new loads and leaves
/// the begin states alone, as often as an implicit host iterates; `commit` makes the end states the begin states, and
/// `discard` drops them. `update` is a trial and its commit in one, in place.
///
/// The points share their start until they first crush, and a point has memory of its own from then on. Memory is asked for
/// when more points crush than ever before, and once it is there, steps on one thread allocate nothing. States are kept in
/// bins: exact sizes of the start go into theirs.
///
/// A bad load or rate is the matter of its point alone, which keeps its begin state: `status` and `message` say why. No bit
/// of a point depends on other points, nor on the number of threads. One caller at a time; different objects are
/// independent, and copies are clones.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 64);
/// const auto start = comminute::mixed_fabric(comminute::power_law(2.5, 0.01, 1.0), grid);
/// comminute::MaterialPoints points(comminute::Material{}, start, 3);
/// std::vector<double> load{0.5, 10.0, 100.0};
/// CHECK(points.trial({load}));
/// CHECK(points.settled_at()[1] == 0.0);              // the begin state
/// points.commit();
/// CHECK(points.settled_at()[1] == 10.0);
/// load = {-1.0, 5.0, 200.0};
/// CHECK(!points.update({load}));                     // one of them is bad
/// CHECK(points.status()[0] == comminute::PointStatus::bad_load);
/// CHECK(points.message(0) == "stress_ratio[0] is -1; it must be a number of at least 0 (0 is no load)");
/// CHECK(points.settled_at()[1] == 10.0);             // unloaded
/// CHECK(points.settled_at()[2] == 200.0);
/// CHECK(comminute::MaterialPoints::unpack(points.pack()).settled_at()[2] == 200.0);
/// @endcode
class COMMINUTE_API MaterialPoints {
  public:
    /// Room for a message and its final 0.
    static constexpr Index message_size = 512;

    /// @param start  state of all points, its exact sizes in bins; it may have been loaded
    /// @param count  P >= 1
    /// @throws ParameterError for a bad material, a count below 1, or a start that has been loaded where gradings are kept
    MaterialPoints(const Material& material, const Fabric& start, Index count,
                   const MaterialPointsOptions& options = {});
    ~MaterialPoints();
    MaterialPoints(const MaterialPoints& other);
    MaterialPoints& operator=(const MaterialPoints& other);
    MaterialPoints(MaterialPoints&&) noexcept;
    MaterialPoints& operator=(MaterialPoints&&) noexcept;

    Index count() const;
    const LogGrid& grid() const;
    const Material& material() const;
    const MaterialPointsOptions& options() const;

    /// Computes end states from the begin states, which stay. An earlier trial is dropped.
    /// @param threads  >= 1
    /// @return         whether all points are done
    /// @throws ShapeError for lists of another length, ParameterError for fewer threads than 1
    bool trial(const PointLoads& loads, Index threads = 1);
    /// Makes the end states of the trial the begin states; without a trial nothing changes.
    void commit();
    /// Drops the end states of the trial.
    void discard();
    /// trial() and commit() in one, in place.
    bool update(const PointLoads& loads, Index threads = 1);

    /// (P) of the last trial or update.
    VectorView<const PointStatus> status() const;
    /// Message of a point that is not done, at most 511 characters; empty for one that is.
    std::string message(Index i) const;
    /// The same with a final 0.
    /// @param to  (message_size) out
    void message(Index i, char* to) const;

    /// (P) load under which each begin state is at rest, 0 for one that was never loaded or freshly mixed.
    VectorView<const double> settled_at() const;
    /// (P) the same of the end states; of the begin states where no trial waits.
    VectorView<const double> end_settled_at() const;
    /// (P) mass crushed in psi in the last trial or update, every crush counted.
    VectorView<const double> crushed() const;

    /// @param grainsize  (N) out: mass by grainsize of the begin state
    void grading(Index i, VectorView<double> grainsize) const;
    /// @param grainsize  (N) out: the same of the end state, or of the begin state where no trial waits
    void end_grading(Index i, VectorView<double> grainsize) const;
    /// Size that no grain of the begin state exceeds; 0 where it is not known.
    double largest(Index i) const;
    /// The begin state; where gradings are kept it is computed anew from the last mixing.
    Fabric fabric(Index i) const;
    /// Tells whether a point still shares the start.
    bool shares_start(Index i) const;

    /// Mixes two points by their masses into the first, which then has (m_i p_i + m_j p_j) / (m_i + m_j); the second stays
    /// as it is, for its host to drop. Where gradings are kept, which do not tell what lies beside what, the merged point is
    /// mixed anew. A trial that waits is dropped.
    /// @throws ParameterError for masses that are negative, not finite or both 0, and for i = j
    void merge(Index i, Index j, double mass_i, double mass_j, MergedLoad load = MergedLoad::smaller);
    /// Gives point i the begin state of point j, of these points or of others of the same grid and contents.
    /// @throws ParameterError for other grids, numbers or contents
    void assign(Index i, const MaterialPoints& from, Index j);

    /// All begin states with material, grid and start: version, numbers (little-endian) and a checksum.
    std::vector<unsigned char> pack() const;
    /// @throws ParameterError for bytes that are no points, of another version, damaged or cut short
    static MaterialPoints unpack(VectorView<const unsigned char> bytes);
    /// The begin state of one point, to be sent to other points of the same grid, start and contents.
    std::vector<unsigned char> pack_point(Index i) const;
    /// Takes the begin state that pack_point() gave.
    /// @throws ParameterError as unpack(), and for other grids, numbers or contents
    void unpack_point(Index i, VectorView<const unsigned char> bytes);

    /// Bytes of memory for states, those of trials among them.
    std::size_t memory() const;

  private:
    struct Data;
    explicit MaterialPoints(std::unique_ptr<Data> data);
    std::unique_ptr<Data> data_;
};

}  // namespace comminute
