! SPDX-License-Identifier: BSD-3-Clause
! Crushing at the integration points of an implicit finite-element host, in the shape of a UMAT.
!
! A closed point that starts from one packing has to remember one number, its largest stress ratio. It stands in STATEV(1);
! STATEV(2) is D50 and STATEV(3) the crushes a cell has been through, for the host's output and for whatever stiffness depends on
! them. The stress here is linear and elastic, so that DDSDDE is the elastic matrix. A model in which the stress depends on D50
! needs d(D50)/d(strain) = d(D50)/d(stress ratio) * d(stress ratio)/d(strain): the first factor is the derivative that
! comminute_table_percentile returns, 0 while the point unloads; the second follows from the measure of the stress.
module crushing
  use comminute
  implicit none
  type(c_ptr), save :: material = c_null_ptr, table = c_null_ptr

contains

  ! Makes material and table, once for all points.
  subroutine prepare()
    character(kind=c_char) :: message(comminute_message_size)
    type(comminute_material_options) :: of_material
    type(comminute_table_options) :: of_table
    type(comminute_grid) :: grid
    type(c_ptr) :: start
    call comminute_material_defaults(of_material)
    of_material%reference_size = 2.0d0      ! mm
    of_material%first_crush_stress = 2.0d0  ! MPa
    of_material%stress_measure = 4          ! elastic energy
    of_material%poisson = 0.2d0
    call check(comminute_material_create(of_material, material, message, comminute_message_size), message)
    call check(comminute_grading_sieves([2.0d0, 1.0d0, 0.5d0, 0.25d0], [100.0d0, 70.0d0, 20.0d0, 0.0d0], &
                                        4_c_int64_t, start, message, comminute_message_size), message)
    call comminute_table_defaults(of_table)
    of_table%max_stress_ratio = 100.0d0
    call check(comminute_grid_fitting(start, material, of_table%max_stress_ratio, 108_c_int64_t, grid, message, &
                                      comminute_message_size), message)
    call check(comminute_table_create(material, start, grid, of_table, table, message, comminute_message_size), message)
    call comminute_grading_destroy(start)
  end subroutine

  ! One point: strains to stresses (tension positive, as such hosts have it), and its state.
  subroutine umat(stress, statev, ddsdde, stran, dstran, props)
    real(c_double), intent(inout) :: stress(6), statev(3)
    real(c_double), intent(out) :: ddsdde(6, 6)
    real(c_double), intent(in) :: stran(6), dstran(6), props(2)
    character(kind=c_char) :: message(comminute_message_size)
    real(c_double) :: ratio(1), found(1), slope(1), tensor(6), lame, shear
    integer :: i
    lame = props(1)*props(2)/((1.0d0 + props(2))*(1.0d0 - 2.0d0*props(2)))
    shear = props(1)/(2.0d0*(1.0d0 + props(2)))
    ddsdde = 0.0d0
    ddsdde(1:3, 1:3) = lame
    do i = 1, 3
      ddsdde(i, i) = lame + 2.0d0*shear
      ddsdde(i + 3, i + 3) = shear
    end do
    stress = matmul(ddsdde, stran + dstran)
    tensor = [stress(1:3), stress(6), stress(5), stress(4)]  ! xx yy zz xy xz yz to xx yy zz yz xz xy
    call check(comminute_material_stress_ratios(material, tensor, 1_c_int64_t, -1, ratio, message, &
                                                comminute_message_size), message)
    statev(1) = max(statev(1), ratio(1))
    call check(comminute_table_percentile(table, 50.0d0, statev(1), 1_c_int64_t, found, slope, message, &
                                          comminute_message_size), message)
    statev(2) = found(1)
    call check(comminute_table_crushes(table, statev(1), 1_c_int64_t, found, slope, message, comminute_message_size), &
               message)
    statev(3) = found(1)
  end subroutine
end module

! The host: an oedometer, loaded, unloaded and loaded further.
program host
  use crushing
  implicit none
  real(c_double) :: stress(6), statev(3), ddsdde(6, 6), strain(6), step(6), last
  integer :: k
  call prepare()
  stress = 0.0d0
  statev = 0.0d0
  strain = 0.0d0
  last = 0.0d0
  write (*, '(a)') ' vertical MPa   stress ratio      D50 mm     crushes'
  do k = 1, 30
    step = 0.0d0
    step(3) = merge(2.0d-3, -2.0d-3, k > 10 .and. k <= 15)  ! five of the steps unload
    call umat(stress, statev, ddsdde, strain, step, [1.0d3, 0.2d0])
    strain = strain + step
    if (mod(k, 5) == 0) write (*, '(f13.2, f15.3, f12.4, f12.4)') - stress(3), statev
    if (statev(1) < last) error stop 'the largest load was forgotten'
    last = statev(1)
  end do
  if (.not. (statev(2) < 0.73d0 .and. statev(3) > 0.0d0)) error stop 'nothing has crushed'
  call comminute_table_destroy(table)
  call comminute_material_destroy(material)
end program
