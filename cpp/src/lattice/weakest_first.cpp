// SPDX-License-Identifier: BSD-3-Clause
#include "lattice/weakest_first.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "lattice/crush.hpp"
#include "lattice/ring_criterion.hpp"

namespace comminute::detail {
namespace {

// Why no queue of all cells is needed. The rule says: crush the globally weakest cell, as long as the load limit
// bears on it. But a crush changes the critical loads of one cell and its two neighbours only, so crushes in
// stretches that cannot influence each other commute, and random numbers are drawn by cell and crush count, not by
// turn. A cell that cannot crush below some limit whatever its neighbours do is a barrier: up to that limit the
// stretches on its two sides evolve independently. Two kinds of cells are barriers for good, since sizes only fall:
// those too small or too strong to crush even among equals, and those larger than their neighbourhood with a critical load beyond
// the limit. They are so frequent that most stretches between them have a few cells. A stretch with few active
// cells is run weakest first from a short list; one with many is first taken, in the same way, to an earlier limit,
// at which there are more barriers. Whatever the limits chosen on the way, the crushes of every stretch come in the
// one order that the rule asks for, so the result is that of one global queue to the last bit.
//
// Equal critical loads are ordered by a random key of the cell, drawn anew at each remixing. Ties only exist between
// cells that have not been touched since (a new critical load is a new real number), so no cell ever joins a tie
// late, and every one of the tied cells is equally likely to be next.

using Cell = std::uint32_t;

struct Event {
    double load;  // log of the critical stress ratio
    Cell cell;
};

struct Moment {
    double load;
    std::uint64_t tie_key;
};

// Cells first, first + 1, ... of the ring, to be taken to the limit; those next to it do not change on the way.
struct Stretch {
    Cell first;
    Cell length;
    Moment limit;
    double risen_to;  // load already reached by the avalanche under way, -inf for none
};

constexpr std::size_t few = 48;                       // active cells of a stretch that is run at once
constexpr std::size_t too_many = 4 * few;             // grown in the run: split after all
constexpr std::uint64_t work_per_question = 1 << 17;  // cells looked at and crushes, about a millisecond
constexpr double infinity = std::numeric_limits<double>::infinity();

// The first active cells of a stretch, or an even sample of them if they are many.
class Sample {
  public:
    void clear() { count_ = size_ = 0, stride_ = 1; }
    void add(Event event) {
        if (count_++ % stride_ != 0) return;
        if (size_ == few) {
            for (std::size_t e = 0; e < few / 2; ++e) events_[e] = events_[2 * e];
            size_ = few / 2;
            stride_ *= 2;
            if ((count_ - 1) % stride_ != 0) return;
        }
        events_[size_++] = event;
    }
    std::size_t count() const { return count_; }
    bool whole() const { return stride_ == 1; }
    Event* begin() { return events_.data(); }
    Event* end() { return events_.data() + size_; }

  private:
    std::array<Event, few> events_;
    std::size_t count_ = 0;
    std::size_t size_ = 0;
    std::size_t stride_ = 1;
};

class WeakestFirst {
  public:
    WeakestFirst(LatticeRing& ring, const Material& material, Mean mean, double log_load,
                 bool record_avalanches, const std::function<bool()>& go_on)
        : ring_(ring),
          material_(material),
          cells_(ring.cells.data()),
          count_(static_cast<Cell>(ring.cells.size())),
          limit_(material, mean, largest_psi(ring), log_load),
          draw_(material.fragments),
          ties_(random_bits(ring.stream, Purpose::tie, 0, ring.remixes)),
          record_avalanches_(record_avalanches),
          go_on_(go_on) {}

    bool run() {
        const Moment end{limit_.log_load(), limit_.tie_key()};
        todo_.push_back({0, count_, end, -infinity});
        while (!todo_.empty()) {
            const Stretch stretch = todo_.back();
            todo_.pop_back();
            if (!sweep(stretch)) return false;
        }
        return true;
    }

  private:
    Cell next(Cell cell) const { return cell + 1 == count_ ? 0 : cell + 1; }
    Cell previous(Cell cell) const { return cell == 0 ? count_ - 1 : cell - 1; }
    bool inside(const Stretch& stretch, Cell cell) const {
        const Cell offset = cell >= stretch.first ? cell - stretch.first : cell + count_ - stretch.first;
        return offset < stretch.length;
    }

    std::uint64_t tie_key(Cell cell) const { return random_key(ties_, cell); }
    bool before(const Event& a, const Event& b) const {
        if (a.load != b.load) return a.load < b.load;
        const auto key_a = tie_key(a.cell);
        const auto key_b = tie_key(b.cell);
        return key_a != key_b ? key_a < key_b : a.cell < b.cell;
    }

    LoadLimit::Look look(Cell left, Cell cell, Cell right, double& critical) const {
        return limit_.look(
            cells_[left], cells_[cell], cells_[right], log_strength_of(ring_, cell),
            [&] { return tie_key(cell); }, critical);
    }

    // Takes the stretch to its limit, or puts parts of it on the list of what is to be done; false: interrupted.
    bool sweep(const Stretch& stretch) {
        limit_.set(stretch.limit.load, stretch.limit.tie_key);
        Cell start = stretch.first;
        if (stretch.length == count_ && !find_barrier(start)) start = stretch.first;
        Stretch part{start, 0, stretch.limit, stretch.risen_to};
        Sample active;
        Cell cell = start;
        Cell left = previous(cell);
        for (Cell step = 0; step < stretch.length; ++step) {
            const Cell right = next(cell);
            double critical = 0.0;
            const auto found = look(left, cell, right, critical);
            if (found == LoadLimit::Look::barrier) {
                if (active.count() > 0) take(part, active);
                active.clear();
                part.first = right;
                part.length = 0;
            } else {
                if (found == LoadLimit::Look::active) active.add({critical, cell});
                ++part.length;
            }
            left = cell;
            cell = right;
            if (++work_ >= work_per_question) {
                work_ = 0;
                if (go_on_ && !go_on_()) return false;
            }
        }
        if (active.count() > 0) take(part, active);
        return true;
    }

    // In a whole ring a sweep must begin behind a barrier, or else the last stretch and the first are one.
    bool find_barrier(Cell& start) const {
        for (Cell cell = 0; cell < count_; ++cell) {
            double critical = 0.0;
            if (look(previous(cell), cell, next(cell), critical) == LoadLimit::Look::barrier) {
                start = next(cell);
                return true;
            }
        }
        return false;
    }

    void take(const Stretch& part, Sample& active) {
        if (active.whole()) {
            queue_.assign(active.begin(), active.end());
            run_few(part);
        } else {
            take_in_two(part, active);
        }
    }

    // Three quarters of the active cells first: many enough to get on, few enough for the rest to be barriers.
    void take_in_two(const Stretch& part, Sample& active) {
        auto* const quartile = active.begin() + (active.end() - active.begin()) * 3 / 4;
        std::nth_element(active.begin(), quartile, active.end(),
                         [this](const Event& a, const Event& b) { return before(a, b); });
        Stretch sooner = part;
        sooner.limit = {quartile->load, tie_key(quartile->cell)};
        todo_.push_back(part);
        todo_.push_back(sooner);
    }

    void run_few(const Stretch& part) {
        double risen_to = part.risen_to;
        std::uint64_t crushes = 0;
        while (!queue_.empty()) {
            if (queue_.size() > too_many) {
                todo_.push_back({part.first, part.length, part.limit, risen_to});
                break;
            }
            const Event weakest = take_weakest();
            if (record_avalanches_ && weakest.load > risen_to) {
                record(risen_to, crushes);
                risen_to = weakest.load;
                crushes = 0;
            }
            ++crushes;
            crush(ring_, weakest.cell, draw_, material_);
            const Cell left = previous(weakest.cell);
            const Cell right = next(weakest.cell);
            refresh(part, weakest.cell);
            refresh(part, left);
            if (right != left) refresh(part, right);
        }
        if (record_avalanches_) record(risen_to, crushes);
        work_ += crushes;
    }

    Event take_weakest() {
        std::size_t weakest = 0;
        for (std::size_t e = 1; e < queue_.size(); ++e) {
            if (before(queue_[e], queue_[weakest])) weakest = e;
        }
        const Event event = queue_[weakest];
        queue_[weakest] = queue_.back();
        queue_.pop_back();
        return event;
    }

    void refresh(const Stretch& part, Cell cell) {
        if (!inside(part, cell)) return;
        const auto queued =
            std::find_if(queue_.begin(), queue_.end(), [cell](const Event& e) { return e.cell == cell; });
        double critical = 0.0;
        if (look(previous(cell), cell, next(cell), critical) == LoadLimit::Look::active) {
            if (queued != queue_.end())
                queued->load = critical;
            else
                queue_.push_back({critical, cell});
        } else if (queued != queue_.end()) {
            *queued = queue_.back();
            queue_.pop_back();
        }
    }

    void record(double log_load, std::uint64_t crushes) {
        if (crushes > 0) ring_.avalanches.push_back({std::exp(log_load), crushes});
    }

    LatticeRing& ring_;
    const Material& material_;
    LatticeCell* cells_;
    Cell count_;
    LoadLimit limit_;
    FragmentQuantile draw_;
    std::uint64_t ties_;
    bool record_avalanches_;
    const std::function<bool()>& go_on_;
    std::uint64_t work_ = 0;
    std::vector<Stretch> todo_;
    std::vector<Event> queue_;
};

// Stretches report their avalanches as they come; crushes at one load are one avalanche, wherever they are.
void merge_avalanches(std::vector<Avalanche>& avalanches, std::size_t in_order) {
    const auto fresh = avalanches.begin() + static_cast<std::ptrdiff_t>(in_order);
    std::sort(fresh, avalanches.end(),
              [](const Avalanche& a, const Avalanche& b) { return a.stress_ratio < b.stress_ratio; });
    auto last = fresh;
    for (auto a = fresh; a != avalanches.end(); ++a) {
        if (a != fresh && a->stress_ratio == last->stress_ratio)
            last->crushes += a->crushes;
        else if (a != fresh)
            *++last = *a;
    }
    if (fresh != avalanches.end()) avalanches.erase(last + 1, avalanches.end());
}

}  // namespace

bool crush_weakest_first(LatticeRing& ring, const Material& material, Mean mean, double stress_ratio,
                         bool record_avalanches, const std::function<bool()>& go_on) {
    if (stress_ratio == 0.0) return true;
    WeakestFirst engine(ring, material, mean, closed_log_load(ring, material, stress_ratio),
                        record_avalanches, go_on);
    const bool finished = engine.run();
    if (finished) {
        merge_avalanches(ring.avalanches, ring.avalanches_in_order);
        ring.avalanches_in_order = ring.avalanches.size();
    }
    return finished;
}

}  // namespace comminute::detail
