!> Axes and frames of pairs from the groups &pair of a checked document.
module mech9_axis_reader
  use mech9_kinds, only: wp
  use mech9_text, only: to_text
  use mech9_pose, only: pose_type, pose_from_axis, default_zero
  use mech9_document, only: group_type
  use mech9_lookup, only: has_name, get_integer, get_integers, get_reals, get_text, span_of
  use mech9_diagnostics, only: diagnostics_type
  implicit none
  private
  public :: read_axis_frames, make_frame, real_or, pair_words

contains

  !> The frames of a pair in its reference link and in its moving link, each with its z along the axis; vectors that make no frame
  !> are reported.
  pure subroutine read_axis_frames(group, reference, moving, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    type(pose_type), intent(out) :: reference             !< the frame in the reference link
    type(pose_type), intent(out) :: moving                !< the frame in the moving link
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    real(wp) :: axis(3), zero(3)
    integer :: found

    found = diagnostics%count
    axis = get_reals(group, 'axis')
    zero = default_zero(axis)
    if (has_name(group, 'zero')) zero = get_reals(group, 'zero')
    call make_frame(group, '', real_or(group, 'point', [0.0_wp, 0.0_wp, 0.0_wp]), axis, zero, reference, diagnostics)

    ! by default each equals its counterpart in the reference link, but a new axis has its own default of zero
    if (has_name(group, 'moving_axis')) zero = default_zero(get_reals(group, 'moving_axis'))
    axis = real_or(group, 'moving_axis', axis)
    zero = real_or(group, 'moving_zero', zero)
    if (diagnostics%count == found .or. has_name(group, 'moving_axis')) &
      call make_frame(group, 'moving_', real_or(group, 'moving_point', reference%p), axis, zero, moving, diagnostics)
  end subroutine read_axis_frames

  !> The three numbers of a name, or a default.
  pure function real_or(group, name, otherwise) result(vector)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=*), intent(in) :: name   !< name of the item
    real(wp), intent(in) :: otherwise(3)   !< the numbers where the item is not given
    real(wp) :: vector(3)

    vector = otherwise
    if (has_name(group, name)) vector = get_reals(group, name)
  end function real_or

  !> The frame of an axis; vectors that are zero or parallel are reported.
  pure subroutine make_frame(group, prefix, point, axis, zero, frame, diagnostics)
    type(group_type), intent(in) :: group                 !< the group of the data file
    character(len=*), intent(in) :: prefix                !< prefix of the names: '' or 'moving_'
    real(wp), intent(in) :: point(3)                      !< origin of the frame, in the link [m]
    real(wp), intent(in) :: axis(3)                       !< direction of its z axis, in the link; of any length
    real(wp), intent(in) :: zero(3)                       !< direction near its x axis, in the link; of any length
    type(pose_type), intent(out) :: frame                 !< pose of the frame in the link
    type(diagnostics_type), intent(inout) :: diagnostics  !< gets the errors
    logical :: ok

    call pose_from_axis(point, axis, zero, frame, ok)
    if (ok) return
    if (.not. any(abs(axis) > 0.0_wp)) then
      call diagnostics%add(span_of(group, prefix//'axis', 1), 'the '//prefix//'axis of '// &
                           trim(pair_words(group))//' is zero; it must have a direction')
    else if (.not. any(abs(zero) > 0.0_wp)) then
      call diagnostics%add(span_of(group, prefix//'zero', 1), 'the '//prefix//'zero of '// &
                           trim(pair_words(group))//' is zero; it must have a direction')
    else if (has_name(group, prefix//'zero') .or. prefix == '') then
      call diagnostics%add(span_of(group, prefix//'zero'), 'the '//prefix//'zero of '// &
                           trim(pair_words(group))//' lies along the axis; it must point away from it')
    else
      call diagnostics%add(span_of(group, 'zero'), 'the zero of '// &
                           trim(pair_words(group))//' lies along its moving_axis; give a moving_zero too')
    end if
  end subroutine make_frame

  !> A pair, or another group, as a message names it: pair 5, or the spherical joint of coordinates 4, 5, 6.
  pure function pair_words(group) result(words)
    type(group_type), intent(in) :: group  !< the group of the data file
    character(len=120) :: words

    if (group%name /= 'pair') then
      words = 'the &'//trim(group%name)
    else if (has_name(group, 'coordinates')) then
      words = 'the '//get_text(group, 'kind')//' joint of coordinates '//to_text(get_integers(group, 'coordinates'))
    else
      words = 'pair '//to_text(get_integer(group, 'coordinate'))
    end if
  end function pair_words
end module mech9_axis_reader
