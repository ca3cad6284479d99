// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/column_lattice.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <queue>
#include <string>
#include <tuple>
#include <utility>

#include "base/check.hpp"
#include "base/random.hpp"
#include "base/workers.hpp"
#include "lattice/crush.hpp"
#include "lattice/ring_criterion.hpp"
#include "lattice/rings.hpp"
#include "lattice/weakest_first.hpp"
#include "model/column_drive.hpp"

namespace comminute {

using namespace detail;

namespace {

using Cell = std::uint32_t;

constexpr double infinity = std::numeric_limits<double>::infinity();

// A number in [0, 1) of 53 bits.
double unit(std::uint64_t bits) {
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

// One of `count` numbers from 0 on.
Cell one_of(std::uint64_t bits, std::uint64_t count) {
    __extension__ const auto product = static_cast<unsigned __int128>(bits) * count;
    return static_cast<Cell>(product >> 64);
}

}  // namespace

// Active cells of a row, each with a clock that rings after a time of mean 1, drawn when it came to be active: of all that
// are active at a moment each is as likely to be the next as any other.
class ColumnLattice::Settling {
  public:
    Settling(ColumnRow& row, const ColumnLattice& column, double log_load)
        : row_(row),
          count_(static_cast<Cell>(row.ring.cells.size())),
          material_(column.material_),
          limit_(column.material_, column.options_.mean, column.largest_psi_, log_load),
          draw_(column.material_.fragments),
          rings_at_(row.ring.cells.size(), -1.0) {}

    // Crushes until no cell is active, or until a moment; the number of crushes.
    std::uint64_t run(double until) {
        if (row_.at_rest) {
            for (const Cell cell : row_.touched) {
                look(cell, 0.0);
                look(previous(cell), 0.0);
                look(next(cell), 0.0);
            }
        } else {
            for (Cell cell = 0; cell < count_; ++cell) look(cell, 0.0);
        }
        row_.touched.clear();
        std::uint64_t crushes = 0;
        while (!queue_.empty()) {
            const auto [at, cell] = queue_.top();
            if (at > until) break;
            queue_.pop();
            if (rings_at_[cell] != at) continue;  // no longer active, or active anew
            rings_at_[cell] = -1.0;
            crush(row_.ring, cell, draw_, material_);
            ++row_.crushes[cell];
            ++crushes;
            look(cell, at);
            look(previous(cell), at);
            look(next(cell), at);
        }
        row_.at_rest = queue_.empty();
        return crushes;
    }

  private:
    using Ring = std::pair<double, Cell>;

    Cell next(Cell cell) const { return cell + 1 == count_ ? 0 : cell + 1; }
    Cell previous(Cell cell) const { return (cell == 0 ? count_ : cell) - 1; }

    void look(Cell cell, double now) {
        double critical = 0.0;
        const bool active =
            limit_.look(
                row_.ring.cells[previous(cell)], row_.ring.cells[cell], row_.ring.cells[next(cell)], 0.0,
                [] { return std::uint64_t{0}; }, critical) == LoadLimit::Look::active;
        if (!active) {
            rings_at_[cell] = -1.0;
        } else if (rings_at_[cell] < 0.0) {
            const double uniform = random_uniform(row_.ring.stream, Purpose::clock, 0, row_.activations++);
            rings_at_[cell] = now - std::log1p(-uniform);
            queue_.emplace(rings_at_[cell], cell);
        }
    }

    ColumnRow& row_;
    Cell count_;
    const Material& material_;
    LoadLimit limit_;
    FragmentQuantile draw_;
    std::vector<double> rings_at_;  // moment at which the clock of an active cell rings; negative for others
    std::priority_queue<Ring, std::vector<Ring>, std::greater<>> queue_;
};

ColumnLattice::ColumnLattice(const std::vector<Grading>& rows, Index cells, const Material& material,
                             double height, const ColumnOptions& options)
    : material_(material), options_(options), height_(height) {
    require_all(static_cast<Index>(rows.size()));
    for (const Grading& grading : rows) {
        const auto place = static_cast<Index>(rows_.size());
        add(sampled_ring(cells, place, grading, material_, options.seed));
    }
}

ColumnLattice::ColumnLattice(MatrixView<const double> sizes, const Material& material, double height,
                             const ColumnOptions& options)
    : material_(material), options_(options), height_(height) {
    require_all(sizes.rows());
    for (Index z = 0; z < sizes.rows(); ++z)
        add(ring_of_sizes({sizes.row(z), sizes.cols()}, z, material_, options.seed));
}

ColumnLattice::ColumnLattice(std::vector<ColumnRow> rows, std::vector<double> loads, std::uint64_t sweeps,
                             const Material& material, double height, const ColumnOptions& options)
    : material_(material), options_(options), height_(height), loads_(std::move(loads)), sweeps_(sweeps) {
    require_all(static_cast<Index>(rows.size()));
    rows_ = std::move(rows);
    largest_psi_ = largest_psi(rows_.front().ring);
    for (const ColumnRow& row : rows_) {
        require_entries(static_cast<Index>(row.crushes.size()), static_cast<Index>(row.ring.cells.size()),
                        entry("rows"), "each must have as many crushes as cells");
        largest_psi_ = std::max(largest_psi_, largest_psi(row.ring));
    }
    if (!loads_.empty())
        require_entries(static_cast<Index>(loads_.size()), this->rows(), entry("loads"),
                        "it must have one for each row");
}

void ColumnLattice::require_all(Index rows) {
    material_.validate_sharp();
    require(height_ > 0.0 && std::isfinite(height_), "height", height_, "greater than 0 and finite");
    const auto require_share = [](double share, const char* name) {
        require(share > 0.0 && share <= 1.0, name, share, "greater than 0 and at most 1");
    };
    require_share(options_.largest_mixing, "largest_mixing");
    require_share(options_.largest_segregation, "largest_segregation");
    require(options_.threads >= 1, "threads", static_cast<double>(options_.threads), "at least 1");
    require(rows >= 2, "rows", static_cast<double>(rows), "at least 2: a single row is a Lattice");
    stream_ = random_bits(options_.seed, Purpose::stream, 0, 1);
}

void ColumnLattice::add(LatticeRing ring) {
    largest_psi_ = rows_.empty() ? largest_psi(ring) : std::max(largest_psi_, largest_psi(ring));
    ColumnRow row;
    row.crushes.assign(ring.cells.size(), 0);
    row.ring = std::move(ring);
    rows_.push_back(std::move(row));
}

const ColumnRow& ColumnLattice::checked(Index row) const {
    require(row >= 0 && row < rows(), "row", static_cast<double>(row),
            "0 or more and less than the number of rows");
    return rows_[static_cast<std::size_t>(row)];
}

bool ColumnLattice::load_to(VectorView<const double> stress_ratio, const std::function<bool()>& go_on) {
    require_entries(stress_ratio.size(), rows(), entry("stress_ratio"), "it must have one for each row");
    for (Index z = 0; z < rows(); ++z) require_stress_ratio(stress_ratio[z]);
    loads_.assign(stress_ratio.begin(), stress_ratio.end());
    std::atomic<bool> finished = true;
    for_each_index(
        rows_.size(), static_cast<std::size_t>(options_.threads),
        [&](std::size_t z, const std::function<bool()>& ask) {
            crush_weakest(rows_[z], loads_[z], ask);
            if (!rows_[z].at_rest) finished = false;
        },
        go_on);
    return finished;
}

// Equally weak cells crush in the order of keys of their places. Those that are left over from an order are the ones with
// high keys, so that each exchange, which puts other cells beside them, has keys of its own.
std::uint64_t ColumnLattice::crush_weakest(ColumnRow& row, double load, const std::function<bool()>& ask) {
    row.ring.remixes = exchanges_so_far();
    const std::vector<std::uint32_t> draws = row.ring.crushes;
    row.at_rest = crush_weakest_first(row.ring, material_, options_.mean, load, false, ask);
    row.touched.clear();
    std::uint64_t crushes = 0;
    for (std::size_t c = 0; c < draws.size(); ++c) {
        row.crushes[c] += row.ring.crushes[c] - draws[c];
        crushes += row.ring.crushes[c] - draws[c];
    }
    return crushes;
}

void ColumnLattice::stand_under(VectorView<const double> stress_ratio) {
    require_entries(stress_ratio.size(), rows(), entry("stress_ratio"), "it must have one for each row");
    for (Index z = 0; z < rows(); ++z) require_stress_ratio(stress_ratio[z]);
    for (Index z = 0; z < rows(); ++z) {
        ColumnRow& row = rows_[static_cast<std::size_t>(z)];
        row.at_rest =
            row.at_rest && !loads_.empty() && stress_ratio[z] <= loads_[static_cast<std::size_t>(z)];
    }
    loads_.assign(stress_ratio.begin(), stress_ratio.end());
}

void ColumnLattice::measure() {
    for_each_index(rows_.size(), static_cast<std::size_t>(options_.threads),
                   [&](std::size_t z, const auto&) {
                       ColumnRow& row = rows_[z];
                       double sum = 0.0;
                       row.largest = 0.0;
                       row.smallest = infinity;
                       for (const LatticeCell& cell : row.ring.cells) {
                           sum += cell.size;
                           row.largest = std::max(row.largest, cell.size);
                           row.smallest = std::min(row.smallest, cell.size);
                       }
                       row.mean = sum / static_cast<double>(row.ring.cells.size());
                   },
                   {});
}

ColumnLattice::Bond ColumnLattice::bond(Index lower, double time, const ColumnDrive& drive) const {
    const ColumnRow& a = rows_[static_cast<std::size_t>(lower)];
    const ColumnRow& b = rows_[static_cast<std::size_t>(lower) + 1];
    const double dz = height_ / static_cast<double>(rows());
    const double below = drive.shear_rate[lower];
    const double above = drive.shear_rate[lower + 1];
    const double shear = 0.5 * (below + above);
    const double mean = 0.5 * (a.mean + b.mean);
    const double size = mean * material_.reference_size;
    const double diffusivity = drive.mixing + drive.shear_mixing * shear * size * size;
    const double per_shear = drive.segregation * time / dz;
    return {diffusivity * time / (dz * dz),
            per_shear * shear / mean,
            per_shear * below,
            per_shear * above,
            a.mean,
            b.mean};
}

double ColumnLattice::segregation(const Bond& bond, double lower, double upper) const {
    if (!(lower > upper)) return 0.0;
    if (options_.rates == SwapRates::pair) return bond.segregation * (lower - upper);
    return bond.lower * std::max(lower / bond.lower_mean - 1.0, 0.0) +
           bond.upper * std::max(1.0 - upper / bond.upper_mean, 0.0);
}

// A part of the time in which no probability passes its limit.
double ColumnLattice::divided(double time, const ColumnDrive& drive, ColumnReport& report) const {
    double parts = 1.0;
    for (Index z = 0; z + 1 < rows(); ++z) {
        const Bond here = bond(z, time, drive);
        const double largest = rows_[static_cast<std::size_t>(z)].largest;
        const double smallest = rows_[static_cast<std::size_t>(z) + 1].smallest;
        parts = std::max({parts, here.mixing / options_.largest_mixing,
                          segregation(here, largest, smallest) / options_.largest_segregation});
    }
    const double part = time / std::ceil(parts * (1.0 - 1e-12));
    for (Index z = 0; z + 1 < rows(); ++z) {
        const Bond here = bond(z, part, drive);
        const double q = segregation(here, rows_[static_cast<std::size_t>(z)].largest,
                                     rows_[static_cast<std::size_t>(z) + 1].smallest);
        report.largest_probability =
            std::max(report.largest_probability, here.mixing / (1.0 + here.mixing) + q / (1.0 + 0.5 * q));
    }
    return part;
}

std::uint64_t ColumnLattice::exchange(Index lower, const Bond& bond) {
    ColumnRow& a = rows_[static_cast<std::size_t>(lower)];
    ColumnRow& b = rows_[static_cast<std::size_t>(lower) + 1];
    const auto count = static_cast<Cell>(a.ring.cells.size());
    const auto place = static_cast<std::uint64_t>(lower);
    const std::uint64_t decisions = random_bits(stream_, Purpose::exchange, place, sweeps_);
    const std::uint64_t partners = random_bits(stream_, Purpose::partner, place, sweeps_);
    std::vector<Cell> partner(count);
    std::iota(partner.begin(), partner.end(), Cell{0});
    if (options_.partners == Partners::permuted) {
        for (Cell left = count; left > 1; --left)
            std::swap(partner[left - 1], partner[one_of(random_key(partners, left), left)]);
    } else if (options_.partners == Partners::shift) {
        const Cell offset = one_of(random_key(partners, 0), count);
        std::rotate(partner.begin(), partner.begin() + static_cast<std::ptrdiff_t>(offset), partner.end());
    }
    const double mixing = bond.mixing / (1.0 + bond.mixing);
    std::uint64_t swaps = 0;
    for (Cell below = 0; below < count; ++below) {
        const Cell above = partner[below];
        LatticeCell& grain = a.ring.cells[below];
        LatticeCell& other = b.ring.cells[above];
        const double q = segregation(bond, grain.size, other.size);
        if (!(unit(random_key(decisions, below)) < mixing + q / (1.0 + 0.5 * q))) continue;
        ++swaps;
        std::swap(a.crushes[below], b.crushes[above]);
        if (grain.psi == other.psi) continue;  // neither has new neighbours of another size
        std::swap(grain, other);
        a.touched.push_back(below);
        b.touched.push_back(above);
    }
    return swaps;
}

std::uint64_t ColumnLattice::settle(Index z, double clock) {
    ColumnRow& row = rows_[static_cast<std::size_t>(z)];
    const double load = loads_[static_cast<std::size_t>(z)];
    if (load == 0.0 || (row.at_rest && row.touched.empty())) {
        row.touched.clear();
        return 0;
    }
    if (options_.order == CrushOrder::weakest && clock == infinity) {
        return crush_weakest(row, load, {});
    }
    row.ring.remixes = exchanges_so_far();
    return Settling(row, *this, closed_log_load(row.ring, material_, load)).run(clock);
}

std::uint64_t ColumnLattice::settle_all(const ColumnDrive& drive, double time,
                                        const std::function<bool()>& go_on) {
    std::atomic<std::uint64_t> crushes = 0;
    for_each_index(
        rows_.size(), static_cast<std::size_t>(options_.threads),
        [&](std::size_t z, const auto&) {
            const auto row = static_cast<Index>(z);
            const double strain = drive.shear_rate[row] * time;
            const double clock = drive.crush_rate == infinity ? infinity : drive.crush_rate * strain;
            crushes += settle(row, clock);
        },
        go_on);
    return crushes;
}

ColumnReport ColumnLattice::advance(double time, const ColumnDrive& drive,
                                    const std::function<bool()>& go_on) {
    require_column_drive(time, drive, rows());
    require(!loads_.empty(), "stress_ratio", 0.0, "given first, by load_to: 0 is no load");
    ColumnReport report;
    const bool exchanges = drive.mixing > 0.0 || drive.shear_mixing > 0.0 || drive.segregation > 0.0;
    double left = time;
    while (left > 0.0) {
        if (go_on && !go_on()) break;
        double part = left;
        if (exchanges) {
            measure();
            part = divided(left, drive, report);
            for (Index turn = 0; turn < 2; ++turn) {
                const Index colour = (static_cast<Index>(report.exchanges % 2) + turn) % 2;
                std::atomic<std::uint64_t> swaps = 0;
                // probabilities are those of the sizes before the exchange, whatever the order of the bonds
                std::vector<Bond> bonds;
                for (Index z = 0; z + 1 < rows(); ++z) bonds.push_back(bond(z, part, drive));
                const auto count = static_cast<std::size_t>((rows() - colour) / 2);
                for_each_index(count, static_cast<std::size_t>(options_.threads),
                               [&](std::size_t k, const auto&) {
                                   const Index lower = colour + 2 * static_cast<Index>(k);
                                   swaps += exchange(lower, bonds[static_cast<std::size_t>(lower)]);
                               },
                               {});
                ++sweeps_;
                report.swaps += swaps;
                if (drive.crush_rate == infinity) report.crushes += settle_all(drive, part, {});
            }
        }
        if (drive.crush_rate != infinity || !exchanges) report.crushes += settle_all(drive, part, {});
        ++report.exchanges;
        left = part < left ? left - part : 0.0;
    }
    return report;
}

void ColumnLattice::psi(Index row, VectorView<double> out) const {
    const ColumnRow& from = checked(row);
    require_entries(out.size(), cells(), entry("out"), "it must have one for each cell");
    const double reference = std::log(material_.reference_size);
    for (Index c = 0; c < out.size(); ++c)
        out[c] = from.ring.cells[static_cast<std::size_t>(c)].psi + reference;
}

VectorView<const std::uint32_t> ColumnLattice::crushes(Index row) const {
    return checked(row).crushes;
}

double ColumnLattice::mean_crushes(Index row) const {
    const ColumnRow& of = checked(row);
    std::uint64_t sum = 0;
    for (const std::uint32_t count : of.crushes) sum += count;
    return static_cast<double>(sum) / static_cast<double>(of.crushes.size());
}

double ColumnLattice::mean_size(Index row) const {
    const ColumnRow& of = checked(row);
    double sum = 0.0;
    for (const LatticeCell& cell : of.ring.cells) sum += cell.size;
    return sum / static_cast<double>(of.ring.cells.size()) * material_.reference_size;
}

bool operator==(const ColumnLattice& a, const ColumnLattice& b) {
    const auto options = [](const ColumnOptions& o) {
        return std::tuple(o.seed, o.mean, o.partners, o.order, o.rates, o.largest_mixing,
                          o.largest_segregation);
    };
    if (a.material_ != b.material_ || a.height_ != b.height_ || a.loads_ != b.loads_ ||
        a.sweeps_ != b.sweeps_ || a.rows() != b.rows() || options(a.options_) != options(b.options_))
        return false;
    return std::equal(
        a.rows_.begin(), a.rows_.end(), b.rows_.begin(), [](const ColumnRow& p, const ColumnRow& q) {
            return p.ring.cells == q.ring.cells && p.ring.crushes == q.ring.crushes &&
                   p.ring.stream == q.ring.stream && p.crushes == q.crushes && p.touched == q.touched &&
                   p.at_rest == q.at_rest && p.activations == q.activations;
        });
}

}  // namespace comminute
