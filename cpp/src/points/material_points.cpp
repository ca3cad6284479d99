// SPDX-License-Identifier: BSD-3-Clause
// Material points as their hosts see them (docs/guides/material_points.md).
#include "comminute/material_points.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/check.hpp"
#include "points/point_data.hpp"

namespace comminute {

using namespace detail;

MaterialPoints::MaterialPoints(const Material& material, const Fabric& start, Index count,
                               const MaterialPointsOptions& options)
    : data_(std::make_unique<Data>(material, start, count, options)) {}
MaterialPoints::MaterialPoints(std::unique_ptr<Data> data) : data_(std::move(data)) {}
MaterialPoints::~MaterialPoints() = default;
MaterialPoints::MaterialPoints(const MaterialPoints& other) : data_(std::make_unique<Data>(*other.data_)) {}
MaterialPoints& MaterialPoints::operator=(const MaterialPoints& other) {
    data_ = std::make_unique<Data>(*other.data_);
    return *this;
}
MaterialPoints::MaterialPoints(MaterialPoints&&) noexcept = default;
MaterialPoints& MaterialPoints::operator=(MaterialPoints&&) noexcept = default;

Index MaterialPoints::count() const {
    return data_->begin.size();
}
const LogGrid& MaterialPoints::grid() const {
    return data_->grid;
}
const Material& MaterialPoints::material() const {
    return data_->material;
}
const MaterialPointsOptions& MaterialPoints::options() const {
    return data_->options;
}

bool MaterialPoints::trial(const PointLoads& loads, Index threads) {
    return data_->step(loads, threads, false);
}
void MaterialPoints::commit() {
    data_->commit();
}
void MaterialPoints::discard() {
    data_->discard();
}
bool MaterialPoints::update(const PointLoads& loads, Index threads) {
    const bool all = data_->step(loads, threads, true);
    data_->commit();
    return all;
}

VectorView<const PointStatus> MaterialPoints::status() const {
    return {data_->status.data(), count()};
}

std::string MaterialPoints::message(Index i) const {
    data_->require_point(i);
    const auto found = data_->faults.find(i);
    if (found == data_->faults.end()) return {};
    std::string words = ParameterError(found->second).what();
    words.resize(std::min(words.size(), static_cast<std::size_t>(message_size - 1)));
    return words;
}

void MaterialPoints::message(Index i, char* to) const {
    const std::string words = message(i);
    std::copy(words.begin(), words.end(), to);
    to[words.size()] = '\0';
}

VectorView<const double> MaterialPoints::settled_at() const {
    return {data_->settled_at.data(), count()};
}
VectorView<const double> MaterialPoints::end_settled_at() const {
    return {data_->end_settled_at.data(), count()};
}
VectorView<const double> MaterialPoints::crushed() const {
    return {data_->crushed.data(), count()};
}

void MaterialPoints::grading(Index i, VectorView<double> grainsize) const {
    data_->require_point(i);
    require_bins(grainsize.size(), grid().bins(), entry("grainsize"));
    data_->read_grading(data_->begin[i], grainsize);
}
void MaterialPoints::end_grading(Index i, VectorView<double> grainsize) const {
    data_->require_point(i);
    require_bins(grainsize.size(), grid().bins(), entry("grainsize"));
    data_->read_grading(data_->end[i], grainsize);
}
double MaterialPoints::largest(Index i) const {
    data_->require_point(i);
    return data_->begin[i].largest;
}
Fabric MaterialPoints::fabric(Index i) const {
    data_->require_point(i);
    return data_->fabric(i);
}
bool MaterialPoints::shares_start(Index i) const {
    data_->require_point(i);
    return data_->begin[i].block == shared;
}

void MaterialPoints::merge(Index i, Index j, double mass_i, double mass_j, MergedLoad load) {
    data_->require_point(i);
    data_->require_point(j);
    require(i != j, "j", static_cast<double>(j), "another point than i");
    const auto require_mass = [](double mass, const char* name) {
        require(mass >= 0.0 && std::isfinite(mass), name, mass, "a finite mass of at least 0");
    };
    require_mass(mass_i, "mass_i");
    require_mass(mass_j, "mass_j");
    require(mass_i + mass_j > 0.0 && std::isfinite(mass_i + mass_j), "mass_i + mass_j", mass_i + mass_j,
            "greater than 0 and finite");
    data_->discard();
    const Index size = data_->store.size();
    const double share = mass_j / (mass_i + mass_j);
    Array<double> one(size);
    Array<double> other(size);
    PointState merged = data_->begin[i];
    const PointState& second = data_->begin[j];
    data_->read(merged, one.data());
    data_->read(second, other.data());
    Line mixed(one.data(), size);
    mixed = (1.0 - share) * mixed + share * ConstLine(other.data(), size);
    const bool known = merged.largest > 0.0 && second.largest > 0.0;
    merged.largest = known ? std::max(merged.largest, second.largest) : 0.0;
    merged.settled_at = load == MergedLoad::never ? 0.0 : std::min(merged.settled_at, second.settled_at);
    if (!data_->keeps_states()) {
        std::copy_n(one.begin() + grid().bins(), grid().bins(), one.begin());
        merged.settled_at = merged.crushed = 0.0;
        merged.mixed = true;
    }
    data_->replace(i, one.data(), merged);
}

void MaterialPoints::assign(Index i, const MaterialPoints& from, Index j) {
    data_->require_point(i);
    from.data_->require_point(j);
    unpack_point(i, from.pack_point(j));
}

std::size_t MaterialPoints::memory() const {
    const auto start = static_cast<std::size_t>(data_->start.size()) * sizeof(double);
    const auto known = static_cast<std::size_t>(count()) * (2 * sizeof(PointState) + 3 * sizeof(double) + 1);
    return data_->store.memory() + start + known;
}

}  // namespace comminute
