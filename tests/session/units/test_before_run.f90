!> Checks before a run: laws of time that do not reach over it, and a wrong choice of independent coordinates without drives.
module test_before_run
  use mech9_program_kind, only: kinematics
  use mech9_document, only: document_type
  use mech9_diagnostics, only: diagnostics_type
  use mech9_model, only: model_type
  use mech9_law_times, only: check_times_of_laws
  use mech9_choice_check, only: judge_choice_of
  use mech9_small_models, only: slider_crank, eol
  use mech9_text_models, only: model_from_text, document_from_text
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('times_of_drives')) call times_of_drives(tester)
    if (tester%runs('choices')) call choices(tester)
  end subroutine run

  !> A drive of segments holds from the first to the last of its times, both included.
  subroutine times_of_drives(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call reaches('start=1, end=3', .true.)
    call reaches('start=0.9, end=3', .false.)
    call reaches('start=1, end=3.1', .false.)
    call reaches('start=3, end=1', .true.)
  contains
    subroutine reaches(times, right)
      character(len=*), intent(in) :: times   !< of the run
      logical, intent(in) :: right            !< the drive reaches over the run
      type(model_type) :: model
      type(diagnostics_type) :: diagnostics

      call model_from_text(tester, slider_crank//"&time "//times//" /"//eol//"&drive coordinate=1, kind='segments', "// &
                    "times=1, 2, 3, values=0, 1, 5, laws='harmonic' /"//eol, kinematics, model)
      call check_times_of_laws(model, .false., diagnostics)
      call tester%is_true(diagnostics%failed() .neqv. right, 'a drive from 1 s to 3 s and a run of '//times)
    end subroutine reaches
  end subroutine times_of_drives

  !> Of four coordinates of a slider-crank one is independent. Drives do not count.
  subroutine choices(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    character(len=*), parameter :: before = slider_crank(:index(slider_crank, 'cq=1') + 2), &
                                   behind = slider_crank(index(slider_crank, 'cq=1') + 4:)

    call judge('1', .true.)
    call judge('2', .true.)
    call judge('1, 2', .false.)
  contains
    subroutine judge(independent, right)
      character(len=*), intent(in) :: independent   !< numbers of the independent coordinates
      logical, intent(in) :: right                  !< they are as many as there are freedoms
      type(document_type) :: document
      type(diagnostics_type) :: sources, wrong
      integer :: number

      call document_from_text(tester, before//independent//behind, document)
      call sources%add_source(document%source, number)
      call judge_choice_of(document, sources, wrong)
      call tester%is_true(wrong%failed() .neqv. right, 'independent coordinates '//independent)
    end subroutine judge
  end subroutine choices
end module test_before_run
