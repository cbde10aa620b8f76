!> The oddities of the geometry of chains that cannot close or move, in words.
module mech9_geometry_words
  use mech9_failure_units, only: tell_in_units
  use mech9_result_units, only: length_text
  use mech9_kinds, only: wp, radians_per_degree
  use mech9_error, only: error_type, add_place, exit_structure, exit_assembly
  use mech9_text, only: to_text
  use mech9_mechanism, only: mechanism_type
  use mech9_loop_geometry, only: oddity_type, find_oddity, none_found, bent_link, not_parallel, not_across, not_concurrent, &
                                 other_height, too_long
  use mech9_joint_words, only: link_name
  use mech9_explanation, only: explain, power_of_ten
  implicit none
  private
  public :: explain_geometry

  !> Significant digits of lengths.
  integer, parameter :: digits = 6
  !> Largest angle between axes that are meant to be parallel, where their directions have five digits or single precision [rad].
  real(wp), parameter :: rounded_direction = 1.0e-5_wp

contains

  !> Add the oddity of a geometry to the error of a mechanism that cannot be assembled or cannot move: before the message, with
  !> the place of the pair that is probably wrong. Other errors, and those of mechanisms without oddities, do not change.
  subroutine explain_geometry(mechanism, err)
    type(mechanism_type), intent(in) :: mechanism        !< the mechanism
    type(error_type), allocatable, intent(inout) :: err  !< allocated if it failed
    type(oddity_type) :: oddity
    character(len=:), allocatable :: words

    call tell_in_units(err, mechanism)
    if (.not. allocated(err)) return
    if (err%code /= exit_structure .and. err%code /= exit_assembly) return
    if (allocated(err%failure)) then
      ! nobody knows the links of joints
      if (mechanism%structure%joint_of_link(err%failure%link) > 0) err%failure%link = 0
    end if
    call find_oddity(mechanism, oddity)
    if (oddity%kind == none_found) return
    call explain(err)
    call describe(mechanism, oddity, words)
    ! some messages of chains that nearly close or move tell the remedy themselves
    if (oddity%angle > 0.0_wp .and. oddity%angle <= rounded_direction .and. index(err%message, 'data_tolerance') == 0) &
      words = words//': so small an angle comes from directions with too few digits; give more, or allow for their error '// &
              'with &mechanism data_tolerance='//trim(power_of_ten(oddity%angle))
    err%message = words//'; '//err%message
    if (size(oddity%odd) > 0) call add_place(err, place=mechanism%pairs(oddity%odd(1))%pair%place)
  end subroutine explain_geometry

  !> A sentence about an oddity.
  pure subroutine describe(mechanism, oddity, words)
    type(mechanism_type), intent(in) :: mechanism            !< the mechanism
    type(oddity_type), intent(in) :: oddity                  !< the oddity, with pairs, link, angle or distance by its kind
    character(len=:), allocatable, intent(out) :: words  !< the sentence; empty for an unknown kind
    character(len=:), allocatable :: chain, pairs

    chain = ' of the closed chain of pairs '//to_text(oddity%pairs)
    pairs = trim(merge('pairs', 'pair ', size(oddity%odd) > 1))//' '//to_text(oddity%odd)
    select case (oddity%kind)
    case (not_parallel)
      words = 'the axis of '//pairs//' is not parallel to the other axes'//chain//' (by '//trim(degrees(oddity%angle))// &
              '), which could move in a plane'
    case (not_across)
      words = 'the slide of '//pairs//' is not at right angles to the other axes'//chain//' (by '//trim(degrees(oddity%angle))// &
              '), which could move in a plane'
    case (not_concurrent)
      words = 'the axis of '//pairs//' misses the point in which the other axes'//chain//' meet by '// &
              trim(length_text(mechanism, oddity%distance, 3))
    case (other_height)
      words = 'the points of its pairs leave the closed chain of pairs '//to_text(oddity%pairs)//' open by '// &
              trim(length_text(mechanism, oddity%distance, 3))//' along its parallel axes, wherever it moves'
      if (size(oddity%odd) > 0) words = words//': see point and moving_point of '//pairs
    case (too_long)
      words = trim(link_name(mechanism%structure, oddity%link))//' is '// &
              trim(length_text(mechanism, oddity%distance, digits))//' long from pair '//to_text(oddity%odd(1))// &
              ' to pair '//to_text(oddity%odd(2))//', and the other links'//chain//' are '// &
              trim(length_text(mechanism, oddity%others, digits))//' long together'
    case (bent_link)
      words = 'the axes of '//pairs//' are not parallel on '//trim(link_name(mechanism%structure, oddity%link))//' (by '// &
              trim(degrees(oddity%angle))// &
              '), as they are on all other links'//chain//': see axis and moving_axis of these pairs'
    case default
      words = ''
    end select
  end subroutine describe

  !> The angle in words: "5.71 degrees".
  pure character(len=40) function degrees(angle) result(words)
    real(wp), intent(in) :: angle  !< the angle [rad]

    words = to_text(angle/radians_per_degree, 3)//' degrees'
  end function degrees
end module mech9_geometry_words
