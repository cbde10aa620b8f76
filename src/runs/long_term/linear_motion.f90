!> The linearised equations of motion along a free motion, at some of its times.
module mech9_linear_motion
  use mech9_kinds, only: wp
  use mech9_error, only: error_type, raise, add_place, exit_usage, exit_data, exit_singular
  use mech9_text, only: to_text
  use mech9_model, only: model_type
  use mech9_plan, only: plan_type
  use mech9_state, only: state_type
  use mech9_directed_motion, only: keep_motion_alone
  use mech9_simulation, only: interruption_type
  use mech9_free_simulation, only: free_simulation_type
  use mech9_model_motion, only: model_motion_type
  use mech9_partition, only: partition_type
  use mech9_motion_in_space, only: partition_with_angles
  use mech9_linearised_equilibrium, only: equilibrium_type
  use mech9_linearised_motion, only: linearise_motion
  use mech9_state_space, only: state_space_type, find_state_space
  use mech9_columns, only: columns_type
  use mech9_linear_names, only: linear_columns, name_linear_system
  implicit none
  private
  public :: linear_motion_type, linear_at_time_type, find_linear_motion

  !> The matrices at one time: M x'' + C x' + K x = u over the free coordinates, in SI units, and x' = A x + B u, y = C x + D u.
  type :: linear_at_time_type
    real(wp) :: t = 0.0_wp                         !< time [s]
    real(wp), allocatable, dimension(:) :: q, dq, ddq   !< (M) the motion [rad, m, per s, per s^2]
    real(wp), allocatable :: inertia(:, :)         !< (n,n)
    real(wp), allocatable :: damping(:, :)         !< (n,n) with gyroscopic terms
    real(wp), allocatable :: stiffness(:, :)       !< (n,n) with terms of inertia
    type(state_space_type) :: space                !< A, B, C, D
  end type linear_at_time_type

  !> The matrices at all times, with the names of what they refer to.
  type :: linear_motion_type
    integer, allocatable :: free(:)                        !< (n) numbers of the free coordinates
    type(linear_at_time_type), allocatable :: times(:)     !< in the order of the times
    type(columns_type) :: states, inputs, outputs          !< of outputs the time stands first
  end type linear_motion_type

contains

  !> Find the matrices at times of a motion. Fails with exit_data where nothing is free to move or pairs have friction, with exit_usage
  !> where the times are not in order within the motion, with exit_singular where a stop or a contact holds at one of them, and as the motion
  !> does.
  subroutine find_linear_motion(given, times, found, err, interruption)
    type(model_type), intent(in) :: given                            !< the model
    real(wp), intent(in) :: times(:)                                 !< times in the order of the motion [s]; none: all outputs of &time
    type(linear_motion_type), intent(out) :: found                   !< the matrices
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    type(model_type), pointer :: model
    type(model_motion_type), pointer :: motion
    real(wp), allocatable :: at(:)
    integer :: i

    if (size(times) > 0) then
      at = times
    else
      at = [(given%request%time%time(i), i=0, given%request%time%intervals)]
    end if
    call refuse(given, at, err)
    if (allocated(err)) return
    allocate (model, source=given)
    allocate (motion)
    call keep_motion_alone(model%request%output)
    model%request%solver%accuracy = 0.0_wp
    call motion%assemble(model, err)
    if (.not. allocated(err)) call motion%prepare(model, err, pictures=.true.)
    if (.not. allocated(err)) call follow(given, motion%free(), at, found, err, interruption)
    call motion%close()
    deallocate (motion, model)
  end subroutine find_linear_motion

  !> Fail where the equations are not known, or a time is not one of the motion.
  subroutine refuse(model, times, err)
    type(model_type), intent(in) :: model               !< the model
    real(wp), intent(in) :: times(:)                    !< the times [s]
    type(error_type), allocatable, intent(out) :: err   !< allocated where they are refused
    real(wp) :: direction, before
    integer :: i

    if (model%is_driven()) then
      call raise(err, exit_data, 'every independent coordinate is driven, so that nothing deviates from the motion; leave a '// &
                 '&drive out')
      if (size(model%problem%drives) > 0) err%place = model%problem%drives(1)%drive%place
    else if (model%mechanism%has_frictions()) then
      call raise(err, exit_data, 'linearised equations along a motion are not known where pairs have friction; leave the group '// &
                 'out, or use a damping of &load in its place', model%mechanism%frictions(1)%place)
    end if
    associate (time => model%request%time)
      direction = sign(1.0_wp, time%end - time%start)
      before = time%start
      do i = 1, size(times)
        if (allocated(err)) return
        if ((times(i) - time%start)*direction < 0.0_wp .or. (times(i) - time%end)*direction > 0.0_wp) then
          call raise(err, exit_usage, 't = '//to_text(times(i), 8)//' s is outside of the motion, which goes from '// &
                     to_text(time%start, 8)//' to '//to_text(time%end, 8)//' s; give another time, or other times in &time')
        else if ((times(i) - before)*direction < 0.0_wp) then
          call raise(err, exit_usage, 't = '//to_text(times(i), 8)//' s stands behind '//to_text(before, 8)//' s; give the '// &
                     'times in the order of the motion')
        end if
        before = times(i)
      end do
    end associate
  end subroutine refuse

  !> Follow the motion and linearise at the times.
  subroutine follow(model, simulation, times, found, err, interruption)
    type(model_type), intent(in) :: model                            !< the model, with the settings of its outputs
    type(free_simulation_type), intent(inout), target :: simulation  !< of all links, prepared
    real(wp), intent(in) :: times(:)                                 !< the times [s]
    type(linear_motion_type), intent(inout) :: found                 !< gets the matrices
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    class(interruption_type), intent(in), optional :: interruption   !< is asked whether the motion shall stop
    integer :: i

    call simulation%start(err, interruption)
    if (allocated(err)) return
    found%outputs = linear_columns(model%mechanism, model%request%output)
    allocate (found%times(size(times)))
    do i = 1, size(times)
      if (abs(times(i) - simulation%t) > 0.0_wp) call simulation%advance(times(i), err)
      if (.not. allocated(err)) call refuse_holding(simulation, err)
      if (.not. allocated(err)) call linearise_at(model, simulation, found, found%times(i), err)
      if (allocated(err)) return
    end do
  end subroutine follow

  !> Linearise at the present time.
  subroutine linearise_at(model, simulation, found, here, err)
    type(model_type), intent(in) :: model                            !< the model
    type(free_simulation_type), intent(in), target :: simulation     !< at the time
    type(linear_motion_type), intent(inout) :: found                 !< with the names of outputs; gets those of states and inputs
    type(linear_at_time_type), intent(inout) :: here                 !< gets the matrices
    type(error_type), allocatable, intent(out) :: err                !< allocated if it failed
    type(equilibrium_type), allocatable :: about
    type(partition_type) :: partition
    type(plan_type), pointer :: plan
    type(state_type), pointer :: state

    call simulation%present(plan, state)
    allocate (about)
    call partition_with_angles(model%problem, simulation%motion%angles%held, partition)
    call linearise_motion(model%mechanism, partition, state%q, state, about, err)
    if (allocated(err)) then
      call add_place(err, 't = '//to_text(simulation%t, 8)//' s')
      return
    end if
    here%t = simulation%t
    here%q = state%q
    here%dq = state%dq
    here%ddq = state%ddq
    here%inertia = about%inertia
    here%damping = about%damping
    here%stiffness = about%stiffness
    call find_state_space(model%mechanism, found%outputs%coordinates, found%outputs%derivatives, about, here%space)
    if (allocated(found%free)) return
    found%free = about%resting%free
    call name_linear_system(model%mechanism, about, found%states, found%inputs)
  end subroutine linearise_at

  !> Fail where a rigid stop holds a coordinate, or a contact acts: deviations do not keep to the same equations there.
  subroutine refuse_holding(simulation, err)
    type(free_simulation_type), intent(in) :: simulation   !< at the time
    type(error_type), allocatable, intent(out) :: err      !< allocated where one does
    character(len=:), allocatable :: what

    what = ''
    associate (system => simulation%motion%system)
      if (allocated(system%held)) then
        if (size(system%held) > 0) what = 'stop '//to_text(system%held(1)%stop)//' holds a coordinate'
      end if
      if (allocated(system%contact)) then
        if (system%contact%any_acts()) what = 'contact '//to_text(findloc(system%contact%acts, .true., dim=1))//' acts'
      end if
    end associate
    if (what == '') return
    call raise(err, exit_singular, 'at t = '//to_text(simulation%t, 8)//' s '//what//', and linearised equations are not known '// &
               'there; ask for another time, or use a compliant &stop')
  end subroutine refuse_holding
end module mech9_linear_motion
