// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>

#include "bindings.hpp"

/// Lets Ctrl-C through a long computation, which calls it now and then without the GIL and in the thread that it was
/// called from; asks Python ten times a second at most.
class Interrupt {
  public:
    bool operator()() {
        const auto now = std::chrono::steady_clock::now();
        if (now - asked_ < std::chrono::milliseconds(100)) return true;
        asked_ = now;
        const py::gil_scoped_acquire acquire;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        return true;
    }

  private:
    std::chrono::steady_clock::time_point asked_ = std::chrono::steady_clock::now();
};
