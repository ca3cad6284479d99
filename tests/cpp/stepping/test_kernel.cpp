// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::CrushZones;
using comminute::Kernel;
using comminute::KernelKind;
using comminute::LogGrid;
using comminute::Material;
using comminute::ParameterError;
using comminute::PowerLawFragments;
using comminute::Scheme;
using comminute::ShapeError;
using comminute::SlowUpdate;
using comminute::Zone;
using helpers::at;
using helpers::Index;
using helpers::material;
using helpers::State;

TEST_CASE("the kernel of a cell sends its mass where its zone and the kind of kernel say") {
    // h = ln 2 and uniform X: f_m = 2^-m, and from bin i a share 2^-(i-1) ends in the fines bin
    Material m = material(1.0);
    m.fragments = PowerLawFragments{};
    const LogGrid grid(-11.0 * std::log(2.0), 0.0, 12);
    const auto f = [](Index from, Index to) {
        if (to >= from) return 0.0;
        return std::pow(2.0, -static_cast<double>(to == 0 ? from - 1 : from - to));
    };
    const auto stays = [](Index from, Index to) { return from == to ? 1.0 : 0.0; };
    struct Cell {
        Index i, j;
        Zone zone;
        double grain[3], neighbour[3], both[3];  // shares for exact, slow, blend 0.25
    };
    // At sigma* = 8 the zone of psi = 0 reaches 2.9 bins, and both grains crush at a distance of 1.
    const Cell cells[] = {
        {11, 9, Zone::grain, {1.0, 1.0, 0.75}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.25}},
        {9, 11, Zone::neighbour, {0.0, 0.0, 0.0}, {1.0, 1.0, 0.75}, {0.0, 0.0, 0.25}},
        {11, 10, Zone::both, {0.0, 1.0, 0.75}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.25}},
        {10, 11, Zone::both, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.75}, {1.0, 0.0, 0.25}},
        {11, 11, Zone::both, {0.0, 0.5, 0.375}, {0.0, 0.5, 0.375}, {1.0, 0.0, 0.25}},
    };
    const CrushZones zones(grid, m, 8.0);
    State kernel_of(12);
    for (const Cell& c : cells) {
        CHECK(zones.at(c.i, c.j) == c.zone);
        for (std::size_t kind = 0; kind < 4; ++kind) {
            const KernelKind kinds[] = {KernelKind::exact, KernelKind::slow, KernelKind::blend,
                                        KernelKind::fast};
            const double grain = kind == 3 ? 0.0 : c.grain[kind];
            const double neighbour = kind == 3 ? 0.0 : c.neighbour[kind];
            const double both = kind == 3 ? 1.0 : c.both[kind];
            Kernel(grid, m, {kinds[kind], kind == 2 ? 0.25 : 0.0, Scheme::paper})
                .cell(c.i, c.j, 8.0, kernel_of.view());
            for (Index a = 0; a < 12; ++a) {
                for (Index b = 0; b < 12; ++b) {
                    const double expected = grain * f(c.i, a) * stays(c.j, b) +
                                            neighbour * stays(c.i, a) * f(c.j, b) +
                                            both * f(c.i, a) * f(c.j, b);
                    REQUIRE(std::abs(kernel_of(a, b) - expected) < 1e-15);
                }
            }
        }
    }
    const Kernel slow(grid, m, {KernelKind::slow, 0.0, Scheme::paper});
    slow.cell(11, 8, 8.0, kernel_of.view());  // outside
    CHECK(kernel_of(11, 8) == 1.0);
    CHECK(kernel_of.total() == 1.0);
    slow.cell(0, 0, 1e9, kernel_of.view());  // fines among fines
    CHECK(kernel_of(0, 0) == 1.0);
    slow.cell(0, 3, 1e9, kernel_of.view());
    CHECK(kernel_of(0, 2) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(kernel_of(0, 0) == doctest::Approx(0.25).epsilon(1e-14));
}

TEST_CASE("a kernel refuses a loading rate, a cell or an array that does not fit it") {
    const LogGrid grid(-2.0, 0.0, 8);
    CHECK_REFUSED(Kernel(grid, Material{}, {KernelKind::blend, 1.5}),
                  "loading_rate is 1.5; it must be between 0 and 1");
    CHECK_REFUSED(Kernel(grid, Material{}, {KernelKind::blend, helpers::not_a_number}),
                  "loading_rate is nan; it must be between 0 and 1");
    for (const KernelKind kind : {KernelKind::exact, KernelKind::slow, KernelKind::fast}) {
        CHECK_REFUSED(
            Kernel(grid, Material{}, {kind, 0.5}),
            "loading_rate is 0.5; a rate belongs to the blend of kernels, and this one is no blend. Use "
            "KernelKind::blend, or leave loading_rate at 0");
    }
    CHECK_THROWS_AS(SlowUpdate(grid, material(-1.0)), ParameterError);
    const Kernel kernel(grid, Material{}, {KernelKind::exact});
    State out(8);
    out.mass.assign(64, 7.0);
    CHECK_REFUSED(kernel.cell(8, 0, 2.0, out.view()), "i is 8; it must be a bin of the grid, 0 to bins - 1");
    CHECK_REFUSED(kernel.cell(0, -1, 2.0, out.view()),
                  "j is -1; it must be a bin of the grid, 0 to bins - 1");
    CHECK_THROWS_AS(kernel.cell(7, 7, -2.0, out.view()), ParameterError);
    CHECK_THROWS_WITH_AS(kernel.cell(7, 7, 2.0, {out.mass.data(), 8, 7}),
                         "out has shape (8, 7); the grid needs (8, 8)", ShapeError);
    CHECK(out.mass == std::vector<double>(64, 7.0));
}
