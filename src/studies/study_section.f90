!> The section of a study: the points of all its runs, in the order of these.
module mech9_study_section
  use mech9_kinds, only: wp
  use mech9_error, only: error_type
  use mech9_model, only: model_type
  use mech9_section_record, only: section_record_type
  use mech9_design_run, only: section_of_runs
  use mech9_run_maker, only: made_run_type
  implicit none
  private
  public :: begin_section, add_points

contains

  !> Begin the section of a study, whose columns are the run, the parameters, and those of the sections of runs.
  subroutine begin_section(model, section, err)
    type(model_type), intent(in) :: model                             !< the model
    class(section_record_type), allocatable, intent(out) :: section   !< without points; not allocated: the model requests none
    type(error_type), allocatable, intent(out) :: err                 !< allocated if it failed
    character(len=:), allocatable :: names(:), units(:)
    integer :: i, n, length

    call section_of_runs(model, section, err)
    if (allocated(err) .or. .not. allocated(section)) return
    n = size(model%parameters)
    length = len(section%names)
    do i = 1, n
      length = max(length, len(model%parameters(i)%name))
    end do
    allocate (character(len=length) :: names(size(section%names) + n + 1))
    allocate (character(len=len(section%units)) :: units(size(names)))
    names(1) = 'run'
    units(:n + 1) = ''
    do i = 1, n
      names(i + 1) = model%parameters(i)%name
    end do
    names(n + 2:) = section%names
    units(n + 2:) = section%units
    call move_alloc(names, section%names)
    call move_alloc(units, section%units)
    deallocate (section%points)
    allocate (section%points(size(section%names), 1))
  end subroutine begin_section

  !> Add the points of a run.
  subroutine add_points(section, run)
    class(section_record_type), intent(inout) :: section   !< of the study
    type(made_run_type), intent(in) :: run                 !< the run; one that failed has no points
    real(wp), allocatable :: more(:, :)
    integer :: n, p, i

    if (.not. allocated(run%points)) return
    section%range = [min(section%range(1), run%range(1)), max(section%range(2), run%range(2))]
    n = section%count + size(run%points, 2)
    p = size(run%values)
    if (n > size(section%points, 2)) then
      allocate (more(size(section%points, 1), 2*n))
      more(:, :section%count) = section%points(:, :section%count)
      call move_alloc(more, section%points)
    end if
    do i = 1, size(run%points, 2)
      associate (row => section%points(:, section%count + i))
        row(1) = run%number
        row(2:p + 1) = run%values
        row(p + 2:) = run%points(:, i)
      end associate
    end do
    section%count = n
  end subroutine add_points
end module mech9_study_section
