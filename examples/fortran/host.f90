! SPDX-License-Identifier: BSD-3-Clause
! A host in Fortran: loads a sieved sand in cycles, mixes it before the fourth load, and prints its gradings exactly.
program host
  use comminute
  implicit none
  integer(c_int64_t), parameter :: bins = 64
  real(c_double), parameter :: loads(5) = [50.0d0, 5.0d0, 50.0d0, 20.0d0, 60.0d0]
  character(kind=c_char) :: message(comminute_message_size)
  type(comminute_material_options) :: of_material
  type(comminute_points_options) :: of_points
  type(comminute_grid) :: grid
  type(comminute_loads) :: step
  type(c_ptr) :: material, start, points
  real(c_double), target :: load(1)
  integer(c_signed_char), target :: remix(1)
  real(c_double) :: masses(bins)
  integer :: k, i

  call comminute_material_defaults(of_material)
  of_material%reference_size = 2.0d0
  call check(comminute_material_create(of_material, material, message, comminute_message_size), message)
  call check(comminute_grading_sieves([2.0d0, 1.0d0, 0.5d0, 0.25d0], [100.0d0, 70.0d0, 20.0d0, 0.0d0], 4_c_int64_t, &
                                      start, message, comminute_message_size), message)
  call check(comminute_grid_fitting(start, material, 100.0d0, bins, grid, message, comminute_message_size), message)
  call comminute_points_defaults(of_points)
  of_points%keeps = comminute_gradings
  call check(comminute_points_create(material, start, grid, 1_c_int64_t, of_points, points, message, &
                                     comminute_message_size), message)
  do k = 1, 5
    load(1) = loads(k)
    remix(1) = merge(1_c_signed_char, 0_c_signed_char, k == 4)
    step = comminute_loads(c_sizeof(step), 1_c_int64_t, c_loc(load), c_loc(remix), c_null_ptr)
    call check(comminute_points_update(points, step, 1_c_int64_t, message, comminute_message_size), message)
    call check(comminute_points_grading(points, 0_c_int64_t, 0, masses, bins, message, comminute_message_size), message)
    do i = 1, int(bins)
      write (*, '(z16.16)') masses(i)
    end do
  end do
  call comminute_points_destroy(points)
  call comminute_grading_destroy(start)
  call comminute_material_destroy(material)
end program
