!> The names of parameters that a study needs: the study of a conversation decides which of them must be given.
module mech9_study_needs
  use mech9_draft, only: draft_type
  use mech9_draft_joints, only: kind_in
  implicit none
  private
  public :: is_for_study

contains

  !> Whether the study of a draft needs a name of a parameter. A grid needs its range and its count. A study that draws
  !> values needs its spread where it has no range, and the whole range where it has a part of it.
  pure logical function is_for_study(draft, place, name)
    type(draft_type), intent(in) :: draft  !< groups and names with their values as text
    integer, intent(in) :: place           !< place of the parameter among the parameters, from 1
    character(len=*), intent(in) :: name   !< the name

    is_for_study = .false.
    if (draft%count_of('study') == 0) return
    select case (kind_in(draft, draft%find('study', 1)))
    case ('grid')
      is_for_study = any(name == [character(len=5) :: 'low', 'high', 'count'])
    case ('random', 'latin', 'sobol')
      if (draft%has('parameter', place, 'low') .or. draft%has('parameter', place, 'high')) then
        is_for_study = name == 'low' .or. name == 'high'
      else
        is_for_study = name == 'spread'
      end if
    end select
  end function is_for_study
end module mech9_study_needs
