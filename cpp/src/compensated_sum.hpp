// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace comminute {

/// A sum of many numbers of one sign, good to its last bit however many they are (Kahan).
class CompensatedSum {
  public:
    void add(double value) {
        const double wanted = value - excess_;
        const double sum = sum_ + wanted;
        excess_ = (sum - sum_) - wanted;
        sum_ = sum;
    }
    double value() const { return sum_ - excess_; }

  private:
    double sum_ = 0.0;
    double excess_ = 0.0;
};

}  // namespace comminute
