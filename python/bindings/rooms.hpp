// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bindings.hpp"

// Classes of a room that have a file of their own; the room's function registers them.
void register_grid(py::module_& m);              // model
void register_fragment_laws(py::module_& m);     // model
void register_stress(py::module_& m);            // model
void register_exact_masses(py::module_& m);      // fabric
void register_grading(py::module_& m);           // gradings
void register_ideal_gradings(py::module_& m);    // gradings
void register_slow_update(py::module_& m);       // stepping
void register_full_convolution(py::module_& m);  // stepping
void register_solve_report(py::module_& m);      // sweeping
void register_material_sweep(py::module_& m);    // sweeping
void register_column_lattice(py::module_& m);    // lattice
void register_material_points(py::module_& m);   // points
void register_response_family(py::module_& m);   // points
void register_resolved_batch(py::module_& m);    // resolved
void register_resolved_column(py::module_& m);   // columns
void register_resolved_grid(py::module_& m);     // resolved
