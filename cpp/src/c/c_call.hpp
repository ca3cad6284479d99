// SPDX-License-Identifier: BSD-3-Clause
// Calls from C: exceptions become codes and messages, and what C hands over is looked at first.
#pragma once

#include <algorithm>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "comminute.h"
#include "comminute/error.hpp"
#include "comminute/grading.hpp"
#include "comminute/material.hpp"
#include "comminute/material_points.hpp"
#include "comminute/response_table.hpp"

struct comminute_material {
    comminute::Material material;
};
struct comminute_grading {
    comminute::Grading grading;
};
struct comminute_table {
    comminute::ResponseTable table;
};
struct comminute_points {
    comminute::MaterialPoints points;
};

namespace comminute::detail {

/// A buffer of the caller's for a message.
struct MessageBuffer {
    char* words;
    std::size_t size;

    int say(int code, const char* what) const noexcept {
        if (words == nullptr || size == 0) return code;
        const std::size_t length = std::min(std::strlen(what), size - 1);
        std::memcpy(words, what, length);
        words[length] = '\0';
        return code;
    }
};

/// Runs a call that returns a code; whatever it throws becomes one. Success empties the buffer.
template <class Call>
int guarded(MessageBuffer message, const Call& call) noexcept {
    try {
        const int code = call();
        return code == COMMINUTE_OK ? message.say(code, "") : code;
    } catch (const ParameterError& error) {
        return message.say(COMMINUTE_BAD_ARGUMENT, error.what());
    } catch (const ShapeError& error) {
        return message.say(COMMINUTE_BAD_SIZE, error.what());
    } catch (const std::bad_alloc&) {
        return message.say(COMMINUTE_NO_MEMORY, "there is not enough memory");
    } catch (const std::exception& error) {
        return message.say(COMMINUTE_FAILED, error.what());
    } catch (...) {
        return message.say(COMMINUTE_FAILED, "something was thrown that is no exception");
    }
}

/// Throws ParameterError for a null pointer.
template <class T>
T& known(T* pointer, const char* name) {
    if (pointer == nullptr)
        throw ParameterError({.parameter = name, .finding = "is null", .rule = "give a pointer to one"});
    return *pointer;
}

/// The same for a struct, whose size must be the one that this library knows.
template <class T>
const T& struct_of(const T* pointer, const char* name) {
    const T& given = known(pointer, name);
    require(given.size == sizeof(T), "size of the struct", static_cast<double>(given.size),
            "sizeof of it, as its *_defaults function sets it");
    return given;
}

/// Throws ShapeError unless an array has as many entries as it must.
inline void require_length(std::int64_t found, Index wanted, const char* name) {
    if (found == static_cast<std::int64_t>(wanted)) return;
    throw ShapeError({.parameter = name,
                      .value = std::to_string(found),
                      .number = static_cast<double>(found),
                      .finding = "has room for " + std::to_string(found) + " numbers",
                      .rule = "there are " + std::to_string(wanted)});
}

}  // namespace comminute::detail
