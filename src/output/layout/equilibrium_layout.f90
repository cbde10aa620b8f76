!> Equilibria and modes as data sets.
module mech9_equilibrium_layout
  use mech9_kinds, only: wp
  use mech9_mechanism, only: mechanism_type
  use mech9_columns, only: columns_type
  use mech9_data_set_store, only: data_set_store_type
  use mech9_scale_layout, only: put_force_scales, find_common_unit
  use mech9_force_layout, only: write_uniqueness
  use mech9_force_record, only: force_record_type
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_mode_shapes, only: energy_shares
  implicit none
  private
  public :: put_rows, put_forces, put_energy_shares

contains

  !> Put rows into a storage. The first column is the scale of the others. Columns of coordinates become one data set, and
  !> those of forces are left to put_forces.
  subroutine put_rows(store, columns, rows, first, n_coordinates, suffixes)
    class(data_set_store_type), intent(inout) :: store   !< the open storage
    type(columns_type), intent(in) :: columns         !< of the rows
    real(wp), intent(in) :: rows(:, :)                !< (columns, rows)
    integer, intent(in) :: first                      !< the first column of a coordinate
    integer, intent(in) :: n_coordinates              !< M
    character(len=*), intent(in) :: suffixes(:)       !< of the data sets of coordinates, in the order of the columns
    real(wp) :: together(n_coordinates, size(rows, 2))
    character(len=:), allocatable :: scale, name
    character(len=12) :: scales(2)
    integer :: i, at

    scale = columns%names(1)%text
    call store%put(scale, nint(rows(1, :)), columns%long_names(1)%text)
    call store%make_scale(scale)
    do i = 2, columns%count
      if (i >= first .and. i < first + n_coordinates*size(suffixes)) cycle
      if (columns%forces() > 0 .and. i > columns%motion .and. i <= columns%motion + columns%forces()) cycle
      name = columns%names(i)%text
      at = index(name, '.')
      if (at > 0) name(at:at) = '_'
      call store%put(name, rows(i, :), columns%long_names(i)%text, columns%units(i)%text)
      call store%attach_scales(name, ['/'//scale])
    end do
    do i = 1, size(suffixes)
      name = 'q'//trim(suffixes(i))
      together = rows(first + i - 1:first + n_coordinates*size(suffixes) - 1:size(suffixes), :)
      call store%put(name, together, 'coordinates of the pairs; coordinate_unit tells the unit of each')
      scales(1) = '/'//scale
      scales(2) = '/coordinate'
      call store%attach_scales(name, scales)
    end do
  end subroutine put_rows

  !> Put the forces at equilibria into a storage, in the data sets of runs, with the components that are unique.
  subroutine put_forces(store, mechanism, columns, rows, forces)
    class(data_set_store_type), intent(inout) :: store   !< the open storage, with the scale of the equilibria
    type(mechanism_type), intent(in) :: mechanism     !< the mechanism
    type(columns_type), intent(in) :: columns         !< of the rows
    real(wp), intent(in) :: rows(:, :)                !< (columns, rows)
    type(force_record_type), intent(in) :: forces     !< with the components that are unique
    character(len=:), allocatable :: unit
    real(wp), allocatable :: wrenches(:, :, :, :), part(:, :, :)
    character(len=12) :: scales(3)
    logical :: has_axes
    integer :: at, n

    if (columns%forces() == 0) return
    has_axes = .false.
    call put_force_scales(store, mechanism, columns, has_axes)
    scales = [character(len=12) :: '/equilibrium', '/pair', '/axis']
    at = columns%motion
    n = size(columns%drives)
    if (n > 0) then
      call find_common_unit(columns%units(at + 1:at + n), unit)
      call store%put('drive_force', rows(at + 1:at + n, :), 'forces that the drives need', unit)
      call store%attach_scales('drive_force', [scales(1), '/driven     '])
    end if
    n = size(columns%reacting)
    if (n == 0) return
    wrenches = reshape(rows(at + size(columns%drives) + 1:at + size(columns%drives) + 6*n, :), [3, 2, n, size(rows, 2)])
    part = wrenches(:, 1, :, :)
    call store%put('reaction_force', part, 'forces that the reference links pass to the moving links through the pairs, in the '// &
                  'fixed frame', trim(columns%system%name_of('N')))
    call store%attach_scales('reaction_force', scales)
    part = wrenches(:, 2, :, :)
    call store%put('reaction_moment', part, 'moments that they pass, about the origins of the pairs'' frames in the moving links', &
                  trim(columns%system%name_of('N m')))
    call store%attach_scales('reaction_moment', scales)
    at = at + columns%forces() - columns%couplings
    if (columns%couplings > 0) then
      call find_common_unit(columns%units(at + 1:at + columns%couplings), unit)
      call store%put('coupling_force', rows(at + 1:at + columns%couplings, :), &
                    'forces of the couplings on their second coordinates', unit)
      call store%attach_scales('coupling_force', [scales(1), '/coupling   '])
    end if
    call write_uniqueness(store, columns, forces)
  end subroutine put_forces

  !> Put the shares of the kinetic energy into a storage of modes.
  subroutine put_energy_shares(store, equilibrium)
    class(data_set_store_type), intent(inout) :: store   !< the open storage, with the scales
    type(equilibrium_type), intent(in) :: equilibrium   !< with its modes
    real(wp) :: shares(equilibrium%resting%plan%n_coordinates, equilibrium%modes%count)
    integer :: i

    do i = 1, size(shares, 2)
      call energy_shares(equilibrium, i, shares(:, i))
    end do
    call store%put('kinetic_share', shares, 'share of each free coordinate in the kinetic energy of the mode')
    call store%attach_scales('kinetic_share', ['/mode      ', '/coordinate'])
  end subroutine put_energy_shares
end module mech9_equilibrium_layout
