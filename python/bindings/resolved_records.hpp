// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "arrays.hpp"

// States of the law of three cells as tuples, for pickles and files.

inline py::tuple stored(const comminute::TripleRecord& state) {
    return py::make_tuple(copied(state.settled), copied(state.pending), copied(state.endured), state.level,
                          state.crushes, state.avalanches);
}

inline comminute::TripleRecord triple_record_of(const py::handle& object) {
    const auto state = object.cast<py::tuple>();
    return {vector_of<double>(state[0]), vector_of<double>(state[1]), vector_of<double>(state[2]),
            state[3].cast<double>(),     state[4].cast<double>(),     state[5].cast<double>()};
}

inline py::tuple stored(const comminute::ResolvedRecord& r) {
    return py::make_tuple(stored(r.coarse), stored(r.fine), r.log_load, r.hint, r.settled_at, r.nodes,
                          r.crushes_before, r.avalanches_before);
}

inline comminute::ResolvedRecord resolved_record_of(const py::handle& object) {
    const auto state = object.cast<py::tuple>();
    return {triple_record_of(state[0]), triple_record_of(state[1]), state[2].cast<double>(),
            state[3].cast<double>(),    state[4].cast<double>(),    state[5].cast<comminute::Index>(),
            state[6].cast<double>(),    state[7].cast<double>()};
}
