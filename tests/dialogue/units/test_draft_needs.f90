!> Names for which a conversation asks on request only, names that studies need, and explanations in their parts.
module test_draft_needs
  use mech9_program_kind, only: kinematics, dynamics
  use mech9_draft, only: draft_type
  use mech9_explanations, only: explanations
  use mech9_force_explanations, only: body_texts, load_texts, motor_texts, stop_texts, friction_texts, &
    contact_texts
  use mech9_grammar, only: group_table, item_table, find_group_row
  use mech9_mechanism_explanations, only: general_texts, coupling_texts, motion_texts
  use mech9_name_explanation, only: explanation_type
  use mech9_outline, only: outline_type, new_outline
  use mech9_pair_explanations, only: pair_texts
  use mech9_run_explanations, only: cam_texts, study_texts, long_term_texts, run_texts
  use mech9_seldom, only: is_seldom, is_used, seldom_rows
  use mech9_study_needs, only: is_for_study
  use mech9_testing, only: tester_type
  implicit none
  private
  public :: run

contains

  !> Run the cases of this suite.
  subroutine run(tester)
    type(tester_type), intent(inout) :: tester   !< selects cases and counts their checks

    if (tester%runs('seldom_names')) call seldom_names(tester)
    if (tester%runs('studies')) call studies(tester)
    if (tester%runs('parts')) call parts(tester)
  end subroutine run

  !> The rows of a group that are asked for on request are those that the table marks and the program uses.
  subroutine seldom_names(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft
    type(outline_type) :: outline
    integer, allocatable :: rows(:)
    integer :: i, g, n

    call draft%clear()
    outline = new_outline(kinematics, draft)
    outline%way = 'pairs'
    n = 0
    do g = 1, size(group_table)
      rows = seldom_rows(outline, g)
      n = n + size(rows)
      do i = 1, size(rows)
        associate (row => item_table(rows(i)))
          call tester%is_true(row%group == group_table(g)%name .and. row%seldom .and. row%program /= dynamics, &
                              'a seldom name of mech9k: '//trim(row%group)//'.'//trim(row%name))
        end associate
      end do
    end do
    call tester%is_true(n == count(item_table%seldom .and. item_table%program /= dynamics), 'all of them are found')
    do i = 1, size(item_table)
      if (item_table(i)%group /= 'pair' .or. item_table(i)%name /= 'links') cycle
      outline%way = 'pairs'
      call tester%is_true(.not. is_seldom(outline, item_table(i)), 'links of pairs make the structure')
      outline%way = 'matrix'
      call tester%is_true(is_seldom(outline, item_table(i)) .and. is_used(outline, item_table(i)), 'or follow from it')
    end do
  end subroutine seldom_names

  subroutine studies(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks
    type(draft_type) :: draft

    call draft%clear()
    call draft%give('parameter', 1, 'name', "'a'")
    call tester%is_true(.not. is_for_study(draft, 1, 'low'), 'without a study nothing is needed')
    call draft%give('study', 1, 'kind', "'grid'")
    call tester%is_true(is_for_study(draft, 1, 'low') .and. is_for_study(draft, 1, 'high') .and. is_for_study(draft, 1, 'count') &
                        .and. .not. is_for_study(draft, 1, 'spread'), 'a grid needs ranges and counts')
    call draft%give('study', 1, 'kind', "'latin'")
    call tester%is_true(is_for_study(draft, 1, 'spread') .and. .not. is_for_study(draft, 1, 'count'), &
                        'values that are drawn scatter')
    call draft%give('parameter', 1, 'low', '1')
    call tester%is_true(is_for_study(draft, 1, 'high') .and. .not. is_for_study(draft, 1, 'spread'), 'or have a whole range')
    call draft%give('study', 1, 'kind', "'list'")
    call tester%is_true(.not. (is_for_study(draft, 1, 'low') .or. is_for_study(draft, 1, 'spread')), 'a list needs neither')
  end subroutine studies

  !> Each part has the groups of its subject, and all parts together are the explanations.
  subroutine parts(tester)
    type(tester_type), intent(inout) :: tester   !< counts the checks

    call tester%is_true(size(general_texts) + size(coupling_texts) + size(motion_texts) + size(pair_texts) + size(body_texts) + &
                        size(load_texts) + size(motor_texts) + size(stop_texts) + &
                        size(friction_texts) + size(contact_texts) + size(cam_texts) + size(study_texts) + &
                        size(long_term_texts) + size(run_texts) == &
                        size(explanations), 'the parts are the whole')
    call tester%is_true(all(pair_texts%group == 'pair' .or. pair_texts%group == 'link') .and. &
                        all(coupling_texts%group == 'coupling') .and. &
                        all(cam_texts%group == 'cam') .and. all(motor_texts%group == 'motor') .and. &
                        all(load_texts%group == 'load'), 'parts of one group')
    call judge(general_texts)
    call judge(motion_texts)
    call judge(body_texts)
    call judge(study_texts)
    call judge(long_term_texts)
    call judge(run_texts)
  contains
    !> The groups of a part are in the grammar, and its texts are not cut.
    subroutine judge(texts)
      type(explanation_type), intent(in) :: texts(:)   !< of the part
      integer :: i

      do i = 1, size(texts)
        call tester%is_true(find_group_row(trim(texts(i)%group)) > 0, 'a group: '//texts(i)%group)
        call tester%is_true(len_trim(texts(i)%text) < len(texts(i)%text) .and. len_trim(texts(i)%example) < len(texts(i)%example), &
                            'a whole text: '//texts(i)%name)
      end do
    end subroutine judge
  end subroutine parts
end module test_draft_needs
