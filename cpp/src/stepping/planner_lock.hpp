// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace comminute::detail {

/// Holds the lock of FFTW's planner, the host's or the library's own, from its making to its end.
class PlannerLock {
  public:
    PlannerLock();
    ~PlannerLock();
    PlannerLock(const PlannerLock&) = delete;
    PlannerLock& operator=(const PlannerLock&) = delete;

  private:
    void (*unlock_)(void*);
    void* data_;
};

}  // namespace comminute::detail
