// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Hot functions are compiled three times, for any x86-64, for one with AVX2 and FMA, and for one with AVX-512, and the
// machine's own version is taken. There are two ways to say so.
//
// COMMINUTE_MULTIVERSION before a function of plain loops leaves it to the compiler, and the choice to the loader. The
// sanitizers' start-up code does not get along with that.
//
// COMMINUTE_VERSIONS(result, name, (parameters), (arguments)) defines `name` from a template `name_by<Width>`, Width the
// number of doubles in a register: vectors wider than the machine's would be taken apart through memory, ten times slower.
// NOLINTBEGIN(bugprone-macro-parentheses): of a type
#if !defined(__x86_64__) || !defined(__gnu_linux__) || !defined(__GNUC__) || defined(__clang__)
#define COMMINUTE_MULTIVERSION
#define COMMINUTE_VERSIONS(Result, name, parameters, arguments) \
    Result name parameters {                                    \
        return name##_by<2> arguments;                          \
    }
#else
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define COMMINUTE_MULTIVERSION
#else
#define COMMINUTE_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif
#define COMMINUTE_VERSIONS(Result, name, parameters, arguments)             \
    namespace {                                                             \
    __attribute__((target("arch=x86-64-v4"))) Result name##_v4 parameters { \
        return name##_by<8> arguments;                                      \
    }                                                                       \
    __attribute__((target("arch=x86-64-v3"))) Result name##_v3 parameters { \
        return name##_by<4> arguments;                                      \
    }                                                                       \
    }                                                                       \
    Result name parameters {                                                \
        switch (comminute::detail::machine_vectors()) {                     \
            case 8:                                                         \
                return name##_v4 arguments;                                 \
            case 4:                                                         \
                return name##_v3 arguments;                                 \
            default:                                                        \
                return name##_by<2> arguments;                              \
        }                                                                   \
    }

namespace comminute::detail {
/// Doubles in the widest register of this machine that there is a version for, and that the build allows.
inline int machine_vectors() {
    static const int width = __builtin_cpu_supports("x86-64-v4") && COMMINUTE_WIDEST_VECTOR >= 8   ? 8
                             : __builtin_cpu_supports("x86-64-v3") && COMMINUTE_WIDEST_VECTOR >= 4 ? 4
                                                                                                   : 2;
    return width;
}
}  // namespace comminute::detail
#endif
// NOLINTEND(bugprone-macro-parentheses)

// For what a hot function is made of: a copy of it in each, and in each of its versions.
#define COMMINUTE_INLINE [[gnu::always_inline]] inline
#define COMMINUTE_INLINE_LAMBDA __attribute__((always_inline))

// Says of the next loop that its passes do not feed each other, through whatever pointers.
#if defined(__clang__)
#define COMMINUTE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define COMMINUTE_INDEPENDENT _Pragma("GCC ivdep")
#else
#define COMMINUTE_INDEPENDENT
#endif
