// SPDX-License-Identifier: BSD-3-Clause
// Material points as bytes (docs/guides/material_points.md).
#include <algorithm>
#include <optional>
#include <utility>
#include <variant>

#include "points/bytes.hpp"
#include "points/point_data.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr ByteKind all_points{{'c', 'm', 'p', 'o', 'i', 'n', 't', 's'}, 1, "set of material points"};
constexpr ByteKind one_point{{'c', 'm', 'p', 'o', 'i', 'n', 't', '1'}, 1, "material point"};

void write(ByteWriter& out, std::optional<double> value) {
    out.number(value ? 1 : 0);
    out.real(value.value_or(0.0));
}
std::optional<double> read_optional(ByteReader& in) {
    const bool there = in.number() != 0;
    const double value = in.real();
    return there ? std::optional(value) : std::nullopt;
}

void write(ByteWriter& out, const std::vector<double>& values) {
    out.number(values.size());
    out.reals(values);
}

void write(ByteWriter& out, const FragmentLaw& law) {
    out.number(law.index());
    if (const auto* weibull = std::get_if<WeibullFragments>(&law)) {
        out.reals({weibull->scale, weibull->shape});
    } else if (const auto* power = std::get_if<PowerLawFragments>(&law)) {
        out.real(power->exponent);
    } else if (const auto* normal = std::get_if<LogNormalFragments>(&law)) {
        out.reals({normal->mean_log, normal->sd_log});
    } else {
        const auto& table = std::get<TabulatedFragments>(law);
        write(out, table.x);
        write(out, table.finer);
    }
}

FragmentLaw read_law(ByteReader& in) {
    switch (in.number()) {
        case 0: {
            const std::vector<double> values = in.reals(2);
            return WeibullFragments{values[0], values[1]};
        }
        case 1:
            return PowerLawFragments{in.real()};
        case 2: {
            const std::vector<double> values = in.reals(2);
            return LogNormalFragments{values[0], values[1]};
        }
        case 3: {
            std::vector<double> x = in.reals(in.size());
            std::vector<double> finer = in.reals(in.size());
            return TabulatedFragments{std::move(x), std::move(finer)};
        }
        default:
            in.refuse("are damaged");
    }
}

void write(ByteWriter& out, const Material& material) {
    out.reals({material.weibull_modulus, material.fabric_width, material.reference_size});
    write(out, material.fragments);
    write(out, material.first_crush_stress);
    out.number(material.stress_measure ? 1 + static_cast<std::uint64_t>(material.stress_measure->kind()) : 0);
    write(out, material.stress_measure ? material.stress_measure->poisson() : std::nullopt);
    write(out, material.k0);
}

Material read_material(ByteReader& in) {
    Material material;
    material.weibull_modulus = in.real();
    material.fabric_width = in.real();
    material.reference_size = in.real();
    material.fragments = read_law(in);
    material.first_crush_stress = read_optional(in);
    const std::uint64_t kind = in.number();
    const std::optional<double> poisson = read_optional(in);
    if (kind > 1 + static_cast<std::uint64_t>(StressKind::energy)) in.refuse("are damaged");
    if (kind > 0) material.stress_measure = StressMeasure(static_cast<StressKind>(kind - 1), poisson);
    material.k0 = read_optional(in);
    return material;
}

void write(ByteWriter& out, const MaterialPointsOptions& options, Mean mean) {
    out.number(static_cast<std::uint64_t>(options.numbers));
    out.number(static_cast<std::uint64_t>(options.contents));
    out.number(static_cast<std::uint64_t>(options.scheme));
    out.number(static_cast<std::uint64_t>(mean));
}

template <class Choice>
Choice read_choice(ByteReader& in, Choice last) {
    const std::uint64_t value = in.number();
    if (value > static_cast<std::uint64_t>(last)) in.refuse("are damaged");
    return static_cast<Choice>(value);
}

MaterialPointsOptions read_options(ByteReader& in) {
    const auto numbers = read_choice(in, PointNumbers::float32);
    const auto contents = read_choice(in, PointContents::gradings);
    return {numbers, contents, read_choice(in, Scheme::paper)};
}

void write(ByteWriter& out, const PointData& points, const PointState& state) {
    out.number((state.block == shared ? 0 : 1) + (state.mixed ? 2 : 0));
    out.reals({state.settled_at, state.loading_rate, state.largest, state.crushed});
    if (state.block == shared) return;
    if (const double* const numbers = points.store.doubles(state.block)) {
        for (Index k = 0; k < points.store.size(); ++k) out.real(numbers[k]);
    } else {
        for (Index k = 0; k < points.store.size(); ++k) out.single(points.store.singles(state.block)[k]);
    }
}

// Puts the state that write() wrote into point i.
void read(ByteReader& in, PointData& points, Index i) {
    const std::uint64_t flags = in.number();
    PointState state;
    state.settled_at = in.real();
    state.loading_rate = in.real();
    state.largest = in.real();
    state.crushed = in.real();
    state.mixed = (flags & 2U) != 0;
    if ((flags & 1U) == 0) {
        points.share_start(i, state);
        return;
    }
    Array<double> numbers(points.store.size());
    const bool wide = points.options.numbers == PointNumbers::float64;
    for (double& number : numbers) number = wide ? in.real() : static_cast<double>(in.single());
    points.replace(i, numbers.data(), state);
}

void write_start(ByteWriter& out, const PointData& points) {
    out.real(points.start_settled_at);
    out.real(points.start_largest);
    for (Index k = 0; k < points.grid.bins() * points.grid.bins(); ++k) out.real(points.start[k]);
    out.reals(points.start_rows.vector());
}

struct Start {
    double settled_at;
    double largest;
    std::vector<double> probability;
    std::vector<double> rows;
};

Start read_start(ByteReader& in, const LogGrid& grid) {
    const double settled_at = in.real();
    const double largest = in.real();
    const auto bins = static_cast<std::size_t>(grid.bins());
    std::vector<double> probability = in.reals(bins * bins);
    return {settled_at, largest, std::move(probability), in.reals(bins)};
}

std::uint64_t fingerprint_of_start(const PointData& points) {
    return fingerprint(points.start.data(), static_cast<std::size_t>(points.start.size()));
}

}  // namespace

std::vector<unsigned char> MaterialPoints::pack() const {
    ByteWriter out(all_points);
    write(out, material());
    out.grid(grid());
    write(out, options(), data_->mean);
    write_start(out, *data_);
    out.number(static_cast<std::uint64_t>(count()));
    for (const PointState& state : data_->begin) write(out, *data_, state);
    return out.sealed();
}

MaterialPoints MaterialPoints::unpack(VectorView<const unsigned char> bytes) {
    ByteReader in(all_points, bytes);
    const Material material = read_material(in);
    const LogGrid grid = in.grid();
    const MaterialPointsOptions options = read_options(in);
    const auto mean = read_choice(in, Mean::geometric);
    Start start = read_start(in, grid);
    const std::size_t count = in.size();
    const auto settled = start.settled_at > 0.0 ? std::optional(start.settled_at) : std::nullopt;
    const Fabric fabric(grid, std::move(start.probability), {}, settled, mean, {}, start.largest);
    auto data = std::make_unique<Data>(material, fabric, static_cast<Index>(count), options);
    data->start_rows = Array<double>(std::move(start.rows));  // as the solver had handed them on
    for (Index i = 0; i < data->begin.size(); ++i) read(in, *data, i);
    in.require_end();
    return MaterialPoints(std::move(data));
}

std::vector<unsigned char> MaterialPoints::pack_point(Index i) const {
    data_->require_point(i);
    ByteWriter out(one_point);
    out.grid(grid());
    write(out, options(), data_->mean);
    out.number(fingerprint_of_start(*data_));
    write(out, *data_, data_->begin[i]);
    return out.sealed();
}

void MaterialPoints::unpack_point(Index i, VectorView<const unsigned char> bytes) {
    data_->require_point(i);
    ByteReader in(one_point, bytes);
    if (in.grid() != grid()) in.refuse("hold a point on another grid");
    const MaterialPointsOptions found = read_options(in);
    if (!(found == options()) || read_choice(in, Mean::geometric) != data_->mean)
        in.refuse("hold a point with other options");
    if (in.number() != fingerprint_of_start(*data_)) in.refuse("hold a point with another start");
    read(in, *data_, i);
    in.require_end();
}

}  // namespace comminute
