// SPDX-License-Identifier: BSD-3-Clause
// A column of sand under a strip load that comes and goes, by the material point method.
//
//     mpm_column OUT [CYCLES]
//
// Ten thousand points remember their largest load, and a response table knows their gradings. The grains of one layer are
// rearranged between the cycles, so that its points keep full states. Files for ParaView and meshio land in OUT
// (column-1.vtu …, column.pvd), and the course of the test in history.csv, from which draw_mpm_column.py makes the figure.
#include <algorithm>
#include <cmath>
#include <comminute/comminute.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "mpm.hpp"

namespace {

constexpr double peak = 30.0;               // MPa on the strip
constexpr double strip = 0.15;              // m, its half width: the left wall is a plane of symmetry
constexpr double taper = 0.04;              // m, over which its pressure falls to 0
constexpr double bottom = 0.36, top = 0.4;  // m, heights between which the layer lies at the start
constexpr int steps_a_look = 40;            // of the column between two looks at its loads

comminute::Material sand_material() {
    comminute::Material sand;
    sand.reference_size = 2.0;
    sand.fabric_width = 0.2;
    sand.first_crush_stress = 2.0;  // MPa, by the energy measure
    sand.stress_measure = comminute::StressMeasure(comminute::StressKind::energy, 0.2);
    return sand;
}

/// Grains of all points: what they are made of, and how far each has been crushed.
class Grains {
  public:
    Grains(const comminute::Material& material, const std::vector<mpm::Point>& points)
        : scale_(material.stress_scale()),
          grid_(comminute::fitting_grid(start_, material, most, comminute::GridOptions{{}, 64})),
          table_(comminute::QuasiStatic(grid_, material), comminute::mixed_fabric(start_, grid_), most),
          layer_(layer_of(points)),
          states_(material, comminute::mixed_fabric(start_, grid_),
                  static_cast<comminute::Index>(layer_.size())),
          largest_(points.size(), 0.0),
          loads_(layer_.size(), 0.0),
          remix_(layer_.size(), 0) {}

    /// Takes in the stresses of a step.
    void feel(const std::vector<mpm::Point>& points) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            largest_[i] = std::max(largest_[i], stress_ratio(points[i].stress));
        }
        for (std::size_t k = 0; k < layer_.size(); ++k) {
            loads_[k] = std::max(loads_[k], stress_ratio(points[layer_[k]].stress));
        }
    }

    /// Takes the layer to the largest loads since the last call.
    void crush() {
        if (!states_.update({loads_, remix_})) {
            for (comminute::Index k = 0; k < states_.count(); ++k) {
                if (states_.status()[static_cast<std::size_t>(k)] != comminute::PointStatus::done)
                    throw std::runtime_error(states_.message(k));
            }
        }
        for (const double crushed : states_.crushed()) crushed_ += crushed;
        std::fill(loads_.begin(), loads_.end(), 0.0);
        std::fill(remix_.begin(), remix_.end(), static_cast<unsigned char>(0));
    }

    /// Has the layer mixed anew before its next load.
    void rearrange() { std::fill(remix_.begin(), remix_.end(), static_cast<unsigned char>(1)); }

    /// D50 of each point by the table, as if nothing were ever rearranged [mm].
    std::vector<double> undisturbed() const {
        std::vector<double> d50;
        for (const double load : largest_) d50.push_back(table_.percentile(50.0, load).value);
        return d50;
    }
    /// D50 of the points of the layer by their states [mm].
    std::vector<double> of_layer() const {
        std::vector<double> d50, masses(static_cast<std::size_t>(grid_.bins()));
        for (comminute::Index k = 0; k < states_.count(); ++k) {
            states_.grading(k, masses);
            for (std::size_t i = 1; i < masses.size(); ++i) masses[i] += masses[i - 1];
            d50.push_back(comminute::percentile(grid_, masses, 50.0));
        }
        return d50;
    }

    const std::vector<std::size_t>& layer() const { return layer_; }
    const std::vector<double>& largest() const { return largest_; }
    /// Mass crushed so far in a point of the layer, on average; a grain that crushes twice counts twice.
    double crushed() const { return crushed_ / static_cast<double>(layer_.size()); }
    std::size_t memory() const { return table_.memory() + states_.memory() + 8 * largest_.size(); }

  private:
    static constexpr double most = 100.0;  // stress ratio that no point reaches

    static std::vector<std::size_t> layer_of(const std::vector<mpm::Point>& points) {
        std::vector<std::size_t> layer;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (points[i].at[1] > bottom && points[i].at[1] < top) layer.push_back(i);
        }
        return layer;
    }
    double stress_ratio(const mpm::Stress& s) const {
        const double sigma[6] = {s.xx, s.yy, s.zz, 0.0, 0.0, s.xy};
        return scale_.stress_ratio(sigma, comminute::StressSign::compression_negative);
    }

    comminute::Grading start_ = comminute::power_law(2.5, 0.2, 2.0);  // mm
    comminute::StressScale scale_;
    comminute::LogGrid grid_;
    comminute::ResponseTable table_;
    std::vector<std::size_t> layer_;
    comminute::MaterialPoints states_;
    std::vector<double> largest_, loads_;
    std::vector<unsigned char> remix_;
    double crushed_ = 0.0;
};

/// One list of numbers in a file of VTK.
void write_array(std::ofstream& file, const char* name, int components, const std::vector<double>& values) {
    file << "<DataArray type=\"Float64\" Name=\"" << name << "\" NumberOfComponents=\"" << components
         << "\" format=\"ascii\">\n";
    for (const double value : values) file << value << '\n';
    file << "</DataArray>\n";
}

/// Points with their fields, as an unstructured grid of vertices.
void write_points(const std::string& path, const mpm::Column& column, const Grains& grains) {
    const auto& points = column.points();
    std::vector<double> at, velocity, vertical, layer(points.size(), 0.0);
    for (const mpm::Point& point : points) {
        at.insert(at.end(), {point.at[0], point.at[1], 0.0});
        velocity.insert(velocity.end(), {point.velocity[0], point.velocity[1], 0.0});
        vertical.push_back(-point.stress.yy);
    }
    const std::vector<double> undisturbed = grains.undisturbed(), states = grains.of_layer();
    std::vector<double> d50 = undisturbed;
    for (std::size_t k = 0; k < states.size(); ++k) {
        d50[grains.layer()[k]] = states[k];
        layer[grains.layer()[k]] = 1.0;
    }
    std::ofstream file(path);
    file.precision(9);
    file << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
            "byte_order=\"LittleEndian\">\n"
         << "<UnstructuredGrid><Piece NumberOfPoints=\"" << points.size() << "\" NumberOfCells=\""
         << points.size() << "\">\n<Points>\n";
    write_array(file, "at_m", 3, at);
    file << "</Points>\n<Cells>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n";
    for (std::size_t i = 0; i < points.size(); ++i) file << i << '\n';
    file << "</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n";
    for (std::size_t i = 1; i <= points.size(); ++i) file << i << '\n';
    file << "</DataArray>\n<DataArray type=\"Int64\" Name=\"types\" format=\"ascii\">\n";
    for (std::size_t i = 0; i < points.size(); ++i) file << "1\n";  // a vertex
    file << "</DataArray>\n</Cells>\n<PointData>\n";
    write_array(file, "velocity_m_s", 3, velocity);
    write_array(file, "vertical_stress_MPa", 1, vertical);
    write_array(file, "largest_stress_ratio", 1, grains.largest());
    write_array(file, "D50_mm", 1, d50);
    write_array(file, "D50_undisturbed_mm", 1, undisturbed);
    write_array(file, "in_layer", 1, layer);
    file << "</PointData>\n</Piece></UnstructuredGrid></VTKFile>\n";
}

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

void run(const std::string& out, int cycles) {
    mpm::Column column{mpm::Settings{}};
    Grains grains(sand_material(), column.points());

    // A wave crosses the column thirty times a cycle, so that the column is near equilibrium all the time.
    const double period = 30.0 * column.crossing();
    const int steps_a_cycle = static_cast<int>(std::ceil(period / column.time_step()));
    const double flat = strip - taper / 2.0;
    std::ofstream history(out + "/history.csv"), collection(out + "/column.pvd");
    history << "time_s,cycle,pressure_MPa,applied_MN_m,reaction_MN_m,settlement_mm,layer_D50_mm,undisturbed_"
               "D50_mm,"
               "layer_crushed\n";
    collection << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\"><Collection>\n";
    for (int cycle = 1; cycle <= cycles; ++cycle) {
        if (cycle > 1) grains.rearrange();
        for (int step = 1; step <= steps_a_cycle; ++step) {
            const double phase = static_cast<double>(step) / steps_a_cycle;
            const double pressure = 0.5 * peak * (1.0 - std::cos(2.0 * 3.141592653589793 * phase));
            double applied = 0.0;
            const auto on_surface = [&](double x) {
                return pressure * std::clamp((flat + taper - x) / taper, 0.0, 1.0);
            };
            column.step(on_surface);
            grains.feel(column.points());
            if (step % steps_a_look != 0 && step != steps_a_cycle) continue;
            grains.crush();
            double settlement = 0.0;
            for (const mpm::Point& point : column.points()) {
                applied += point.surface * on_surface(point.at[0]);
                if (point.surface > 0.0 && settlement == 0.0) settlement = column.height() - point.at[1];
            }
            std::vector<double> undisturbed, all = grains.undisturbed();
            for (const std::size_t i : grains.layer()) undisturbed.push_back(all[i]);
            history << (cycle - 1 + phase) * period << ',' << cycle << ',' << pressure << ',' << applied
                    << ',' << column.reaction() << ',' << 1000.0 * settlement << ','
                    << mean(grains.of_layer()) << ',' << mean(undisturbed) << ',' << grains.crushed() << '\n';
        }
        const std::string name = "column-" + std::to_string(cycle) + ".vtu";
        write_points(out + "/" + name, column, grains);
        collection << "<DataSet timestep=\"" << cycle << "\" file=\"" << name << "\"/>\n";
    }
    collection << "</Collection></VTKFile>\n";
    std::printf("%zu points, %zu of them with states, %d cycles of %d steps; grains take %.1f MB\n",
                column.points().size(), grains.layer().size(), cycles, steps_a_cycle,
                1e-6 * static_cast<double>(grains.memory()));
}

}  // namespace

int main(int count, char** given) {
    const int cycles = count == 3 ? std::atoi(given[2]) : 3;
    if (count < 2 || count > 3 || cycles < 1) {
        std::fprintf(stderr, "usage: mpm_column OUT [CYCLES]\n");
        return 2;
    }
    try {
        run(given[1], cycles);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "mpm_column: %s\n", error.what());
        return 1;
    }
    return 0;
}
