! SPDX-License-Identifier: BSD-3-Clause
! comminute for Fortran 2003: materials, gradings, response tables and material points, through the C interface.
!
! The functions are those of comminute.h, with the same names and arguments. `check` turns a code that is not 0 into an
! error stop with the library's message.
module comminute
  use, intrinsic :: iso_c_binding
  implicit none

  integer(c_int), parameter :: comminute_ok = 0, comminute_some_points = 1
  integer(c_int32_t), parameter :: comminute_states = 0, comminute_gradings = 1
  integer(c_size_t), parameter :: comminute_message_size = 512

  type, bind(c) :: comminute_material_options
    integer(c_size_t) :: size
    real(c_double) :: weibull_modulus, fabric_width, reference_size
    integer(c_int32_t) :: fragments
    real(c_double) :: fragments_first, fragments_second
    real(c_double) :: first_crush_stress
    integer(c_int32_t) :: stress_measure
    real(c_double) :: poisson, k0
  end type

  type, bind(c) :: comminute_grid
    integer(c_size_t) :: size
    real(c_double) :: psi_min, psi_max
    integer(c_int64_t) :: bins
  end type

  type, bind(c) :: comminute_table_options
    integer(c_size_t) :: size
    real(c_double) :: max_stress_ratio, tolerance, loading_rate
  end type

  type, bind(c) :: comminute_points_options
    integer(c_size_t) :: size
    integer(c_int32_t) :: numbers, keeps
  end type

  type, bind(c) :: comminute_loads
    integer(c_size_t) :: size
    integer(c_int64_t) :: count
    type(c_ptr) :: stress_ratio, remix, loading_rate
  end type

  interface
    subroutine comminute_material_defaults(options) bind(c)
      import
      type(comminute_material_options), intent(out) :: options
    end subroutine
    integer(c_int) function comminute_material_create(options, material, message, message_size) bind(c)
      import
      type(comminute_material_options), intent(in) :: options
      type(c_ptr), intent(out) :: material
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    subroutine comminute_material_destroy(material) bind(c)
      import
      type(c_ptr), value :: material
    end subroutine
    integer(c_int) function comminute_material_stress_ratios(material, sigma, count, compression, stress_ratio, &
                                                             message, message_size) bind(c)
      import
      type(c_ptr), value :: material
      real(c_double), intent(in) :: sigma(*)
      integer(c_int64_t), value :: count
      integer(c_int), value :: compression
      real(c_double), intent(out) :: stress_ratio(*)
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    integer(c_int) function comminute_grading_sieves(sizes, percent_finer, count, grading, message, message_size) &
        bind(c)
      import
      real(c_double), intent(in) :: sizes(*), percent_finer(*)
      integer(c_int64_t), value :: count
      type(c_ptr), intent(out) :: grading
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    subroutine comminute_grading_destroy(grading) bind(c)
      import
      type(c_ptr), value :: grading
    end subroutine
    integer(c_int) function comminute_grid_fitting(grading, material, max_stress_ratio, bins, grid, message, &
                                                   message_size) bind(c)
      import
      type(c_ptr), value :: grading, material
      real(c_double), value :: max_stress_ratio
      integer(c_int64_t), value :: bins
      type(comminute_grid), intent(out) :: grid
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    subroutine comminute_table_defaults(options) bind(c)
      import
      type(comminute_table_options), intent(out) :: options
    end subroutine
    integer(c_int) function comminute_table_create(material, start, grid, options, table, message, message_size) &
        bind(c)
      import
      type(c_ptr), value :: material, start
      type(comminute_grid), intent(in) :: grid
      type(comminute_table_options), intent(in) :: options
      type(c_ptr), intent(out) :: table
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    subroutine comminute_table_destroy(table) bind(c)
      import
      type(c_ptr), value :: table
    end subroutine
    integer(c_int) function comminute_table_percentile(table, percent, stress_ratio, count, size, derivative, &
                                                       message, message_size) bind(c)
      import
      type(c_ptr), value :: table
      real(c_double), value :: percent
      real(c_double), intent(in) :: stress_ratio(*)
      integer(c_int64_t), value :: count
      real(c_double), intent(out) :: size(*), derivative(*)
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    integer(c_int) function comminute_table_crushes(table, stress_ratio, count, crushes, derivative, message, &
                                                    message_size) bind(c)
      import
      type(c_ptr), value :: table
      real(c_double), intent(in) :: stress_ratio(*)
      integer(c_int64_t), value :: count
      real(c_double), intent(out) :: crushes(*), derivative(*)
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    subroutine comminute_points_defaults(options) bind(c)
      import
      type(comminute_points_options), intent(out) :: options
    end subroutine
    integer(c_int) function comminute_points_create(material, start, grid, count, options, points, message, &
                                                    message_size) bind(c)
      import
      type(c_ptr), value :: material, start
      type(comminute_grid), intent(in) :: grid
      integer(c_int64_t), value :: count
      type(comminute_points_options), intent(in) :: options
      type(c_ptr), intent(out) :: points
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    subroutine comminute_points_destroy(points) bind(c)
      import
      type(c_ptr), value :: points
    end subroutine
    integer(c_int) function comminute_points_update(points, loads, threads, message, message_size) bind(c)
      import
      type(c_ptr), value :: points
      type(comminute_loads), intent(in) :: loads
      integer(c_int64_t), value :: threads
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
    integer(c_int) function comminute_points_grading(points, point, end, masses, count, message, message_size) bind(c)
      import
      type(c_ptr), value :: points
      integer(c_int64_t), value :: point
      integer(c_int), value :: end
      real(c_double), intent(out) :: masses(*)
      integer(c_int64_t), value :: count
      character(kind=c_char), intent(out) :: message(*)
      integer(c_size_t), value :: message_size
    end function
  end interface

contains

  ! Stops with the library's message unless the code is 0.
  subroutine check(code, message)
    integer(c_int), intent(in) :: code
    character(kind=c_char), intent(in) :: message(:)
    integer :: i
    if (code == comminute_ok) return
    do i = 1, size(message)
      if (message(i) == c_null_char) exit
      write (*, '(a)', advance='no') message(i)
    end do
    write (*, *)
    error stop 1
  end subroutine
end module
