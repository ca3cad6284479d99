"""A host by ctypes loads a packing in cycles as the host in C does, and prints the same numbers: give the library."""

import ctypes
import sys

BINS = 64


class Material(ctypes.Structure):
    """comminute_material_options."""

    _fields_ = [
        ("size", ctypes.c_size_t),
        ("weibull_modulus", ctypes.c_double),
        ("fabric_width", ctypes.c_double),
        ("reference_size", ctypes.c_double),
        ("fragments", ctypes.c_int32),
        ("fragments_first", ctypes.c_double),
        ("fragments_second", ctypes.c_double),
        ("first_crush_stress", ctypes.c_double),
        ("stress_measure", ctypes.c_int32),
        ("poisson", ctypes.c_double),
        ("k0", ctypes.c_double),
    ]


class Grid(ctypes.Structure):
    """comminute_grid."""

    _fields_ = [
        ("size", ctypes.c_size_t),
        ("psi_min", ctypes.c_double),
        ("psi_max", ctypes.c_double),
        ("bins", ctypes.c_int64),
    ]


class Options(ctypes.Structure):
    """comminute_points_options."""

    _fields_ = [("size", ctypes.c_size_t), ("numbers", ctypes.c_int32), ("keeps", ctypes.c_int32)]


class Loads(ctypes.Structure):
    """comminute_loads."""

    _fields_ = [
        ("size", ctypes.c_size_t),
        ("count", ctypes.c_int64),
        ("stress_ratio", ctypes.POINTER(ctypes.c_double)),
        ("remix", ctypes.POINTER(ctypes.c_ubyte)),
        ("loading_rate", ctypes.POINTER(ctypes.c_double)),
    ]


library = ctypes.CDLL(sys.argv[1])
message = ctypes.create_string_buffer(512)
buffer = (message, ctypes.c_size_t(len(message)))


def done(code: int) -> None:
    """Stop at an error."""
    if code != 0:
        raise SystemExit(message.value.decode())


def doubles(*numbers: float) -> ctypes.Array[ctypes.c_double]:
    """Make an array for the library."""
    return (ctypes.c_double * len(numbers))(*numbers)


chosen = Material()
library.comminute_material_defaults(ctypes.byref(chosen))
chosen.reference_size = 2.0
material, start, points = ctypes.c_void_p(), ctypes.c_void_p(), ctypes.c_void_p()
done(library.comminute_material_create(ctypes.byref(chosen), ctypes.byref(material), *buffer))
sizes, finer = doubles(2.0, 1.0, 0.5, 0.25), doubles(100.0, 70.0, 20.0, 0.0)
done(library.comminute_grading_sieves(sizes, finer, ctypes.c_int64(4), ctypes.byref(start), *buffer))
grid = Grid()
load = ctypes.c_double(100.0)
done(library.comminute_grid_fitting(start, material, load, ctypes.c_int64(BINS), ctypes.byref(grid), *buffer))
options = Options()
library.comminute_points_defaults(ctypes.byref(options))
options.keeps = 1
made = (material, start, ctypes.byref(grid), ctypes.c_int64(1), ctypes.byref(options), ctypes.byref(points))
done(library.comminute_points_create(*made, *buffer))
masses = doubles(*[0.0] * BINS)
for k, load_ratio in enumerate((50.0, 5.0, 50.0, 20.0, 60.0)):
    remix = (ctypes.c_ubyte * 1)(k == 3)
    step = Loads(ctypes.sizeof(Loads), 1, doubles(load_ratio), remix, None)
    done(library.comminute_points_update(points, ctypes.byref(step), ctypes.c_int64(1), *buffer))
    done(library.comminute_points_grading(points, ctypes.c_int64(0), 0, masses, ctypes.c_int64(BINS), *buffer))
    print(*[mass.hex() for mass in masses], sep="\n")
library.comminute_points_destroy(points)
library.comminute_grading_destroy(start)
library.comminute_material_destroy(material)
