!> The judgement of the choice of the independent coordinates, apart from their drives. Where the choice is wrong, it
!> explains why drives are missing.
module mech9_choice_check
  use mech9_program_kind, only: dynamics
  use mech9_error, only: error_type, exit_structure
  use mech9_document, only: document_type, group_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_reader, only: read_model
  use mech9_model, only: model_type
  use mech9_state, only: state_type
  use mech9_plan, only: plan_type
  use mech9_planning, only: make_plan
  implicit none
  private
  public :: judge_choice_of

contains

  !> Find out whether the choice of the independent coordinates is wrong. The document must be without errors except those of
  !> its drives.
  subroutine judge_choice_of(document, sources_of, wrong)
    type(document_type), intent(in) :: document        !< the data file as groups and items
    type(diagnostics_type), intent(in) :: sources_of   !< the texts that the document points into
    type(diagnostics_type), intent(out) :: wrong       !< without an error where nothing can be said against it
    type(diagnostics_type) :: of_data
    type(document_type) :: bare
    class(model_type), allocatable :: model
    class(plan_type), allocatable :: plan
    class(state_type), allocatable :: start
    type(error_type), allocatable :: err

    allocate (model, plan, start)
    wrong%sources = sources_of%sources
    of_data%sources = sources_of%sources
    call leave_drives_out(document, bare)
    call read_model(bare, dynamics, model, of_data)
    if (of_data%failed()) return
    call make_plan(model%mechanism, model%problem%partition, model%problem%initial%position, plan, start, err)
    if (.not. allocated(err)) return
    if (err%code == exit_structure) call wrong%add_error(err)
  end subroutine judge_choice_of

  !> Copy a document without its drives. The groups are copied in a loop: an array constructor of them would leak
  !> (gfortran 12).
  pure subroutine leave_drives_out(document, bare)
    type(document_type), intent(in) :: document   !< the data file as groups and items
    type(document_type), intent(out) :: bare      !< the data file without groups &drive
    type(group_type), allocatable :: groups(:)
    integer :: i, n

    bare = document
    allocate (groups(count([(document%groups(i)%name /= 'drive', i=1, size(document%groups))])))
    n = 0
    do i = 1, size(document%groups)
      if (document%groups(i)%name == 'drive') cycle
      n = n + 1
      groups(n) = document%groups(i)
    end do
    call move_alloc(groups, bare%groups)
  end subroutine leave_drives_out
end module mech9_choice_check
