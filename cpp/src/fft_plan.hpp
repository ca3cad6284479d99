// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "comminute/full_convolution.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// A batch of real lines, each spread downwards by one fixed pmf: out[i] = sum_m filter[m] in[i + m].
///
/// Linear, not circular: the lines are zero padded to at least twice their length. The only part of the
/// library that knows FFTW; planning is serialised behind a mutex, spreading is not.
class LineSpreader {
  public:
    /// @param filter  (N) f_m, m = 0 .. N-1
    /// @param batch   lines spread at once, >= 1
    LineSpreader(VectorView<const double> filter, Index batch, PlanEffort effort);
    ~LineSpreader();
    LineSpreader(LineSpreader&&) noexcept;
    LineSpreader& operator=(LineSpreader&&) noexcept;
    LineSpreader(const LineSpreader&) = delete;
    LineSpreader& operator=(const LineSpreader&) = delete;

    Index batch() const;
    /// The first N numbers of a line: mass in, and after spread() mass out.
    double* line(Index b);
    /// Zeroes every line, its padding too.
    void clear();
    void spread();

  private:
    struct Plans;
    std::unique_ptr<Plans> plans_;
};

}  // namespace comminute
