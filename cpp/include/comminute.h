/* SPDX-License-Identifier: BSD-3-Clause */
/* comminute for C, Fortran, and whatever calls C: materials, gradings, response tables and material points.
 *
 * Every function that can fail returns a code, 0 for success, and then writes why into a buffer of the caller's: at most
 * `message_size` characters with a final 0, nothing where `message` is null. A call that fails leaves everything as it was.
 * Structs begin with their size, by which later versions tell what an older caller knows; the functions named *_defaults set it.
 *
 * Handles are opaque. A material, a grading or a table never changes and may be used by many threads at once; points have one
 * caller at a time. Handles that were made of others do not need them any more. Arrays are the caller's; no function keeps a
 * pointer to one. After the first step of its kind, a step of points on one thread and a look-up in a table allocate nothing.
 *
 * Matrices are row after row. Tensors are six numbers, xx yy zz yz xz xy. Sizes are in the unit of the material's
 * reference_size, stresses in that of its first_crush_stress.
 */
#ifndef COMMINUTE_H
#define COMMINUTE_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32) && !defined(COMMINUTE_STATIC)
#if defined(comminute_EXPORTS)
#define COMMINUTE_C_API __declspec(dllexport)
#else
#define COMMINUTE_C_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define COMMINUTE_C_API __attribute__((visibility("default")))
#else
#define COMMINUTE_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Codes that functions return. */
enum {
    COMMINUTE_OK = 0,
    COMMINUTE_SOME_POINTS = 1,   /* some points are not done; the others are, and comminute_points_status says which */
    COMMINUTE_BAD_ARGUMENT = 2,  /* a value outside its range, a null pointer, or a struct of another size */
    COMMINUTE_BAD_SIZE = 3,      /* an array or a buffer of another length than is needed */
    COMMINUTE_NO_MEMORY = 4,
    COMMINUTE_FAILED = 5         /* anything else; the message says what */
};

/* Room for any message and its final 0. */
#define COMMINUTE_MESSAGE_SIZE 512

/* Version of the library, "major.minor.patch". */
COMMINUTE_C_API const char* comminute_version(void);

/* --- materials -------------------------------------------------------------------------------------------------- */

typedef struct comminute_material comminute_material;

enum { COMMINUTE_WEIBULL = 0, COMMINUTE_POWER_LAW = 1, COMMINUTE_LOGNORMAL = 2 }; /* laws of fragments */
enum {                                                                             /* measures of a stress */
    COMMINUTE_NO_MEASURE = 0,
    COMMINUTE_LARGEST = 1,
    COMMINUTE_MEAN = 2,
    COMMINUTE_OCTAHEDRAL = 3,
    COMMINUTE_ENERGY = 4
};

/* Strength, fabric and fragments of the grains. */
typedef struct comminute_material_options {
    size_t size;               /* of this struct */
    double weibull_modulus;    /* w > 0 */
    double fabric_width;       /* n > 0 */
    double reference_size;     /* s_max > 0 */
    int32_t fragments;         /* law of the fragments */
    double fragments_first;    /* scale of Weibull, exponent of a power law, mean log size of a lognormal law */
    double fragments_second;   /* shape of Weibull, standard deviation of a lognormal law */
    double first_crush_stress; /* > 0; 0 for none */
    int32_t stress_measure;    /* measure in which first_crush_stress is quoted */
    double poisson;            /* for COMMINUTE_ENERGY, in [0, 0.5); negative for none */
    double k0;                 /* of the oedometer in which it was found as a vertical stress; negative for none */
} comminute_material_options;

COMMINUTE_C_API void comminute_material_defaults(comminute_material_options* options);
COMMINUTE_C_API int comminute_material_create(const comminute_material_options* options, comminute_material** material,
                                              char* message, size_t message_size);
COMMINUTE_C_API void comminute_material_destroy(comminute_material* material);
/* Stress ratios of (count, 6) effective stress tensors. compression: 1 where it is positive, -1 where it is negative. */
COMMINUTE_C_API int comminute_material_stress_ratios(const comminute_material* material, const double* sigma, int64_t count,
                                                     int compression, double* stress_ratio, char* message,
                                                     size_t message_size);

/* --- gradings and grids ----------------------------------------------------------------------------------------- */

typedef struct comminute_grading comminute_grading;

COMMINUTE_C_API int comminute_grading_power_law(double fractal_dimension, double smallest, double largest,
                                                comminute_grading** grading, char* message, size_t message_size);
COMMINUTE_C_API int comminute_grading_lognormal(double median, double sd_log, double largest, comminute_grading** grading,
                                                char* message, size_t message_size);
COMMINUTE_C_API int comminute_grading_equal(double size, comminute_grading** grading, char* message, size_t message_size);
/* (count) sizes of sieves with the per cent of the mass that is finer than each, in any order. */
COMMINUTE_C_API int comminute_grading_sieves(const double* sizes, const double* percent_finer, int64_t count,
                                             comminute_grading** grading, char* message, size_t message_size);
COMMINUTE_C_API void comminute_grading_destroy(comminute_grading* grading);

/* Even bins in log size. */
typedef struct comminute_grid {
    size_t size;    /* of this struct */
    double psi_min; /* log size at the centre of the lowest bin, which holds all finer grains too */
    double psi_max; /* log size at the centre of the highest bin */
    int64_t bins;   /* N >= 8 */
} comminute_grid;

/* A grid that fits a grading up to a load. bins: wanted number, 0 for as many as the grading needs. */
COMMINUTE_C_API int comminute_grid_fitting(const comminute_grading* grading, const comminute_material* material,
                                           double max_stress_ratio, int64_t bins, comminute_grid* grid, char* message,
                                           size_t message_size);
/* (N) sizes at the upper edges of the bins. */
COMMINUTE_C_API int comminute_grid_edges(const comminute_grid* grid, double* sizes, int64_t count, char* message,
                                         size_t message_size);
/* Size such that `percent` of the mass is finer. masses: (N) by bin, as the points give them. */
COMMINUTE_C_API int comminute_grid_percentile(const comminute_grid* grid, const double* masses, int64_t count,
                                              double percent, double* size, char* message, size_t message_size);

/* --- response tables -------------------------------------------------------------------------------------------- */

typedef struct comminute_table comminute_table;

typedef struct comminute_table_options {
    size_t size;             /* of this struct */
    double max_stress_ratio; /* > 0 */
    double tolerance;        /* > 0, error of the mass finer than a size */
    double loading_rate;     /* in [0, 1] */
} comminute_table_options;

COMMINUTE_C_API void comminute_table_defaults(comminute_table_options* options);
/* The grading is mixed completely. */
COMMINUTE_C_API int comminute_table_create(const comminute_material* material, const comminute_grading* start,
                                           const comminute_grid* grid, const comminute_table_options* options,
                                           comminute_table** table, char* message, size_t message_size);
COMMINUTE_C_API int comminute_table_unpack(const unsigned char* bytes, size_t count, comminute_table** table,
                                           char* message, size_t message_size);
/* Bytes of a table, `needed` of them; with `bytes` null it says how many. */
COMMINUTE_C_API int comminute_table_pack(const comminute_table* table, unsigned char* bytes, size_t count, size_t* needed,
                                         char* message, size_t message_size);
COMMINUTE_C_API void comminute_table_destroy(comminute_table* table);

/* Look-ups under (count) largest loads so far. A load that the table does not know, or a size in the lowest bin, is NaN with
 * NaN, and the code is COMMINUTE_BAD_ARGUMENT; the other entries are right. derivative, by the stress ratio, may be null. */
COMMINUTE_C_API int comminute_table_percentile(const comminute_table* table, double percent, const double* stress_ratio,
                                               int64_t count, double* size, double* derivative, char* message,
                                               size_t message_size);
/* Mean number of crushes a cell has been through. */
COMMINUTE_C_API int comminute_table_crushes(const comminute_table* table, const double* stress_ratio, int64_t count,
                                            double* crushes, double* derivative, char* message, size_t message_size);
/* Mass finer than the upper edge of a bin, 0 <= bin < N. */
COMMINUTE_C_API int comminute_table_finer(const comminute_table* table, int64_t bin, const double* stress_ratio,
                                          int64_t count, double* finer, double* derivative, char* message,
                                          size_t message_size);

/* --- material points -------------------------------------------------------------------------------------------- */

typedef struct comminute_points comminute_points;

enum { COMMINUTE_FLOAT64 = 0, COMMINUTE_FLOAT32 = 1 }; /* numbers of the states */
enum { COMMINUTE_STATES = 0, COMMINUTE_GRADINGS = 1 }; /* what a point keeps */
enum { COMMINUTE_SMALLER = 0, COMMINUTE_NEVER = 1 };   /* settled load of a merged point */

typedef struct comminute_points_options {
    size_t size;     /* of this struct */
    int32_t numbers; /* COMMINUTE_FLOAT64 or COMMINUTE_FLOAT32 */
    int32_t keeps;   /* COMMINUTE_STATES or COMMINUTE_GRADINGS */
} comminute_points_options;

/* Loads of all points in one step. */
typedef struct comminute_loads {
    size_t size;                /* of this struct */
    int64_t count;              /* P */
    const double* stress_ratio; /* (P) >= 0 */
    const unsigned char* remix; /* (P) not 0: mixed anew before the load comes; null: none is */
    const double* loading_rate; /* (P) in [0, 1]; null: 0 for all */
} comminute_loads;

COMMINUTE_C_API void comminute_points_defaults(comminute_points_options* options);
COMMINUTE_C_API int comminute_points_create(const comminute_material* material, const comminute_grading* start,
                                            const comminute_grid* grid, int64_t count,
                                            const comminute_points_options* options, comminute_points** points,
                                            char* message, size_t message_size);
COMMINUTE_C_API int comminute_points_clone(const comminute_points* points, comminute_points** clone, char* message,
                                           size_t message_size);
COMMINUTE_C_API int comminute_points_unpack(const unsigned char* bytes, size_t count, comminute_points** points,
                                            char* message, size_t message_size);
/* Bytes of all begin states, `needed` of them; with `bytes` null it says how many. */
COMMINUTE_C_API int comminute_points_pack(const comminute_points* points, unsigned char* bytes, size_t count,
                                          size_t* needed, char* message, size_t message_size);
COMMINUTE_C_API void comminute_points_destroy(comminute_points* points);

/* P, and N. 0 of a null pointer. */
COMMINUTE_C_API int64_t comminute_points_count(const comminute_points* points);
COMMINUTE_C_API int64_t comminute_points_bins(const comminute_points* points);

/* End states from the begin states, which stay. threads >= 1. */
COMMINUTE_C_API int comminute_points_trial(comminute_points* points, const comminute_loads* loads, int64_t threads,
                                           char* message, size_t message_size);
/* The end states become the begin states, or are dropped. */
COMMINUTE_C_API int comminute_points_commit(comminute_points* points, char* message, size_t message_size);
COMMINUTE_C_API int comminute_points_discard(comminute_points* points, char* message, size_t message_size);
/* Both in one. */
COMMINUTE_C_API int comminute_points_update(comminute_points* points, const comminute_loads* loads, int64_t threads,
                                            char* message, size_t message_size);

/* (P) after a step: 0 done, 1 bad load, 2 bad loading rate, 3 changed loading rate; such a point keeps its begin state. */
COMMINUTE_C_API int comminute_points_status(const comminute_points* points, unsigned char* status, int64_t count,
                                            char* message, size_t message_size);
/* Message of one point into `words`, at most words_size characters with a final 0; empty where it is done. */
COMMINUTE_C_API int comminute_points_message(const comminute_points* points, int64_t point, char* words,
                                             size_t words_size, char* message, size_t message_size);
/* (P) load under which each state is at rest, of the begin states or, with end not 0, of the end states. */
COMMINUTE_C_API int comminute_points_settled_at(const comminute_points* points, int end, double* settled_at, int64_t count,
                                                char* message, size_t message_size);
/* (P) mass crushed in the last step. */
COMMINUTE_C_API int comminute_points_crushed(const comminute_points* points, double* crushed, int64_t count, char* message,
                                             size_t message_size);
/* (N) mass by bin of one point, of its begin state or, with end not 0, of its end state. */
COMMINUTE_C_API int comminute_points_grading(const comminute_points* points, int64_t point, int end, double* masses,
                                             int64_t count, char* message, size_t message_size);
/* Two points mixed by their masses into the first; settled: COMMINUTE_SMALLER or COMMINUTE_NEVER. */
COMMINUTE_C_API int comminute_points_merge(comminute_points* points, int64_t first, int64_t second, double mass_first,
                                           double mass_second, int settled, char* message, size_t message_size);

#ifdef __cplusplus
}
#endif

#endif
