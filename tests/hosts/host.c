/* SPDX-License-Identifier: BSD-3-Clause */
/* A host in C: loads a packing in cycles, mixes it, and prints the exact numbers; then every wrong call that it can think of. */
#include <comminute.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BINS 64

static char message[COMMINUTE_MESSAGE_SIZE];

static void check(int ok, const char* what) {
    if (ok) return;
    fprintf(stderr, "%s: %s\n", what, message);
    exit(1);
}

static void done(int code, const char* what) {
    check(code == COMMINUTE_OK && message[0] == '\0', what);
}

static void refused(int code, int wanted, const char* words) {
    if (code == wanted && strstr(message, words) != NULL) return;
    fprintf(stderr, "code %d, not %d: '%s', not '%s'\n", code, wanted, message, words);
    exit(1);
}

static comminute_material* sand(void) {
    comminute_material_options options;
    comminute_material* material = NULL;
    comminute_material_defaults(&options);
    options.reference_size = 2.0;
    options.first_crush_stress = 12.0;
    options.stress_measure = COMMINUTE_ENERGY;
    options.poisson = 0.2;
    options.k0 = 0.5;
    done(comminute_material_create(&options, &material, message, sizeof message), "material");
    return material;
}

static comminute_grading* sieved(void) {
    const double sizes[] = {2.0, 1.0, 0.5, 0.25}, finer[] = {100.0, 70.0, 20.0, 0.0};
    comminute_grading* grading = NULL;
    done(comminute_grading_sieves(sizes, finer, 4, &grading, message, sizeof message), "sieves");
    return grading;
}

static void print_exactly(const double* numbers, int count) {
    for (int i = 0; i < count; ++i) printf("%a\n", numbers[i]);
}

/* Cycles with a mixing after the third load. */
static void cycles(const comminute_material* material, const comminute_grading* start, const comminute_grid* grid) {
    const double loads[] = {50.0, 5.0, 50.0, 20.0, 60.0};
    double masses[BINS], size = 0.0, settled = 0.0;
    comminute_points_options options;
    comminute_points* points = NULL;
    comminute_points_defaults(&options);
    options.keeps = COMMINUTE_GRADINGS;
    done(comminute_points_create(material, start, grid, 1, &options, &points, message, sizeof message), "points");
    for (int k = 0; k < 5; ++k) {
        const unsigned char remix = k == 3;
        const comminute_loads step = {sizeof step, 1, &loads[k], &remix, NULL};
        done(comminute_points_update(points, &step, 1, message, sizeof message), "update");
        done(comminute_points_grading(points, 0, 0, masses, BINS, message, sizeof message), "grading");
        print_exactly(masses, BINS);
    }
    done(comminute_points_settled_at(points, 0, &settled, 1, message, sizeof message), "settled_at");
    done(comminute_grid_percentile(grid, masses, BINS, 50.0, &size, message, sizeof message), "percentile");
    check(settled == 60.0 && size > 0.25 && size < 1.0, "the last state");
    comminute_points_destroy(points);
}

static void tables(const comminute_material* material, const comminute_grading* start, const comminute_grid* grid) {
    const double loads[] = {0.5, 3.0, 60.0}, beyond[] = {1.0, 1e9, -1.0};
    double sizes[3], slopes[3], again[3];
    comminute_table_options options;
    comminute_table *table = NULL, *copy = NULL;
    unsigned char* bytes = NULL;
    size_t needed = 0;
    comminute_table_defaults(&options);
    options.max_stress_ratio = 100.0;
    done(comminute_table_create(material, start, grid, &options, &table, message, sizeof message), "table");
    done(comminute_table_percentile(table, 50.0, loads, 3, sizes, slopes, message, sizeof message), "look-up");
    check(sizes[0] > sizes[1] && sizes[1] > sizes[2] && slopes[0] == 0.0 && slopes[2] < 0.0, "sizes fall");
    done(comminute_table_pack(table, NULL, 0, &needed, message, sizeof message), "size of the bytes");
    bytes = malloc(needed);
    refused(comminute_table_pack(table, bytes, needed - 1, &needed, message, sizeof message), COMMINUTE_BAD_SIZE,
            "are needed");
    done(comminute_table_pack(table, bytes, needed, &needed, message, sizeof message), "bytes");
    done(comminute_table_unpack(bytes, needed, &copy, message, sizeof message), "table of bytes");
    done(comminute_table_percentile(copy, 50.0, loads, 3, again, NULL, message, sizeof message), "look-up in the copy");
    check(memcmp(sizes, again, sizeof sizes) == 0, "the copy is the table");
    bytes[needed / 2] ^= 1;
    comminute_table_destroy(copy);
    copy = NULL;
    refused(comminute_table_unpack(bytes, needed, &copy, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "damaged");
    check(copy == NULL, "nothing was made");
    refused(comminute_table_crushes(table, beyond, 3, again, NULL, message, sizeof message), COMMINUTE_BAD_ARGUMENT,
            "stress_ratio[1] is 1e+09; the table goes from 0 to 100");
    check(again[0] >= 0.0 && isnan(again[1]) && isnan(again[2]), "the good load was looked up");
    refused(comminute_table_percentile(table, 101.0, loads, 3, sizes, NULL, message, sizeof message),
            COMMINUTE_BAD_ARGUMENT, "percent is 101");
    refused(comminute_table_finer(table, BINS, loads, 3, sizes, NULL, message, sizeof message), COMMINUTE_BAD_ARGUMENT,
            "bin is 64");
    free(bytes);
    comminute_table_destroy(table);
}

static void wrong_calls(const comminute_material* material, const comminute_grading* start, const comminute_grid* grid) {
    double loads[] = {10.0, NAN}, masses[BINS], settled[2];
    unsigned char status[2];
    char words[COMMINUTE_MESSAGE_SIZE], few[8];
    comminute_points_options options;
    comminute_points* points = NULL;
    comminute_loads step = {sizeof step, 2, loads, NULL, NULL};
    comminute_grid other = *grid;
    comminute_material_options of_material;
    comminute_material* none = NULL;
    size_t needed = 0, again = 0;

    comminute_points_defaults(&options);
    done(comminute_points_create(material, start, grid, 2, &options, &points, message, sizeof message), "points");
    refused(comminute_points_update(points, &step, 1, message, sizeof message), COMMINUTE_SOME_POINTS,
            "stress_ratio[1] is nan");
    done(comminute_points_status(points, status, 2, message, sizeof message), "status");
    check(status[0] == 0 && status[1] == 1, "the first point is done");
    done(comminute_points_message(points, 1, words, sizeof words, message, sizeof message), "message");
    check(strstr(words, "stress_ratio[1] is nan") != NULL, "the point's message");
    done(comminute_points_message(points, 1, few, sizeof few, message, sizeof message), "short message");
    check(strcmp(few, "stress_") == 0, "as much of it as there is room for");
    done(comminute_points_settled_at(points, 0, settled, 2, message, sizeof message), "settled_at");
    check(settled[0] == 10.0 && settled[1] == 0.0, "a bad point keeps its state");
    done(comminute_points_pack(points, NULL, 0, &needed, message, sizeof message), "size of the bytes");

    loads[1] = 10.0;
    refused(comminute_points_update(NULL, &step, 1, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "points is null");
    refused(comminute_points_update(points, NULL, 1, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "loads is null");
    refused(comminute_points_update(points, &step, 0, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "threads is 0");
    step.count = 3;
    refused(comminute_points_update(points, &step, 1, message, sizeof message), COMMINUTE_BAD_SIZE, "stress_ratio");
    step.count = 2;
    step.size = 8;
    refused(comminute_points_update(points, &step, 1, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "size of the struct");
    step.size = sizeof step;
    step.stress_ratio = NULL;
    refused(comminute_points_trial(points, &step, 1, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "stress_ratio is null");
    step.stress_ratio = loads;
    refused(comminute_points_grading(points, 0, 0, masses, BINS - 1, message, sizeof message), COMMINUTE_BAD_SIZE,
            "has room for 63 numbers");
    refused(comminute_points_grading(points, 2, 0, masses, BINS, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "i is 2");
    refused(comminute_points_grading(points, 0, 0, NULL, BINS, message, sizeof message), COMMINUTE_BAD_ARGUMENT,
            "masses is null");
    refused(comminute_points_settled_at(points, 0, settled, 1, message, sizeof message), COMMINUTE_BAD_SIZE, "settled_at");
    refused(comminute_points_merge(points, 0, 0, 1.0, 1.0, COMMINUTE_SMALLER, message, sizeof message),
            COMMINUTE_BAD_ARGUMENT, "another point");
    refused(comminute_points_merge(points, 0, 1, 1.0, 1.0, 7, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "settled");
    done(comminute_points_pack(points, NULL, 0, &again, message, sizeof message), "size of the bytes");
    check(again == needed, "wrong calls change nothing");
    check(comminute_points_update(points, NULL, 1, NULL, 0) == COMMINUTE_BAD_ARGUMENT, "no buffer for the message");
    check(comminute_points_update(points, NULL, 1, few, sizeof few) == COMMINUTE_BAD_ARGUMENT && strcmp(few, "loads i") == 0,
          "a short buffer is filled and no more");
    check(comminute_points_count(NULL) == 0 && comminute_points_bins(points) == BINS, "counts");

    other.size = 0;
    refused(comminute_points_create(material, start, &other, 2, &options, &points, message, sizeof message),
            COMMINUTE_BAD_ARGUMENT, "size of the struct");
    other = *grid;
    other.bins = 3;
    refused(comminute_points_create(material, start, &other, 2, &options, &points, message, sizeof message),
            COMMINUTE_BAD_ARGUMENT, "bins is 3");
    comminute_material_defaults(&of_material);
    of_material.weibull_modulus = -1.0;
    refused(comminute_material_create(&of_material, &none, message, sizeof message), COMMINUTE_BAD_ARGUMENT,
            "weibull_modulus is -1");
    of_material.weibull_modulus = 3.0;
    of_material.fragments = 9;
    refused(comminute_material_create(&of_material, &none, message, sizeof message), COMMINUTE_BAD_ARGUMENT, "fragments is 9");
    check(none == NULL, "nothing was made");
    comminute_points_destroy(points);
    comminute_points_destroy(NULL);
}

int main(void) {
    const double tensor[] = {6.0, 6.0, 12.0, 0.0, 0.0, 0.0}, compressed[] = {-6.0, -6.0, -12.0, 0.0, 0.0, 0.0};
    double edges[BINS], ratio = 0.0, same = 0.0;
    comminute_material* material = sand();
    comminute_grading* start = sieved();
    comminute_grid grid;
    done(comminute_grid_fitting(start, material, 100.0, BINS, &grid, message, sizeof message), "grid");
    done(comminute_grid_edges(&grid, edges, BINS, message, sizeof message), "edges");
    check(fabs(edges[BINS - 1] - 2.0) < 1e-9, "the grid ends at the largest grain");
    done(comminute_material_stress_ratios(material, tensor, 1, 1, &ratio, message, sizeof message), "stress");
    done(comminute_material_stress_ratios(material, compressed, 1, -1, &same, message, sizeof message), "stress");
    check(fabs(ratio - 1.0) < 1e-12 && same == ratio, "first crush at K0 = 0.5");
    cycles(material, start, &grid);
    tables(material, start, &grid);
    wrong_calls(material, start, &grid);
    comminute_grading_destroy(start);
    comminute_material_destroy(material);
    return 0;
}
