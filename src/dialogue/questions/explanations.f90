!> The explanation that `?` gives of each name of the data file in a conversation: whole sentences, and examples in the
!> unit of the question.
!>
!> The table of names (the grammar) has a few words on each name, for lists; the sentences here are for newcomers. Every
!> row of the grammar has its row here, which a test checks.
module mech9_explanations
  use mech9_name_explanation, only: explanation_type
  use mech9_mechanism_explanations, only: general_texts, coupling_texts, motion_texts
  use mech9_pair_explanations, only: pair_texts
  use mech9_force_explanations, only: body_texts, load_texts, motor_texts, stop_texts, friction_texts, &
    contact_texts
  use mech9_run_explanations, only: cam_texts, study_texts, long_term_texts, run_texts
  implicit none
  private
  public :: find_explanation, explanations

  type(explanation_type), parameter :: explanations(*) = &
    [general_texts, pair_texts, coupling_texts, motion_texts, body_texts, load_texts, motor_texts, stop_texts, &
     friction_texts, contact_texts, cam_texts, study_texts, long_term_texts, run_texts]

contains

  !> The number of the explanation of a name; 0 if there is none.
  pure integer function find_explanation(group, name, kinds) result(place)
    character(len=*), intent(in) :: group  !< group of the name
    character(len=*), intent(in) :: name   !< the name, without a subscript
    character(len=*), intent(in) :: kinds  !< kinds of the row of the table of names that is meant

    do place = size(explanations), 1, -1
      if (explanations(place)%group == group .and. explanations(place)%name == name .and. &
          explanations(place)%kinds == kinds) return
    end do
  end function find_explanation
end module mech9_explanations
