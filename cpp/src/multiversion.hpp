// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Functions so marked are compiled three times, for any x86-64, for one with AVX2 and FMA, and for one with AVX-512, and
// the loader picks. The sanitizers' start-up code does not get along with that.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__x86_64__) || \
    !defined(__gnu_linux__) || !defined(__GNUC__) || defined(__clang__) || __GNUC__ < 12
#define COMMINUTE_MULTIVERSION
#else
#define COMMINUTE_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#endif

// For what a hot function is made of: a copy of it in each, and in each of its versions.
#define COMMINUTE_INLINE [[gnu::always_inline]] inline

// Says of the next loop that its passes do not feed each other, through whatever pointers.
#if defined(__clang__)
#define COMMINUTE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define COMMINUTE_INDEPENDENT _Pragma("GCC ivdep")
#else
#define COMMINUTE_INDEPENDENT
#endif
