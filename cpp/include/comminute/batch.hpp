// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <type_traits>
#include <vector>

#include "comminute/error.hpp"
#include "comminute/export.hpp"
#include "comminute/quasi_static.hpp"

namespace comminute {

/// Borrowed square matrices of one size: `stack[b]` is the b-th, `stride` numbers after the one before it.
template <class T>
class StackView {
  public:
    StackView(T* data, Index count, Index bins) : StackView(data, count, bins, bins * bins) {}
    StackView(T* data, Index count, Index bins, Index stride)
        : data_(data), count_(count), bins_(bins), stride_(stride) {}
    template <class U, class = std::enable_if_t<std::is_convertible_v<U (*)[], T (*)[]>>>
    StackView(StackView<U> other) : StackView(other.data(), other.count(), other.bins(), other.stride()) {}

    T* data() const { return data_; }
    Index count() const { return count_; }
    Index bins() const { return bins_; }
    Index stride() const { return stride_; }
    MatrixView<T> operator[](Index b) const { return {data_ + b * stride_, bins_, bins_}; }

  private:
    T* data_;
    Index count_;
    Index bins_;
    Index stride_;
};

/// Many states and the load of each, such as the material points of a host code.
struct Batch {
    StackView<const double> states;         ///< (B, N, N); with a stride of 0 all points share one state
    VectorView<const double> stress_ratio;  ///< (B)
    /// (B) load under which each state is at rest, 0 for one that was never loaded; empty if none ever was
    VectorView<const double> settled_at;
    /// (B) size that no grain of the state exceeds, which Fabric::largest() is for a fabric, 0 where it is not known; empty
    /// if it is known of none
    VectorView<const double> largest = {nullptr, 0};
};

/// Each state of a batch ends as one of these.
enum class StateStatus : unsigned char {
    waiting,    ///< the batch was stopped before it
    at_rest,    ///< it was solved
    bad_load,   ///< it stays as it was, since its load or the one it is at rest under is NaN or negative
    bad_state,  ///< it stays as it was, since an entry is NaN, infinite, negative or far above 1
};

/// A batch says these things of each state beside the state itself. `solve` must be given `settled_at`; other lists may
/// be empty.
struct BatchOutcome {
    /// (B) out: load under which the state is at rest now, which is what a material point has to remember; may be
    /// `Batch::settled_at` itself
    VectorView<double> settled_at = {nullptr, 0};
    VectorView<SolveReport> reports = {nullptr, 0};  ///< (B) out
    /// (B) out. Where it is given, a bad state or load is said here, that state stays as it was and the others are
    /// solved; where it is not, the first bad one is an exception for all.
    VectorView<StateStatus> status = {nullptr, 0};
};

/// How a batch is run.
struct BatchOptions {
    Index threads = 1;  ///< >= 1, largest number of threads, each with a workspace of its own
    /// Called a few times a second; if it returns false or throws, the batch stops there, with some states written.
    std::function<bool()> go_on;
};

/// QuasiStatic for many states on one grid and material.
///
/// The result for each state equals that of QuasiStatic bit by bit, whatever the number of threads. States with the same
/// loads are solved one after the other and share the crush zones, so that many states under a few loads cost less. By
/// default it starts no thread; each takes some tens of microseconds to start, which pays from some hundred small states
/// on.
///
/// Begin-state in, end-state out, also in place; of the loads under which the states are at rest too. One object serves
/// one caller at a time.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 32);
/// comminute::BatchSolver solver(comminute::QuasiStatic(grid, comminute::Material{}));
/// std::vector<double> states(2 * 32 * 32, 1.0 / (32 * 32));        // of two material points
/// std::vector<double> load{10.0, 100.0}, settled_at{0.0, 0.0};
/// comminute::StackView<double> points(states.data(), 2, 32);
/// std::vector<comminute::SolveReport> reports(2);
/// solver.solve({points, load, settled_at}, points, {settled_at, reports});       // in place
/// CHECK(reports[1].crushed > reports[0].crushed);
/// CHECK(reports[0].crushed > 0.0);
/// load = {20.0, 5.0};                                              // the second is unloaded
/// solver.solve({points, load, settled_at}, points, {settled_at, reports});
/// CHECK(settled_at == std::vector<double>{20.0, 100.0});           // and remembers its largest load
/// @endcode
class COMMINUTE_API BatchSolver {
  public:
    /// Takes grid, material and options from a solver.
    /// @param solver  copied for every thread
    explicit BatchSolver(QuasiStatic solver);

    const QuasiStatic& solver() const { return workers_.front(); }

    /// Brings every state to rest.
    /// @param out      (B, N, N) states at rest under the larger of `stress_ratio` and `settled_at`; may be
    ///                 `batch.states` itself
    /// @return         whether the batch ran to its end; false where `go_on` stopped it
    /// @throws ShapeError for sizes that do not fit or a partial overlap; without a list of status also ParameterError,
    ///         naming the first index, for a bad load or an entry in the crush zone that is no mass. Both are thrown
    ///         before anything is written; only masses so large that their sum overflows are found on the way
    bool solve(const Batch& batch, StackView<double> out, const BatchOutcome& outcome,
               const BatchOptions& options = {});

    /// Computes the grading of every state at rest, without the state.
    /// @param grainsize  (B, N) out: mass by grainsize, of a bad state NaN; may not overlap the states
    /// @return, @throws  as solve()
    bool marginal(const Batch& batch, MatrixView<double> grainsize, const BatchOutcome& outcome = {},
                  const BatchOptions& options = {});

    /// Gives the fault of each state that the last batch said to be bad, by its index.
    const std::map<Index, Fault>& faults() const { return faults_; }

  private:
    struct Run;
    using Work = std::function<void(QuasiStatic& worker, Index begin, Index end)>;

    void require_fit(const Batch& batch, const BatchOutcome& outcome, const BatchOptions& options) const;
    bool run(const Run& run, const BatchOptions& options);
    void solve_some(QuasiStatic& worker, const Run& run, VectorView<const Index> states);
    bool refuse_bad(const Batch& batch, const BatchOptions& options);
    bool for_each_block(Index count, const BatchOptions& options, const Work& work);

    std::vector<QuasiStatic> workers_;
    std::map<Index, Fault> faults_;
};

}  // namespace comminute
