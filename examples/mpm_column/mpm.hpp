// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

/// A column of soil in plane strain between smooth walls, loaded at its surface: the explicit material point method with
/// affine velocities and quadratic splines (Hu et al. 2018, ACM Trans. Graph. 37, 150). It knows nothing of grains.
namespace mpm {

using Vector = std::array<double, 2>;

/// Settings in m, s and MPa, so that a force on a metre's thickness is in MN and a density in 10^6 kg/m3.
struct Settings {
    int cells_wide = 25, cells_high = 25;
    int points_a_cell_side = 4;
    double cell = 0.02;
    double density = 1.7e-3;
    double young = 1500.0, poisson = 0.2;  ///< of a stiff elastic soil
    double courant = 0.4;
};

/// Stress in MPa, positive in tension.
struct Stress {
    double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0;
};

/// One material point.
struct Point {
    Vector at, velocity{0.0, 0.0};
    std::array<double, 4> affine{0.0, 0.0, 0.0, 0.0};  ///< velocity gradient, by rows
    Stress stress;
    double volume, mass;
    double surface = 0.0;  ///< width of the surface that loads this point, 0 below the top row
};

/// The column: points and the grid on which they move.
class Column {
  public:
    explicit Column(const Settings& settings)
        : settings_(settings),
          wide_(settings.cells_wide + 2 * pad + 1),
          high_(settings.cells_high + 2 * pad + 1) {
        const int side = settings.points_a_cell_side;
        const double spacing = settings.cell / side;
        const int rows = settings.cells_high * side, columns = settings.cells_wide * side;
        for (int row = 0; row < rows; ++row) {
            for (int column = 0; column < columns; ++column) {
                Point point;
                point.at = {(column + 0.5) * spacing, (row + 0.5) * spacing};
                point.volume = spacing * spacing;
                point.mass = point.volume * settings.density;
                if (row == rows - 1) point.surface = spacing;
                points_.push_back(point);
            }
        }
        const std::size_t nodes = static_cast<std::size_t>(wide_) * static_cast<std::size_t>(high_);
        mass_.resize(nodes);
        momentum_.resize(nodes);
        lame_ =
            settings.young * settings.poisson / ((1.0 + settings.poisson) * (1.0 - 2.0 * settings.poisson));
        shear_ = settings.young / (2.0 * (1.0 + settings.poisson));
        wave_ = std::sqrt((lame_ + 2.0 * shear_) / settings.density);
        step_ = settings.courant * settings.cell / wave_;
        // The first mode of compression, of circular frequency pi c / (2 H), dies at .35 of critical damping.
        damping_ = 0.35 * 3.141592653589793 * wave_ / height();
    }

    const std::vector<Point>& points() const { return points_; }
    double time_step() const { return step_; }
    double height() const { return settings_.cells_high * settings_.cell; }
    double width() const { return settings_.cells_wide * settings_.cell; }
    /// Time that a wave takes through the column.
    double crossing() const { return height() / wave_; }
    /// Force on the floor in the last step.
    double reaction() const { return reaction_; }

    /// One explicit step.
    /// @param pressure  of the surface, by the place x
    template <class Pressure>
    void step(const Pressure& pressure) {
        to_grid(pressure);
        walls();
        from_grid();
    }

  private:
    static constexpr int pad = 3;  // nodes beyond each wall, so that no spline of a point needs a test

    std::size_t node(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(wide_) + static_cast<std::size_t>(i);
    }

    /// First node of a point's splines, their weights, and the place of the point from that node, in cells.
    struct Splines {
        int i, j;
        std::array<double, 3> x, y;
        Vector from;
    };
    Splines splines(const Vector& at) const {
        const double u = at[0] / settings_.cell + pad, v = at[1] / settings_.cell + pad;
        const int i = static_cast<int>(u - 0.5), j = static_cast<int>(v - 0.5);
        const auto weights = [](double d) {  // d in [0.5, 1.5)
            return std::array<double, 3>{0.5 * (1.5 - d) * (1.5 - d), 0.75 - (d - 1.0) * (d - 1.0),
                                         0.5 * (d - 0.5) * (d - 0.5)};
        };
        return {i, j, weights(u - i), weights(v - j), {u - i, v - j}};
    }

    template <class Pressure>
    void to_grid(const Pressure& pressure) {
        mass_.assign(mass_.size(), 0.0);
        momentum_.assign(momentum_.size(), Vector{0.0, 0.0});
        const double h = settings_.cell;
        for (const Point& point : points_) {
            const Splines s = splines(point.at);
            const double push = step_ * 4.0 / (h * h) * point.volume;
            const double xx = point.mass * point.affine[0] - push * point.stress.xx;
            const double xy = point.mass * point.affine[1] - push * point.stress.xy;
            const double yx = point.mass * point.affine[2] - push * point.stress.xy;
            const double yy = point.mass * point.affine[3] - push * point.stress.yy;
            const double load = point.surface > 0.0 ? step_ * point.surface * pressure(point.at[0]) : 0.0;
            for (int b = 0; b < 3; ++b) {
                const double dy = (b - s.from[1]) * h;
                for (int a = 0; a < 3; ++a) {
                    const double w = s.x[static_cast<std::size_t>(a)] * s.y[static_cast<std::size_t>(b)];
                    const double dx = (a - s.from[0]) * h;
                    const std::size_t n = node(s.i + a, s.j + b);
                    mass_[n] += w * point.mass;
                    momentum_[n][0] += w * (point.mass * point.velocity[0] + xx * dx + xy * dy);
                    momentum_[n][1] += w * (point.mass * point.velocity[1] + yx * dx + yy * dy - load);
                }
            }
        }
    }

    /// Smooth walls as mirrors: what lies beyond one is folded back, and moves as its image does.
    void walls() {
        reaction_ = 0.0;
        const int right = pad + settings_.cells_wide;
        for (int j = 0; j < high_; ++j) {
            for (const int wall : {pad, right}) {
                const std::size_t at = node(wall, j);
                const int inward = wall == pad ? 1 : -1;
                fold(node(wall - inward, j), node(wall + inward, j), 0);
                momentum_[at][0] = 0.0;
            }
        }
        for (int i = pad; i <= right; ++i) {
            // The image pushes on the floor as much as what it mirrors.
            reaction_ -= (momentum_[node(i, pad)][1] + 2.0 * momentum_[node(i, pad - 1)][1]) / step_;
            fold(node(i, pad - 1), node(i, pad + 1), 1);
            momentum_[node(i, pad)][1] = 0.0;
        }
        for (std::size_t n = 0; n < mass_.size(); ++n) {
            if (mass_[n] <= 0.0) continue;
            for (double& component : momentum_[n]) component *= (1.0 - damping_ * step_) / mass_[n];
        }
        for (int i = pad; i <= right; ++i) mirror(node(i, pad + 1), node(i, pad - 1), 1);
        for (int j = pad - 1; j < high_; ++j) {
            mirror(node(pad + 1, j), node(pad - 1, j), 0);
            mirror(node(right - 1, j), node(right + 1, j), 0);
        }
    }
    void fold(std::size_t beyond, std::size_t image, std::size_t normal) {
        mass_[image] += mass_[beyond];
        momentum_[image][normal] -= momentum_[beyond][normal];
        momentum_[image][1 - normal] += momentum_[beyond][1 - normal];
    }
    void mirror(std::size_t image, std::size_t beyond, std::size_t normal) {
        momentum_[beyond] = momentum_[image];
        momentum_[beyond][normal] = -momentum_[beyond][normal];
    }

    void from_grid() {
        const double h = settings_.cell;
        for (Point& point : points_) {
            const Splines s = splines(point.at);
            Vector velocity{0.0, 0.0};
            std::array<double, 4> affine{0.0, 0.0, 0.0, 0.0};
            for (int b = 0; b < 3; ++b) {
                const double dy = b - s.from[1];
                for (int a = 0; a < 3; ++a) {
                    const double w = s.x[static_cast<std::size_t>(a)] * s.y[static_cast<std::size_t>(b)];
                    const double dx = a - s.from[0];
                    const Vector& v = momentum_[node(s.i + a, s.j + b)];  // velocities by now
                    velocity[0] += w * v[0];
                    velocity[1] += w * v[1];
                    affine[0] += w * v[0] * dx;
                    affine[1] += w * v[0] * dy;
                    affine[2] += w * v[1] * dx;
                    affine[3] += w * v[1] * dy;
                }
            }
            for (double& gradient : affine) gradient *= 4.0 / h;
            point.velocity = velocity;
            point.affine = affine;
            point.at[0] += step_ * velocity[0];
            point.at[1] += step_ * velocity[1];
            strain(point);
        }
    }

    /// Linear elasticity in rate form, turned with the material (Jaumann).
    void strain(Point& point) const {
        const double xx = point.affine[0], yy = point.affine[3];
        const double xy = 0.5 * (point.affine[1] + point.affine[2]);
        const double spin = 0.5 * (point.affine[1] - point.affine[2]);
        const double volume = xx + yy;
        Stress& s = point.stress;
        const Stress old = s;
        s.xx += step_ * (lame_ * volume + 2.0 * shear_ * xx + 2.0 * spin * old.xy);
        s.yy += step_ * (lame_ * volume + 2.0 * shear_ * yy - 2.0 * spin * old.xy);
        s.zz += step_ * lame_ * volume;
        s.xy += step_ * (2.0 * shear_ * xy + spin * (old.yy - old.xx));
        point.volume *= 1.0 + step_ * volume;
    }

    Settings settings_;
    int wide_, high_;
    std::vector<Point> points_;
    std::vector<double> mass_;
    std::vector<Vector> momentum_;  // velocities between walls() and from_grid()
    double lame_, shear_, wave_, step_, damping_, reaction_ = 0.0;
};

}  // namespace mpm
